//! How long do this host's operations take? Small programs run through the same interpreter and the same compiled code
//! as the method's, timed over vectors of 8 to 4 million elements, and a host model fitted to the times.

mod drills;
mod fit;
mod programs;
mod scenes;

use super::samples::Samples;
use crate::model::host::{FORMAT, HostModel, Measured};
use crate::statistics::median;
use drills::{Lane, NEAR, SHORTEST_VECTOR};
use programs::{Fitted, Programs, Ran};
use scenes::Scenes;
use std::time::{Duration, Instant};
use stripmine_kernels::InstructionSet;
use stripmine_kernels::drills::{Arrays, LONGEST};
use stripmine_kernels::isa::ProgramError;
use stripmine_physics::method::throughput::MeasurementError;

/// How much is measured.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Seconds that it takes about; what has to be measured at all is measured once, whatever that takes.
    pub seconds: f64,
}

impl Default for Effort {
    fn default() -> Self {
        Effort { seconds: 75.0 }
    }
}

/// Why there is no calibration.
#[derive(Debug, thiserror::Error)]
pub enum CalibrationError {
    /// The processor lacks the instruction set.
    #[error(transparent)]
    Program(#[from] ProgramError),
    /// A drill scene broke.
    #[error(transparent)]
    Measurement(#[from] MeasurementError),
}

/// Seconds that fitting takes about, which are kept back.
const FITTING: f64 = 5.0;
/// The share of the time that the drill scenes of work that depends on the data take.
const SCENES: f64 = 0.4;

/// Measures this host, called `title`, on one thread, and fits its model: whatever else the machine is doing. `progress` gets the share
/// that is done.
///
/// # Errors
/// [`CalibrationError`] if the processor lacks the instruction set, or a drill scene breaks.
pub fn calibrate(
    title: String,
    set: InstructionSet,
    effort: Effort,
    progress: impl Fn(f64) + Sync,
) -> Result<HostModel, CalibrationError> {
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(MeasurementError::Threads)?;
    alone.install(|| {
        let mut calibration = Calibration::new(title, set)?;
        calibration.measure(effort.seconds, &progress)?;
        Ok(calibration.model())
    })
}

/// A calibration under way.
struct Calibration {
    title: String,
    set: InstructionSet,
    begun: Instant,
    /// Sweeps done.
    sweeps: usize,
    lanes: [Lane; 2],
    long: Arrays<f64, f32>,
    programs: Programs,
    scenes: Scenes,
    binding: Samples,
}

impl Calibration {
    /// Of this host, called `title`: nothing measured yet.
    fn new(title: String, set: InstructionSet) -> Result<Self, CalibrationError> {
        Ok(Calibration {
            title,
            set,
            begun: Instant::now(),
            sweeps: 0,
            lanes: [Lane::new::<f64>(set)?, Lane::new::<f32>(set)?],
            long: Arrays::new(LONGEST),
            programs: Programs::new()?,
            scenes: Scenes::new()?,
            binding: Samples::default(),
        })
    }

    /// Measures for some seconds, on the thread that calls: drills and scenes in turns, so that all see the same machine.
    fn measure(&mut self, seconds: f64, progress: &(dyn Fn(f64) + Sync)) -> Result<(), CalibrationError> {
        let time = Duration::from_secs_f64((seconds - FITTING).max(1.0));
        let (begun, mut of_scenes) = (self.begun, Duration::ZERO);
        let done = || (begun.elapsed().as_secs_f64() / time.as_secs_f64()).min(1.0);
        loop {
            self.sweep();
            progress(done());
            if of_scenes < begun.elapsed().mul_f64(SCENES) {
                let start = Instant::now();
                self.scenes.sweep(begun + time)?;
                of_scenes += start.elapsed();
                progress(done());
            }
            if begun.elapsed() >= time {
                return Ok(());
            }
        }
    }

    /// One sample of every point.
    fn sweep(&mut self) {
        let Calibration { set, sweeps, lanes: [wide, narrow], long, programs, binding, .. } = self;
        // At other addresses each time: whether rows conflict in the first-level cache depends on these.
        wide.sweep(&Arrays::<f64, f32>::new(NEAR).memory(), *set);
        narrow.sweep(&Arrays::<f32, f64>::new(NEAR).memory(), *set);
        // Bytes are bytes: one precision says what they take.
        wide.sweep_long(&long.memory(), *set, *sweeps);
        programs.sweep(*set, *sweeps, binding);
        *sweeps += 1;
    }

    /// The model fitted to what was measured.
    fn model(self) -> HostModel {
        let Calibration { title, set, begun, mut lanes, programs, scenes, binding, .. } = self;
        lanes.iter_mut().for_each(Lane::fit);
        let ran: Vec<Ran> = programs.ran().chain(lanes[0].ran()).collect();
        let Fitted { run, begin, levels, residuals } = programs::fit(&ran, &mut lanes);
        let samples = || lanes.iter().flat_map(Lane::samples).chain(programs.samples());
        let spread = middle(samples().map(Samples::spread));
        let disagreement = middle(samples().map(Samples::disagreement));
        let measured = Measured {
            state: Measured::state_of(spread, disagreement),
            seconds: begun.elapsed().as_secs_f64(),
            spread,
            disagreement,
            shortest: SHORTEST_VECTOR,
            longest: LONGEST,
            residuals,
        };
        HostModel {
            format: FORMAT,
            title,
            instruction_set: set.name().to_owned(),
            measured,
            bind: binding.middle(),
            run,
            begin,
            levels,
            lanes: lanes.into_iter().map(|lane| (lane.name.to_owned(), lane.costs)).collect(),
            rates: scenes.rates(),
        }
    }
}

/// The middle one of those that are finite.
fn middle(values: impl Iterator<Item = f64>) -> f64 {
    median(values.filter(|value| value.is_finite())).max(0.0)
}
