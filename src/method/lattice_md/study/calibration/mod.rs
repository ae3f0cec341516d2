//! How long do this host's operations take? Small programs run through the same interpreter and the same compiled code
//! as the method's, timed over vectors of 8 to 4 million elements, and a host model fitted to the times.

mod capacities;
mod drills;
mod factors;
mod fit;
mod large;
mod levels;
mod loops;
mod passes;
mod point;
mod scenes;
mod step;
mod timing;
mod variants;

use super::noise_monitor::NoiseMonitor;
use crate::method::lattice_md::{Phase, Timings};
use crate::method::throughput::MeasurementError;
use crate::model::host::{FORMAT, HostModel, LoopCosts, Measured, OutOfRange};
use drills::{Arrays, LONGEST};
use levels::{Levels, fit_levels};
use loops::Loops;
use passes::{Lane, NEAR, SHORTEST_VECTOR};
use point::Charged;
use scenes::Scenes;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::isa::ProgramError;
use timing::{Samples, timer_resolution};

/// How much is measured.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Sweeps over all points: with more of them, more points are measured undisturbed.
    pub sweeps: usize,
}

impl Default for Effort {
    fn default() -> Self {
        Effort { sweeps: 12 }
    }
}

/// With a larger half range of the samples, corrected for slowdowns, the machine was too busy to be measured.
pub const TOO_NOISY: f64 = 0.1;
/// With a larger difference between the measurement's halves, it was too busy as well.
pub const TOO_DIFFERENT: f64 = 0.05;
/// With a smaller share of the points measured undisturbed, other programs were running all the time.
pub const TOO_RARE: f64 = 0.5;

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

/// The drill scenes are run once for this many sweeps, and take as long as these do.
const SCENES_EVERY: usize = 3;

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
    alone.install(|| {
        let mut calibration = Calibration::new(title, set, effort)?;
        calibration.measure(1.0, &progress)?;
        Ok(calibration.model())
    })
}

/// A calibration under way: it can be done in parts, alternating with other measurements.
pub(super) struct Calibration {
    title: String,
    set: InstructionSet,
    effort: Effort,
    /// Sweeps done.
    sweeps: usize,
    timer: f64,
    monitor: NoiseMonitor,
    lanes: [Lane; 2],
    arrays: (Arrays<f64, f32>, Arrays<f32, f64>),
    loops: Loops,
    scenes: Scenes,
    binding: Samples,
    clock: Samples,
}

impl Calibration {
    /// Of this host, called `title`: nothing measured yet.
    pub(super) fn new(title: String, set: InstructionSet, effort: Effort) -> Result<Self, CalibrationError> {
        Ok(Calibration {
            title,
            set,
            effort,
            sweeps: 0,
            timer: timer_resolution(),
            monitor: NoiseMonitor::default(),
            lanes: [Lane::new::<f64, f32>(set)?, Lane::new::<f32, f64>(set)?],
            arrays: (Arrays::new(LONGEST), Arrays::new(LONGEST)),
            loops: Loops::new()?,
            scenes: Scenes::new()?,
            binding: Samples::default(),
            clock: Samples::default(),
        })
    }

    /// Whether runs of `discs` discs lie within what is measured.
    ///
    /// # Errors
    /// [`OutOfRange`] where they do not.
    pub(super) fn reaches(discs: usize) -> Result<(), OutOfRange> {
        let [fewest, most] = [0, scenes::PARTICLES.len() - 1].map(|at| scenes::PARTICLES[at]);
        if discs < fewest || discs > most {
            return Err(OutOfRange::Discs { discs, fewest, most });
        }
        Ok(())
    }

    /// Measures on until a share of everything is done, on the thread that calls. `progress` gets the share that is done.
    pub(super) fn measure(
        &mut self,
        share: f64,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<(), CalibrationError> {
        let upto = (share * self.effort.sweeps as f64).round() as usize;
        while self.sweeps < upto {
            let parts = self.sweeps.div_ceil(SCENES_EVERY);
            if self.sweeps.is_multiple_of(SCENES_EVERY) {
                let before = self.done(parts);
                let part = self.done(parts + 1) - before;
                self.scenes.sweep(&mut self.monitor, |share| progress(before + part * share))?;
            }
            self.sweep();
            progress(self.done(self.sweeps.div_ceil(SCENES_EVERY)));
        }
        Ok(())
    }

    /// Some more samples of what does not repeat itself yet, beyond the sweeps. Whether there was any.
    pub(super) fn again(&mut self) -> Result<bool, MeasurementError> {
        let reference = self.monitor.reference();
        let scenes = self.scenes.again(&mut self.monitor, reference)?;
        Ok(scenes | self.loops.again(&mut self.monitor, self.set, reference))
    }

    /// The share that is done, after `scenes` runs of the drill scenes.
    fn done(&self, scenes: usize) -> f64 {
        let all = self.effort.sweeps + SCENES_EVERY * self.effort.sweeps.div_ceil(SCENES_EVERY);
        (self.sweeps + SCENES_EVERY * scenes) as f64 / all as f64
    }

    /// One sample of every point.
    fn sweep(&mut self) {
        let Calibration { set, sweeps, monitor, lanes, arrays, loops, binding, clock, .. } = self;
        let mut timings = Timings::default();
        clock.take(monitor, 20_000.0, || timings.time(Phase::Predict, || ()));
        binding.take(monitor, 20_000.0, || _ = std::hint::black_box(arrays.0.memory()));
        // At other addresses each time: whether rows conflict in the first-level cache depends on these.
        let (mut wide, mut narrow) = (Arrays::<f64, f32>::new(NEAR), Arrays::<f32, f64>::new(NEAR));
        let near = [wide.memory(), narrow.memory()];
        let far = [arrays.0.memory(), arrays.1.memory()];
        for (lane, (near, far)) in lanes.iter_mut().zip(near.iter().zip(&far)) {
            lane.sweep(monitor, [near, far], *set, *sweeps);
        }
        let in_register =
            |name: &str| lanes.iter().find(|lane| lane.name == name).map_or(1, |lane| lane.costs.lanes);
        loops.sweep(monitor, *set, &in_register, *sweeps);
        *sweeps += 1;
    }

    /// The model fitted to what was measured.
    pub(super) fn model(self) -> HostModel {
        let Calibration {
            title,
            set,
            timer,
            monitor,
            mut lanes,
            arrays,
            mut loops,
            scenes,
            mut binding,
            mut clock,
            ..
        } = self;
        let reference_loop = monitor.reference();
        loops.evaluate(reference_loop);
        [&mut binding, &mut clock].into_iter().for_each(|samples| samples.evaluate(reference_loop));
        for lane in &mut lanes {
            lane.evaluate(reference_loop);
            lane.fit();
        }
        // Half of the two looks at the clock lies between them.
        let look = 0.5 * clock.typical();
        let run = fit::median(lanes.iter().map(Lane::run));
        let begin = loops.see(&mut lanes, run);
        let long = lanes.iter().flat_map(|lane| lane.long_passes(begin));
        let large = loops.large(&lanes, look);
        let mut costs = loops.costs(&lanes);
        let passes: Vec<Charged> =
            long.chain(large.iter().filter_map(|ran| ran.passes(&lanes, begin))).collect();
        let compiled: Vec<Charged> = large.iter().filter_map(|ran| ran.compiled(&costs, &lanes)).collect();
        let Levels { operand, levels, overlap, factors: [in_passes, in_loops], residual } =
            fit_levels(&passes, &compiled);
        for (found, seen) in lanes
            .iter_mut()
            .map(|lane| (&in_passes, &mut lane.costs.seen))
            .chain([(&in_loops, &mut costs.seen)])
        {
            for (program, cost) in seen {
                cost.factors = found.get(program).copied().unwrap_or_default();
            }
        }
        let samples = || lanes.iter().flat_map(Lane::samples).chain(loops.samples());
        HostModel {
            format: FORMAT,
            title,
            instruction_set: set.name().to_owned(),
            measured: Measured {
                timer,
                reference_loop,
                slowdown: monitor.usual_slowdown(),
                spread: fit::median(samples().map(Samples::spread)),
                disagreement: fit::median(samples().map(Samples::disagreement)),
                quiet: samples().map(Samples::quiet).sum::<f64>() / samples().count() as f64,
                shortest: SHORTEST_VECTOR,
                longest: LONGEST,
                residual,
            },
            operand,
            begin,
            bind: binding.typical() / arrays.0.count() as f64,
            run,
            clock: look,
            levels,
            loops: LoopCosts { overlap, ..costs },
            lanes: lanes.into_iter().map(|lane| (lane.name.to_owned(), lane.costs)).collect(),
            rates: scenes.rates(reference_loop),
        }
    }
}
