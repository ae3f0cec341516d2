//! How long do this host's operations take? Small programs run through the same interpreter and the same compiled code
//! as the method's, timed over vectors of 8 to 4 million elements, and a host model fitted to the times.

mod drills;
mod fit;
mod levels;
mod loops;
mod passes;
mod scenes;
mod timing;

use super::throughput::MeasurementError;
use crate::method::{Phase, Timings};
use crate::model::host::{FORMAT, HostModel, LoopCosts, Measured};
use drills::{Arrays, LONGEST};
use levels::{Charged, Levels, fit_levels};
use loops::Loops;
use passes::{Lane, SHORT};
use scenes::Scenes;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::isa::ProgramError;
use timing::{PacedClock, Samples, timer_resolution};

/// How much is measured.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Sweeps over all points: the more, the surer every point meets quiet moments.
    pub sweeps: usize,
}

impl Default for Effort {
    fn default() -> Self {
        Effort { sweeps: 40 }
    }
}

/// More than this half range of samples told at one pace, and the machine was too busy to be measured.
pub const TOO_NOISY: f64 = 0.1;
/// More than this between the measurement's halves, and it was too busy as well.
pub const TOO_DIFFERENT: f64 = 0.05;
/// More than this share slower most of the time than in good moments, and somebody else was at work beside it.
pub const TOO_SLOW: f64 = 0.15;

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

/// Share of the time that the drill scenes take.
const SCENES: f64 = 0.5;
/// How often they are run.
const PARTS: usize = 2;

/// Measures this host, called `title`, on one thread, and fits its model. `progress` gets the share that is done.
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
    alone.install(|| measured(title, set, effort, &progress))
}

fn measured(
    title: String,
    set: InstructionSet,
    effort: Effort,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<HostModel, CalibrationError> {
    let timer = timer_resolution();
    let mut lanes = [Lane::new::<f64, f32>(set)?, Lane::new::<f32, f64>(set)?];
    let mut arrays = (Arrays::<f64, f32>::new(LONGEST), Arrays::<f32, f64>::new(LONGEST));
    let mut loops = Loops::new()?;
    let mut paced = PacedClock::new();
    let [mut binding, mut clock] = [Samples::default(), Samples::default()];
    let mut scenes = Scenes::new()?;
    for sweep in 0..effort.sweeps {
        // The scenes at the beginning and at the end.
        if let Some(part) = (0..PARTS).find(|part| sweep == part * (effort.sweeps - 1) / (PARTS - 1).max(1)) {
            let done = (sweep as f64 / effort.sweeps as f64, part as f64 / PARTS as f64);
            let from = (1.0 - SCENES) * done.0 + SCENES * done.1;
            scenes.sweep(|share| progress(from + SCENES * share / PARTS as f64))?;
            paced.look();
        }
        let mut timings = Timings::default();
        clock.take(&mut paced, 20_000.0, || timings.time(Phase::Predict, || ()));
        binding.take(&mut paced, 20_000.0, || _ = std::hint::black_box(arrays.0.memory()));
        let memories = [arrays.0.memory(), arrays.1.memory()];
        for (lane, memory) in lanes.iter_mut().zip(&memories) {
            lane.sweep(&mut paced, memory, set, sweep);
        }
        loops.sweep(&mut paced, set, sweep);
    }
    let yardstick = paced.reference();
    loops.settle(yardstick);
    [&mut binding, &mut clock].into_iter().for_each(|samples| samples.settle(yardstick));
    for lane in &mut lanes {
        lane.settle(yardstick);
        lane.fit();
    }
    let charged: Vec<Charged> =
        lanes.iter().flat_map(Lane::long_passes).chain(loops.charged(&lanes)).collect();
    let costs = loops.costs();
    let Levels { operand, levels, begin, streams, overlap, residual } =
        fit_levels(&charged, &loops.charged_loops(&costs));
    let samples = || lanes.iter().flat_map(Lane::samples).chain(loops.samples());
    Ok(HostModel {
        format: FORMAT,
        title,
        instruction_set: set.name().to_owned(),
        measured: Measured {
            timer,
            yardstick,
            pace: paced.pace(),
            spread: fit::median(samples().map(Samples::spread)),
            disagreement: fit::median(samples().map(Samples::disagreement)),
            shortest: SHORT[0],
            longest: LONGEST,
            residual,
        },
        operand,
        begin,
        bind: binding.typical() / arrays.0.count() as f64,
        run: fit::median(lanes.iter().map(Lane::run)),
        // Half of the two looks at the clock lies between them.
        clock: 0.5 * clock.typical(),
        levels,
        loops: LoopCosts { streams, overlap, ..costs },
        lanes: lanes.into_iter().map(|lane| (lane.name.to_owned(), lane.costs)).collect(),
        rates: scenes.rates(yardstick),
    })
}
