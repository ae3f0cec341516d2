//! How good is the host model? Predicted against measured, on runs that nothing was fitted to: whole steps of moving
//! discs, phase by phase.

mod errors;
mod runs;
mod scene;

pub use errors::{Case, Errors, OF_DATA, OF_DATA_SETTLED, PROGRAMS, PROGRAMS_SETTLED};
pub use runs::{Effort, UNSETTLED, ValidationError};

use super::calibration::{self, Calibration};
use super::noise_monitor::NoiseMonitor;
use super::phase_times::PhaseTimes;
use crate::method::lattice_md::Phase;
use crate::method::throughput::MeasurementError;
use crate::model::host::HostModel;
use rayon::ThreadPool;
use runs::runs;
use scene::{Scene, rated};
use serde::Serialize;
use stripmine_kernels::InstructionSet;

/// Where the model comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Calibrated {
    /// With the program, of another machine perhaps.
    Shipped,
    /// From a calibration at another time.
    Before,
    /// From a calibration in turns with the runs.
    InTurns,
}

/// The dataset.
#[derive(Clone, Debug, Serialize)]
pub struct ModelValidation {
    /// The host model: of which processor.
    pub host: String,
    /// Its instructions.
    pub instruction_set: String,
    /// Where it comes from.
    pub calibrated: Calibrated,
    /// Rounds over all runs, and how many more there were over those that were always disturbed, or did not repeat themselves
    /// within [`UNSETTLED`].
    pub rounds: [usize; 2],
    /// How many times as long as in the calibration the reference loop took in the runs, undisturbed in both.
    pub slowdown: f64,
    /// Every case.
    pub cases: Vec<Case>,
    /// The errors of all, of every execution and of every phase.
    pub errors: Vec<Errors>,
}

impl ModelValidation {
    /// The cases from the worst on.
    pub fn worst(&self) -> Vec<&Case> {
        let mut cases: Vec<&Case> = self.cases.iter().collect();
        cases.sort_by(|a, b| b.error().total_cmp(&a.error()));
        cases
    }
}

/// Predicts by a model and measures, on one thread. `progress` gets the share that is done.
///
/// # Errors
/// [`ValidationError`] if a scene breaks or lies outside what was calibrated; the latter before anything is run.
pub fn model_validation(
    host: &HostModel,
    calibrated: Calibrated,
    effort: &Effort,
    progress: impl Fn(f64) + Sync,
) -> Result<ModelValidation, ValidationError> {
    // Before discs are placed: large scenes take their time.
    for run in runs(effort) {
        let out = |cause| ValidationError::OutOfRange { case: run.name(), cause };
        host.admits(run.particles).map_err(out)?;
        if run.rates().is_some() {
            rated(host, &run, &PhaseTimes::none(run.particles)).map_err(out)?;
        }
    }
    let mut measured = Measured::new(effort)?;
    for scene in &measured.scenes {
        scene.predicted(host)?;
    }
    alone()?.install(|| {
        let mut rounds = effort.rounds.begin();
        while rounds.next().is_some() {
            measured.round(&|share| progress(BASE * rounds.share(share)))?;
        }
        measured.repeat_unsettled(|| Ok(false), &progress)?;
        measured.against(host, calibrated)
    })
}

/// The same with a calibration of this host, called `title`, in turns with the runs, so that both see the same
/// states of it: the speed of a shared host changes. Nothing that is validated is calibrated on. With the model.
///
/// # Errors
/// As [`model_validation`]; and [`ValidationError::Calibration`] if the processor lacks the instruction set.
pub fn calibrated_in_turns(
    title: String,
    set: InstructionSet,
    sweeps: calibration::Effort,
    effort: &Effort,
    progress: impl Fn(f64) + Sync,
) -> Result<(HostModel, ModelValidation), ValidationError> {
    for run in runs(effort) {
        let out = |cause| ValidationError::OutOfRange { case: run.name(), cause };
        Calibration::reaches(run.particles).map_err(out)?;
    }
    let mut measured = Measured::new(effort)?;
    alone()?.install(|| {
        let mut calibration = Calibration::new(title, set, sweeps)?;
        let mut rounds = effort.rounds.begin();
        while let Some(round) = rounds.next() {
            let most = effort.rounds.most as f64;
            let (before, upto) = (round as f64 / most, (round + 1) as f64 / most);
            calibration.measure(upto, &|all| progress(BASE * rounds.share(0.5 * most * (all - before))))?;
            measured.round(&|share| progress(BASE * rounds.share(0.5 * (1.0 + share))))?;
        }
        measured.repeat_unsettled(|| calibration.again(), &progress)?;
        let host = calibration.model();
        let data = measured.against(&host, Calibrated::InTurns)?;
        Ok((host, data))
    })
}

/// The share of the time that is taken by the rounds over all runs, about.
const BASE: f64 = 0.8;

/// Everything is measured on one thread.
fn alone() -> Result<ThreadPool, MeasurementError> {
    rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(MeasurementError::Threads)
}

/// All runs, and what was measured of them.
struct Measured {
    effort: Effort,
    scenes: Vec<Scene>,
    /// Rounds of even and of odd number apart.
    times: Vec<[Option<PhaseTimes>; 2]>,
    /// Rounds over all, and over some.
    rounds: [usize; 2],
    monitor: NoiseMonitor,
}

impl Measured {
    /// Nothing yet.
    fn new(effort: &Effort) -> Result<Measured, MeasurementError> {
        let scenes = runs(effort).map(Scene::new).collect::<Result<Vec<_>, _>>()?;
        let times = scenes.iter().map(|_| [None, None]).collect();
        Ok(Measured {
            effort: effort.clone(),
            scenes,
            times,
            rounds: [0; 2],
            monitor: NoiseMonitor::default(),
        })
    }

    /// Runs everything once more. `progress` gets the share that is done.
    fn round(&mut self, progress: &dyn Fn(f64)) -> Result<(), MeasurementError> {
        let all = self.scenes.len() as f64;
        for (at, (scene, times)) in self.scenes.iter().zip(&mut self.times).enumerate() {
            scene.measure(&self.effort, &mut self.monitor, &mut times[self.rounds[0] % 2])?;
            progress((at + 1) as f64 / all);
        }
        self.rounds[0] += 1;
        Ok(())
    }

    /// Runs once more, for the rounds of even and for those of odd number, what is not settled yet; in turns with
    /// `other`, which says whether it was of use, as long as either is. What is predicted has no say in it.
    fn repeat_unsettled(
        &mut self,
        mut other: impl FnMut() -> Result<bool, MeasurementError>,
        progress: &dyn Fn(f64),
    ) -> Result<(), MeasurementError> {
        while self.rounds[1] + 2 <= self.effort.further {
            let reference = self.monitor.reference();
            let unsettled: Vec<bool> =
                self.times.iter().map(|halves| !is_settled(halves, reference)).collect();
            for half in 0..2 {
                let all = self.scenes.iter().zip(&mut self.times).zip(&unsettled);
                for ((scene, times), _) in all.filter(|(_, unsettled)| **unsettled) {
                    scene.measure(&self.effort, &mut self.monitor, &mut times[half])?;
                }
            }
            if !(other()? | unsettled.contains(&true)) {
                break;
            }
            self.rounds[1] += 2;
            progress(BASE + (1.0 - BASE) * self.rounds[1] as f64 / self.effort.further as f64);
        }
        Ok(())
    }

    /// Beside what a model predicts.
    fn against(&self, host: &HostModel, calibrated: Calibrated) -> Result<ModelValidation, ValidationError> {
        let reference = self.monitor.reference();
        let mut cases = vec![];
        for (scene, halves) in self.scenes.iter().zip(&self.times) {
            cases.extend(scene.cases(host, halves, reference)?);
        }
        Ok(ModelValidation {
            host: host.title.clone(),
            instruction_set: host.instruction_set.clone(),
            calibrated,
            rounds: self.rounds,
            slowdown: reference / host.measured.reference_loop,
            errors: errors::errors(&cases),
            cases,
        })
    }
}

/// Whether a run was measured on an undisturbed core, and each of its phases repeats itself within [`UNSETTLED`].
fn is_settled(halves: &[Option<PhaseTimes>; 2], reference: f64) -> bool {
    let [Some(even), Some(odd)] = halves else { return true };
    let near = |phase: &Phase| {
        let [a, b] = [even, odd].map(|half| half.typical(*phase, reference).0);
        a.max(b) <= (1.0 + UNSETTLED) * a.min(b)
    };
    Phase::ALL.iter().all(near) && [even, odd].iter().any(|half| half.is_quiet(reference))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::lattice_md::study::noise_monitor::Timed;

    #[test]
    fn a_run_is_settled_that_was_undisturbed_and_repeats_itself() {
        let half = |ns: f64, reading: f64| {
            let all = vec![Timed { ns, around: [reading; 2] }; 4];
            Some(PhaseTimes::of(Phase::Forces, &all))
        };
        let settled = |even, odd| is_settled(&[even, odd], 10.0);
        assert!(settled(half(100.0, 10.0), half(109.0, 10.0)));
        assert!(
            !settled(half(100.0, 10.0), half(112.0, 10.0)) && !settled(half(112.0, 10.0), half(100.0, 10.0))
        );
        // Always disturbed, though alike; and one round alone, which cannot be compared.
        assert!(!settled(half(100.0, 15.0), half(100.0, 15.0)));
        assert!(settled(half(100.0, 15.0), None));
    }
}
