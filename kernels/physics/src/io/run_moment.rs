//! A moment of a run as everything that is written of it sees it.

use super::extxyz::Frame;
use crate::particles::PerParticle;
use std::cell::OnceCell;
use std::sync::Arc;

/// Distance of frames.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum FramesEvery {
    /// Without end: there is one at the start and one at the end.
    #[default]
    Never,
    /// In steps.
    Steps(u64),
    /// In time (time).
    Time(f64),
}

/// Constants of a run that its files need.
#[derive(Clone, Debug, Default)]
pub struct RunHeader {
    /// Sides of the box (length); infinite where there is none.
    pub cell: [f64; 2],
    /// Lower left corner of the box (length).
    pub origin: [f64; 2],
    /// Along which axes the box repeats.
    pub periodic: [bool; 2],
    /// Seed of the random numbers that made the scene.
    pub seed: Option<u64>,
    /// Distance of frames.
    pub frames: FramesEvery,
    /// The time step (time); none where a method takes no steps.
    pub time_step: Option<f64>,
    /// Names of the values of a row.
    pub columns: Vec<&'static str>,
    /// Places of those that go with a frame: all but the time, which the frame has itself.
    pub logged: Vec<usize>,
    /// The heading of rows of events, where there are any.
    pub event_columns: Option<&'static str>,
}

/// A moment of a run. Its frame is made once, when the first format asks for it.
pub struct RunMoment<'m> {
    /// Constants of the run.
    pub header: &'m RunHeader,
    /// Data of each particle.
    pub(crate) per_particle: &'m dyn PerParticle,
    /// Steps done; 0 where a method takes none.
    pub steps: u64,
    /// Number of rows and frames: steps, or events.
    pub number: u64,
    /// Time since the start (time).
    pub time: f64,
    /// The row of this moment, if there is one.
    pub row: Option<&'m [f64]>,
    /// Rows of events since the moment before, each with its end of line.
    pub events: &'m str,
    frame: OnceCell<Arc<Frame>>,
}

impl<'m> RunMoment<'m> {
    /// Makes a moment after a number of steps, with its number and its time (time), without row and events.
    pub fn new(
        header: &'m RunHeader,
        per_particle: &'m dyn PerParticle,
        (steps, number, time): (u64, u64, f64),
    ) -> RunMoment<'m> {
        RunMoment { header, per_particle, steps, number, time, row: None, events: "", frame: OnceCell::new() }
    }

    /// Returns the particles in their box.
    pub fn frame(&self) -> &Arc<Frame> {
        let &RunMoment { header, number: step, time, .. } = self;
        let make = || Frame {
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

    /// Returns the values that go with a frame; not a number where there is no row.
    pub fn logged(&self) -> Vec<f64> {
        self.header.logged.iter().map(|&place| self.row.map_or(f64::NAN, |row| row[place])).collect()
    }
}
