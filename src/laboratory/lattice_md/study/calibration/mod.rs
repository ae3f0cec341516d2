//! How long do this host's operations take? Small programs run through the same interpreter and the same compiled code
//! as the method's, timed over vectors of 8 to 4 million elements, and a host model fitted to the times.

mod capacities;
mod fit;
mod large;
mod levels;
mod loops;
mod passes;
mod point;
mod scenes;
mod step;
mod variants;

use super::samples::Samples;
use crate::model::host::{FORMAT, HostModel, LoopCosts, Measured};
use levels::{Levels, fit_levels};
use loops::Loops;
use passes::{Lane, NEAR, SHORTEST_VECTOR};
use point::Charged;
use scenes::Scenes;
use std::time::{Duration, Instant};
use stripmine_kernels::InstructionSet;
use stripmine_kernels::drills::{Arrays, LONGEST};
use stripmine_kernels::isa::ProgramError;
use stripmine_physics::method::lattice_md::{Phase, Timings};
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
/// The share of the time that the drill scenes take.
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
    timer: f64,
    lanes: [Lane; 2],
    arrays: (Arrays<f64, f32>, Arrays<f32, f64>),
    loops: Loops,
    scenes: Scenes,
    binding: Samples,
    clock: Samples,
}

impl Calibration {
    /// Of this host, called `title`: nothing measured yet.
    fn new(title: String, set: InstructionSet) -> Result<Self, CalibrationError> {
        Ok(Calibration {
            title,
            set,
            begun: Instant::now(),
            sweeps: 0,
            timer: timer_resolution(),
            lanes: [Lane::new::<f64>(set)?, Lane::new::<f32>(set)?],
            arrays: (Arrays::new(LONGEST), Arrays::new(LONGEST)),
            loops: Loops::new()?,
            scenes: Scenes::new()?,
            binding: Samples::default(),
            clock: Samples::default(),
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
        let Calibration { set, sweeps, lanes, arrays, loops, binding, clock, .. } = self;
        let mut timings = Timings::default();
        clock.take(20_000.0, || timings.time(Phase::Predict, || ()));
        binding.take(20_000.0, || _ = std::hint::black_box(arrays.0.memory()));
        // At other addresses each time: whether rows conflict in the first-level cache depends on these.
        let (mut wide, mut narrow) = (Arrays::<f64, f32>::new(NEAR), Arrays::<f32, f64>::new(NEAR));
        let near = [wide.memory(), narrow.memory()];
        let far = [arrays.0.memory(), arrays.1.memory()];
        for (lane, (near, far)) in lanes.iter_mut().zip(near.iter().zip(&far)) {
            lane.sweep([near, far], *set, *sweeps);
        }
        let in_register =
            |name: &str| lanes.iter().find(|lane| lane.name == name).map_or(1, |lane| lane.costs.lanes);
        loops.sweep(*set, &in_register, *sweeps);
        *sweeps += 1;
    }

    /// The model fitted to what was measured.
    fn model(self) -> HostModel {
        let Calibration {
            title, set, begun, timer, mut lanes, arrays, loops, scenes, binding, clock, ..
        } = self;
        lanes.iter_mut().for_each(Lane::fit);
        // Half of the two looks at the clock lies between them.
        let look = 0.5 * clock.middle();
        let run = fit::median(lanes.iter().map(Lane::run));
        let begin = loops.begin(&lanes, run);
        let long = lanes.iter().flat_map(|lane| lane.long_passes(begin));
        let large = loops.large(&lanes, look);
        let costs = loops.costs(&lanes);
        let passes: Vec<Charged> =
            long.chain(large.iter().filter_map(|ran| ran.passes(&lanes, begin))).collect();
        let compiled: Vec<Charged> = large.iter().filter_map(|ran| ran.compiled(&costs, &lanes)).collect();
        let Levels { operand, levels, overlap, residual } = fit_levels(&passes, &compiled);
        let samples = || lanes.iter().flat_map(Lane::samples).chain(loops.samples());
        let spread = fit::median(samples().map(Samples::spread));
        let disagreement = fit::median(samples().map(Samples::disagreement));
        let measured = Measured {
            state: Measured::state_of(spread, disagreement),
            seconds: begun.elapsed().as_secs_f64(),
            samples: fit::median(samples().map(|samples| samples.count() as f64)),
            timer,
            spread,
            low: fit::median(samples().map(|samples| 1.0 - samples.low() / samples.middle())),
            disagreement,
            shortest: SHORTEST_VECTOR,
            longest: LONGEST,
            residual,
        };
        HostModel {
            format: FORMAT,
            title,
            instruction_set: set.name().to_owned(),
            measured,
            operand,
            begin,
            bind: binding.middle() / arrays.0.count() as f64,
            run,
            clock: look,
            levels,
            loops: LoopCosts { overlap, ..costs },
            lanes: lanes.into_iter().map(|lane| (lane.name.to_owned(), lane.costs)).collect(),
            rates: scenes.rates(),
        }
    }
}

/// The smallest step of the clock that was seen (ns).
fn timer_resolution() -> f64 {
    let step = |_| {
        let start = Instant::now();
        loop {
            let passed = start.elapsed().as_nanos();
            if passed > 0 {
                return passed as f64;
            }
        }
    };
    (0..200).map(step).fold(f64::INFINITY, f64::min)
}
