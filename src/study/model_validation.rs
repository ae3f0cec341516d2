//! How good is the host model? Predicted against measured, on runs that nothing was fitted to: whole steps of moving
//! discs, phase by phase.

use super::phase_times::{FAST, FAST_LISTS, LISTS, PhaseTimes, Run, Sampling, phase_times};
use super::predicted_step::{Step, of_precision};
use super::throughput::MeasurementError;
use crate::method::Phase;
use crate::method::lattice_md::Lengths;
use crate::model::host::{HostModel, OutOfRange};
use crate::run::model;
use crate::scene::Checked;
use serde::Serialize;
use stripmine_kernels::Execution;

/// What is run.
#[derive(Clone, Debug)]
pub struct Effort {
    /// NP.
    pub particles: Vec<usize>,
    /// ρ on cells as wide as the radius.
    pub occupancies: Vec<f64>,
    /// Rounds over all runs: what one of them meets in a busy moment, another does not.
    pub rounds: usize,
    /// Repeats of a run in a round.
    pub repeats: usize,
    /// Particle-steps of a repeat, about.
    pub particle_steps: usize,
}

/// The executions, by the name that a scene gives them; the last three hang on the data.
const EXECUTIONS: [(&str, Option<Execution>); 7] = [
    ("eager", Some(Execution::Eager)),
    ("strip:64", Some(Execution::Strip(64))),
    ("strip:512", Some(Execution::Strip(512))),
    ("chained", Some(Execution::Chained)),
    (FAST, None),
    (FAST_LISTS, None),
    (LISTS, None),
];

/// The group of all executions of programs.
pub const PROGRAMS: &str = "eager, strip-mined and chained";
/// The group of all executions whose work hangs on the data.
pub const OF_DATA: &str = "fast and lists";

/// Those among the first that were measured at the pace of the calibration: the model alone, without what is said of paces.
pub const PROGRAMS_AT_PACE: &str = "eager, strip-mined and chained, measured at the calibration's pace";
/// Those among the second.
pub const OF_DATA_AT_PACE: &str = "fast and lists, measured at the calibration's pace";

const PRECISIONS: [&str; 3] = ["f64", "f32", "mixed"];

/// Why there is no validation.
#[derive(Debug, thiserror::Error)]
pub enum ValidationError {
    /// A run broke.
    #[error(transparent)]
    Measurement(#[from] MeasurementError),
    /// A case that the model does not reach.
    #[error("{case}: {cause}")]
    OutOfRange {
        /// The case.
        case: String,
        /// Why.
        cause: OutOfRange,
    },
}

/// A phase of a step of one run.
#[derive(Clone, Debug, Serialize)]
pub struct Case {
    /// NP.
    pub particles: usize,
    /// ρ on cells as wide as the radius.
    pub occupancy: f64,
    /// Precision of state and forces.
    pub precision: &'static str,
    /// The execution.
    pub execution: &'static str,
    /// The phase.
    pub phase: &'static str,
    /// Nanoseconds predicted.
    pub predicted: f64,
    /// Nanoseconds of the repeat that counts, at the pace of the calibration: a low quantile.
    pub measured: f64,
    /// A quarter of the repeats lies below, a quarter above.
    pub quartiles: [f64; 2],
    /// The same by the rounds of even number alone and by those of odd number; none of one round. Every round lays the run
    /// out anew, in other pages of memory.
    pub halves: Option<[f64; 2]>,
    /// Whether it was measured at the pace of the calibration, and not only told at it.
    pub at_pace: bool,
    /// Nanoseconds by the trivial baseline: operations times elements, at the cost of a sum in the cache; none where
    /// what is executed hangs on the data.
    pub baseline: Option<f64>,
}

impl Case {
    /// How far the prediction lies off, as a share of the measured time.
    pub fn error(&self) -> f64 {
        (self.predicted / self.measured - 1.0).abs()
    }

    /// The same of the baseline.
    pub fn baseline_error(&self) -> Option<f64> {
        Some((self.baseline? / self.measured - 1.0).abs())
    }

    /// How far the two halves of the measurement differ, as a share: no prediction can be shown to be better than that.
    pub fn repeat_error(&self) -> Option<f64> {
        self.halves.map(|[even, odd]| (even / odd - 1.0).abs())
    }

    /// Whether what is executed hangs on the data.
    pub fn hangs_on_data(&self) -> bool {
        [FAST, FAST_LISTS, LISTS].contains(&self.execution)
    }

    /// All that tells it from the others.
    pub fn name(&self) -> String {
        let Case { particles, occupancy, precision, execution, phase, .. } = self;
        format!("{phase}, {execution}, {precision}, NP = {particles}, ρ = {occupancy}")
    }
}

/// The errors of some cases.
#[derive(Clone, Debug, Serialize)]
pub struct Errors {
    /// What the cases have in common.
    pub what: String,
    /// Cases.
    pub cases: usize,
    /// The median error.
    pub median: f64,
    /// Nine of ten lie below.
    pub ninth_tenth: f64,
    /// The largest.
    pub worst: f64,
    /// Cases within 5, 10, 20 and 30 %.
    pub within: [usize; 4],
    /// The median error of the trivial baseline; none where there is none.
    pub baseline_median: Option<f64>,
    /// How far the measurement differs from its own repetition: in the median, and what nine of ten stay below; none of one
    /// round.
    pub repeated: Option<[f64; 2]>,
}

impl Errors {
    fn of(what: String, cases: &[&Case]) -> Errors {
        let sorted = |of: &dyn Fn(&Case) -> Option<f64>| {
            let mut values: Vec<f64> = cases.iter().filter_map(|case| of(case)).collect();
            values.sort_by(f64::total_cmp);
            values
        };
        let quantile = |sorted: &[f64], share: f64| {
            let last = sorted.len().saturating_sub(1);
            sorted.get((share * last as f64).round() as usize).copied().unwrap_or(f64::NAN)
        };
        let errors = sorted(&|case| Some(case.error()));
        Errors {
            what,
            cases: cases.len(),
            median: quantile(&errors, 0.5),
            ninth_tenth: quantile(&errors, 0.9),
            worst: quantile(&errors, 1.0),
            within: [0.05, 0.1, 0.2, 0.3].map(|limit| errors.iter().filter(|&&error| error <= limit).count()),
            baseline_median: Some(quantile(&sorted(&Case::baseline_error), 0.5))
                .filter(|median| median.is_finite()),
            repeated: Some([0.5, 0.9].map(|share| quantile(&sorted(&Case::repeat_error), share)))
                .filter(|shares| shares[0].is_finite()),
        }
    }
}

/// The dataset.
#[derive(Clone, Debug, Serialize)]
pub struct ModelValidation {
    /// The host model: of which processor.
    pub host: String,
    /// Its instructions.
    pub instruction_set: String,
    /// Whether it is the model that comes with the program, of another machine perhaps.
    pub shipped: bool,
    /// How many times slower than at the pace of the calibration the host was in the median.
    pub pace: f64,
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

/// Predicts and measures, on one thread. `progress` gets the share that is done.
///
/// # Errors
/// [`ValidationError`] if a scene breaks or lies outside what was calibrated; the latter before anything is run.
pub fn model_validation(
    host: &HostModel,
    shipped: bool,
    effort: &Effort,
    progress: impl Fn(f64) + Sync,
) -> Result<ModelValidation, ValidationError> {
    let mut scenes = vec![];
    // Before discs are placed: large scenes take their time.
    for run in runs(effort) {
        let out = |cause| ValidationError::OutOfRange { case: run.name(), cause };
        host.admits(run.particles).map_err(out)?;
        if run.rates().is_some() {
            rated(host, &run, &PhaseTimes::none(run.particles)).map_err(out)?;
        }
    }
    for run in runs(effort) {
        scenes.push(Scene::new(host, run)?);
    }
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(MeasurementError::Threads)?;
    // Rounds of even and of odd number apart.
    let mut times: Vec<[Option<PhaseTimes>; 2]> = scenes.iter().map(|_| [None, None]).collect();
    for round in 0..effort.rounds {
        for (at, (scene, times)) in scenes.iter().zip(&mut times).enumerate() {
            let more = alone.install(|| scene.measure(effort))?;
            let times = &mut times[round % 2];
            *times = Some(match times.take() {
                Some(before) => before.joined(more),
                None => more,
            });
            progress((round * scenes.len() + at + 1) as f64 / (effort.rounds * scenes.len()) as f64);
        }
    }
    let mut cases = vec![];
    for (scene, halves) in scenes.iter().zip(&times) {
        cases.extend(scene.cases(host, halves)?);
    }
    Ok(ModelValidation {
        host: host.title.clone(),
        instruction_set: host.instruction_set.clone(),
        shipped,
        pace: median_pace(host, times.iter().flatten().flatten()),
        errors: errors(&cases),
        cases,
    })
}

fn median_pace<'a>(host: &HostModel, times: impl Iterator<Item = &'a PhaseTimes>) -> f64 {
    let mut paces: Vec<f64> = times.flat_map(|times| times.paces(host.measured.yardstick)).collect();
    paces.sort_by(f64::total_cmp);
    paces.get(paces.len() / 2).copied().unwrap_or(1.0)
}

/// Every run, in order.
fn runs(effort: &Effort) -> impl Iterator<Item = Run> {
    let places = effort
        .particles
        .iter()
        .flat_map(|&particles| effort.occupancies.iter().map(move |&occupancy| (particles, occupancy)));
    places.flat_map(|(particles, occupancy)| {
        PRECISIONS.into_iter().flat_map(move |precision| {
            EXECUTIONS.map(|(execution, _)| Run { particles, occupancy, precision, execution })
        })
    })
}

/// The errors by execution, phase and precision.
fn errors(cases: &[Case]) -> Vec<Errors> {
    let mut errors = vec![];
    let mut group = |what: &str, keep: &dyn Fn(&Case) -> bool| {
        let kept: Vec<&Case> = cases.iter().filter(|case| keep(case)).collect();
        if !kept.is_empty() {
            errors.push(Errors::of(what.to_owned(), &kept));
        }
    };
    group(PROGRAMS, &|case| !case.hangs_on_data());
    group(OF_DATA, &Case::hangs_on_data);
    group(PROGRAMS_AT_PACE, &|case| !case.hangs_on_data() && case.at_pace);
    group(OF_DATA_AT_PACE, &|case| case.hangs_on_data() && case.at_pace);
    EXECUTIONS.iter().for_each(|(name, _)| group(name, &|case| case.execution == *name));
    let straight = |case: &Case| !case.hangs_on_data();
    Phase::ALL.iter().for_each(|phase| {
        group(&format!("{} of programs", phase.name()), &|case| straight(case) && case.phase == phase.name());
    });
    Phase::ALL.iter().for_each(|phase| {
        let of_data = |case: &Case| case.hangs_on_data() && case.phase == phase.name();
        group(&format!("{} of fast and lists", phase.name()), &of_data);
    });
    PRECISIONS.iter().for_each(|name| group(name, &|case| straight(case) && case.precision == *name));
    errors
}

/// A run to be measured, with what is predicted of it before: nanoseconds of every phase, and the baseline's. What hangs on
/// the data is predicted once the run has said how much there was to do.
struct Scene {
    run: Run,
    checked: Checked,
    predicted: Option<Vec<[f64; 2]>>,
}

impl Scene {
    fn new(host: &HostModel, run: Run) -> Result<Scene, ValidationError> {
        let out = |cause| ValidationError::OutOfRange { case: run.name(), cause };
        let checked = run.scene(&[])?;
        let execution = EXECUTIONS.iter().find(|(name, _)| *name == run.execution);
        let Some(execution) = execution.and_then(|(_, execution)| *execution) else {
            return Ok(Scene { run, checked, predicted: None });
        };
        let model = model(&checked);
        let lengths = Lengths::new(&model, checked.particles.grain_count(), checked.particles.len());
        let step = Step::new(&of_precision(&model, checked.scene.method.precision), &lengths);
        let phases = Phase::ALL.iter().map(|&phase| step.phase(host, phase, execution));
        Ok(Scene { run, predicted: Some(phases.collect::<Result<_, _>>().map_err(out)?), checked })
    }

    fn measure(&self, effort: &Effort) -> Result<PhaseTimes, MeasurementError> {
        let sampling = Sampling {
            equilibration: (effort.particle_steps / self.run.particles).clamp(5, 50),
            repeats: effort.repeats,
            particle_steps: effort.particle_steps,
            // Lists are made anew every few steps only.
            least_steps: if self.run.has_lists() { 6 } else { 2 },
        };
        phase_times(&self.checked, &sampling)
    }

    fn cases(
        &self,
        host: &HostModel,
        halves: &[Option<PhaseTimes>; 2],
    ) -> Result<Vec<Case>, ValidationError> {
        let reference = host.measured.yardstick;
        let Some(times) = halves.iter().flatten().cloned().reduce(PhaseTimes::joined) else {
            return Ok(vec![]);
        };
        let of_halves = |phase: Phase| match halves {
            [Some(even), Some(odd)] => Some([even, odd].map(|half| half.typical(phase, reference).0)),
            _ => None,
        };
        let predicted: Vec<(f64, Option<f64>)> = match &self.predicted {
            Some(phases) => phases.iter().map(|&[ns, baseline]| (ns, Some(baseline))).collect(),
            None => {
                let phases = rated(host, &self.run, &times);
                let phases =
                    phases.map_err(|cause| ValidationError::OutOfRange { case: self.run.name(), cause })?;
                phases.into_iter().map(|ns| (ns, None)).collect()
            }
        };
        let Run { particles, occupancy, precision, execution } = self.run;
        let cases = Phase::ALL.iter().zip(predicted).map(|(&phase, (predicted, baseline))| {
            let (measured, quartiles) = times.typical(phase, reference);
            Case {
                particles,
                occupancy,
                precision,
                execution,
                phase: phase.name(),
                predicted,
                measured,
                quartiles,
                halves: of_halves(phase),
                at_pace: times.was_at_pace(phase, reference),
                baseline,
            }
        });
        // Not every execution has every phase.
        Ok(cases.filter(|case| case.measured > 0.0).collect())
    }
}

/// Nanoseconds of every phase of a run whose cost hangs on the data.
fn rated(host: &HostModel, run: &Run, times: &PhaseTimes) -> Result<Vec<f64>, OutOfRange> {
    let method = run.rates().unwrap_or_default();
    let rates = host.rates.get(method).ok_or_else(|| OutOfRange::NotMeasured(format!("method {method}")))?;
    Phase::ALL.iter().map(|phase| rates.phase(run.precision, phase.name(), &times.amounts)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case(predicted: f64, execution: &'static str) -> Case {
        Case {
            particles: 100,
            occupancy: 0.1,
            precision: "f64",
            execution,
            phase: "forces",
            predicted,
            measured: 100.0,
            quartiles: [99.0, 101.0],
            halves: Some([102.0, 100.0]),
            at_pace: execution == "eager",
            baseline: (execution != LISTS).then_some(50.0),
        }
    }

    #[test]
    fn errors_are_counted_group_by_group() {
        let cases = [case(102.0, "eager"), case(92.0, "eager"), case(140.0, "chained"), case(80.0, LISTS)];
        let errors = errors(&cases);
        let of = |what: &str| errors.iter().find(|errors| errors.what == what).unwrap();
        let programs = of(PROGRAMS);
        assert_eq!((programs.cases, programs.within), (3, [1, 2, 2, 2]));
        assert!((programs.median - 0.08).abs() < 1e-9 && (programs.worst - 0.4).abs() < 1e-9);
        assert_eq!(programs.baseline_median, Some(0.5));
        assert!((programs.repeated.unwrap()[0] - 0.02).abs() < 1e-9);
        assert_eq!(of(OF_DATA).baseline_median, None);
        assert_eq!((of(PROGRAMS_AT_PACE).cases, of(PROGRAMS_AT_PACE).within), (2, [1, 2, 2, 2]));
    }
}
