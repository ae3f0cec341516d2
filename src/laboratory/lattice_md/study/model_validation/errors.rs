//! The cases of a validation, and how far off their predictions are.

use super::EXECUTIONS;
use crate::statistics::quantile;
use serde::Serialize;

/// The name of a whole step among the phases.
pub const STEP: &str = "step";
/// The name of a program of a law that nothing was calibrated on.
pub const STRANGER: &str = "law";

/// Whole steps by programs.
pub const STEPS: &str = "whole steps, eager, strip-mined and chained";
/// Whole steps whose work depends on the data.
pub const STEPS_OF_DATA: &str = "whole steps, fast and lists";
/// Phases of programs.
pub const PHASES: &str = "phases, eager, strip-mined and chained";
/// Phases whose work depends on the data.
pub const PHASES_OF_DATA: &str = "phases, fast and lists";
/// Programs of laws that nothing was calibrated on.
pub const STRANGERS: &str = "laws that nothing was calibrated on";

/// A phase of a step of one run, a whole step, or a program.
#[derive(Clone, Debug, Serialize)]
pub struct Case {
    /// Precision, NP and ρ; or the law and the length of the vectors.
    pub place: String,
    /// What executed it.
    pub execution: &'static str,
    /// The phase; `step` of a whole one, `law` of a program of a law that nothing was calibrated on.
    pub phase: &'static str,
    /// Predicted (ns).
    pub predicted: f64,
    /// Measured: the middle of the samples (ns).
    pub measured: f64,
    /// The middles of every second sample and of the others (ns); none of a single sample.
    pub halves: Option<[f64; 2]>,
    /// Operations times elements, at the cost of a sum in the cache (ns); none where work depends on the data.
    pub baseline: Option<f64>,
}

impl Case {
    /// A whole step of its phases; none of none.
    pub(super) fn step(phases: &[Case]) -> Option<Case> {
        let first = phases.first()?;
        let sum = |of: &dyn Fn(&Case) -> f64| phases.iter().map(of).sum::<f64>();
        let halves: Option<Vec<[f64; 2]>> = phases.iter().map(|case| case.halves).collect();
        let baselines: Option<Vec<f64>> = phases.iter().map(|case| case.baseline).collect();
        Some(Case {
            phase: STEP,
            predicted: sum(&|case| case.predicted),
            measured: sum(&|case| case.measured),
            halves: halves.map(|all| [0, 1].map(|at: usize| all.iter().map(|halves| halves[at]).sum())),
            baseline: baselines.map(|all| all.iter().sum()),
            ..first.clone()
        })
    }

    /// The error, relative to what was measured.
    pub fn error(&self) -> f64 {
        (self.predicted / self.measured - 1.0).abs()
    }

    /// Whether its work depends on the data.
    pub fn depends_on_data(&self) -> bool {
        self.baseline.is_none()
    }

    /// The error of the baseline.
    pub fn baseline_error(&self) -> Option<f64> {
        Some((self.baseline? / self.measured - 1.0).abs())
    }

    /// How far the halves of the measurement differ.
    pub fn repeat_error(&self) -> Option<f64> {
        self.halves.map(|[even, odd]| even.max(odd) / even.min(odd) - 1.0)
    }

    /// All that distinguishes it from the others.
    pub fn name(&self) -> String {
        format!("{}, {}, {}", self.phase, self.execution, self.place)
    }
}

/// The errors of a group of cases.
#[derive(Clone, Debug, Serialize)]
pub struct Errors {
    /// The cases.
    pub what: String,
    /// How many.
    pub cases: usize,
    /// The median error.
    pub median: f64,
    /// Nine of ten are smaller.
    pub ninth_tenth: f64,
    /// The worst.
    pub worst: f64,
    /// The median error of the baseline.
    pub baseline_median: Option<f64>,
    /// How far the halves of the measurement differ: the median.
    pub repeated: Option<f64>,
}

impl Errors {
    fn of(what: String, cases: &[&Case]) -> Errors {
        let sorted = |of: &dyn Fn(&Case) -> Option<f64>| {
            let mut values: Vec<f64> = cases.iter().filter_map(|case| of(case)).collect();
            values.sort_by(f64::total_cmp);
            values
        };
        let errors = sorted(&|case| Some(case.error()));
        let of_errors = |share| quantile(&errors, share).unwrap_or(f64::NAN);
        Errors {
            what,
            cases: cases.len(),
            median: of_errors(0.5),
            ninth_tenth: of_errors(0.9),
            worst: of_errors(1.0),
            baseline_median: quantile(&sorted(&Case::baseline_error), 0.5),
            repeated: quantile(&sorted(&Case::repeat_error), 0.5),
        }
    }
}

/// The errors of all cases, and group by group.
pub(super) fn errors(cases: &[Case]) -> Vec<Errors> {
    let mut errors = vec![];
    let mut group = |what: &str, keep: &dyn Fn(&Case) -> bool| {
        let kept: Vec<&Case> = cases.iter().filter(|case| keep(case)).collect();
        if !kept.is_empty() {
            errors.push(Errors::of(what.to_owned(), &kept));
        }
    };
    let is_phase = |case: &Case| case.phase != STEP && case.phase != STRANGER;
    group(STEPS, &|case| case.phase == STEP && !case.depends_on_data());
    group(STEPS_OF_DATA, &|case| case.phase == STEP && case.depends_on_data());
    group(PHASES, &|case| is_phase(case) && !case.depends_on_data());
    group(PHASES_OF_DATA, &|case| is_phase(case) && case.depends_on_data());
    group(STRANGERS, &|case| case.phase == STRANGER);
    for (name, _) in EXECUTIONS {
        group(&format!("whole steps, {name}"), &|case| case.phase == STEP && case.execution == name);
    }
    errors
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case(predicted: f64, execution: &'static str, phase: &'static str) -> Case {
        Case {
            place: "here".into(),
            execution,
            phase,
            predicted,
            measured: 100.0,
            halves: Some([if execution == "eager" { 102.0 } else { 150.0 }, 100.0]),
            baseline: (execution != "lists").then_some(50.0),
        }
    }

    #[test]
    fn errors_are_counted_group_by_group() {
        let cases = [
            case(102.0, "eager", "forces"),
            case(92.0, "eager", "index"),
            case(140.0, "chained", "forces"),
            case(80.0, "lists", "forces"),
            case(110.0, "eager", STRANGER),
        ];
        let errors = errors(&cases);
        let of = |what: &str| errors.iter().find(|errors| errors.what == what).unwrap();
        let programs = of(PHASES);
        assert_eq!(programs.cases, 3);
        assert!((programs.median - 0.08).abs() < 1e-9 && (programs.worst - 0.4).abs() < 1e-9);
        assert_eq!(programs.baseline_median, Some(0.5));
        assert!((programs.repeated.unwrap() - 0.02).abs() < 1e-9);
        assert_eq!((of(PHASES_OF_DATA).baseline_median, of(STRANGERS).cases), (None, 1));
    }

    #[test]
    fn a_step_is_the_sum_of_its_phases() {
        let step = Case::step(&[case(102.0, "eager", "forces"), case(92.0, "eager", "index")]).unwrap();
        assert_eq!((step.phase, step.predicted, step.measured), (STEP, 194.0, 200.0));
        assert_eq!((step.halves, step.baseline), (Some([204.0, 200.0]), Some(100.0)));
        assert!(Case::step(&[]).is_none());
    }
}
