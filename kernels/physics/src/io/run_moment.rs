//! Moments of a run, as seen by its output files.

use super::extxyz::ParticleFrame;
use crate::particles::PerParticle;
use std::cell::OnceCell;
use std::sync::Arc;

/// Interval of frames.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum FramesEvery {
    /// A frame at the start and one at the end only.
    #[default]
    Never,
    /// Interval in steps.
    Steps(u64),
    /// Interval in time (time).
    Time(f64),
}

/// Constants of a run that its files need.
#[derive(Clone, Debug, Default)]
pub struct RunHeader {
    /// Sides of the box (length); infinite without a box.
    pub cell: [f64; 2],
    /// Lower left corner of the box (length).
    pub origin: [f64; 2],
    /// Periodicity along x and y.
    pub periodic: [bool; 2],
    /// Seed of the random numbers that made the scene.
    pub seed: Option<u64>,
    /// Interval of frames.
    pub frames: FramesEvery,
    /// Time step (time); none for methods without steps.
    pub time_step: Option<f64>,
    /// Names of the values of a row.
    pub columns: Vec<&'static str>,
    /// Indices of values stored with a frame: all but the time, which the frame has itself.
    pub logged: Vec<usize>,
    /// Heading of event rows, if the method has events.
    pub event_columns: Option<&'static str>,
}

/// Moment of a run. Its frame is made once, when a format first requests it.
pub struct RunMoment<'m> {
    /// Constants of the run.
    pub header: &'m RunHeader,
    /// Data of each particle.
    pub(crate) per_particle: &'m dyn PerParticle,
    /// Number of steps done; 0 for methods without steps.
    pub steps: u64,
    /// Number for rows and frames: of steps, or of events.
    pub number: u64,
    /// Time since the start (time).
    pub time: f64,
    /// Row of this moment, if there is one.
    pub row: Option<&'m [f64]>,
    /// Rows of events since the previous moment, each with its line end.
    pub events: &'m str,
    frame: OnceCell<Arc<ParticleFrame>>,
}

impl<'m> RunMoment<'m> {
    /// Creates a moment from its number of steps, its number and its time (time), without row and events.
    pub fn new(
        header: &'m RunHeader,
        per_particle: &'m dyn PerParticle,
        (steps, number, time): (u64, u64, f64),
    ) -> RunMoment<'m> {
        RunMoment { header, per_particle, steps, number, time, row: None, events: "", frame: OnceCell::new() }
    }

    /// Returns the particles in their box; the frame is made on the first call.
    pub fn frame(&self) -> &Arc<ParticleFrame> {
        let &RunMoment { header, number: step, time, .. } = self;
        let make = || ParticleFrame {
            particles: self.per_particle.particles(),
            cell: header.cell,
            origin: header.origin,
            periodic: Some(header.periodic),
            time,
            step,
            seed: header.seed,
            has_raised_ids: false,
        };
        self.frame.get_or_init(|| Arc::new(make()))
    }

    /// Returns the values stored with a frame; NaN without a row.
    pub fn logged(&self) -> Vec<f64> {
        self.header.logged.iter().map(|&place| self.row.map_or(f64::NAN, |row| row[place])).collect()
    }
}
