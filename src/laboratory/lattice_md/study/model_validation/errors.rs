//! The cases of a validation, and how far off their predictions are.

use super::EXECUTIONS;
use serde::Serialize;
use stripmine_physics::method::lattice_md::Phase;

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
    /// Their lowest tenth (ns).
    pub low: f64,
    /// Their quartiles (ns).
    pub quartiles: [f64; 2],
    /// The middles of the rounds of even and of odd number (ns); none of a single round.
    pub halves: Option<[f64; 2]>,
    /// Operations times elements, at the cost of a sum in the cache (ns); none where work depends on the data.
    pub baseline: Option<f64>,
    /// Whether its work depends on the data.
    pub depends_on_data: bool,
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
            low: sum(&|case| case.low),
            quartiles: [0, 1].map(|at| sum(&|case| case.quartiles[at])),
            halves: halves.map(|all| [0, 1].map(|at: usize| all.iter().map(|halves| halves[at]).sum())),
            baseline: baselines.map(|all| all.iter().sum()),
            ..first.clone()
        })
    }

    /// The error, relative to what was measured.
    pub fn error(&self) -> f64 {
        (self.predicted / self.measured - 1.0).abs()
    }

    /// The same of the lowest tenth.
    pub fn error_of_low(&self) -> f64 {
        (self.predicted / self.low - 1.0).abs()
    }

    /// The error of the baseline.
    pub fn baseline_error(&self) -> Option<f64> {
        Some((self.baseline? / self.measured - 1.0).abs())
    }

    /// How far the measurement repeated differs from itself.
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
    /// Cases within 5, 10, 15 and 25 %.
    pub within: [usize; 4],
    /// The median error where the lowest tenth of the samples counts.
    pub median_of_low: f64,
    /// The median error of the baseline.
    pub baseline_median: Option<f64>,
    /// How far the measurement repeated differs from itself: the median, and nine of ten.
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
        let both = |of: &dyn Fn(&Case) -> Option<f64>| {
            Some([0.5, 0.9].map(|share| quantile(&sorted(of), share))).filter(|shares| shares[0].is_finite())
        };
        Errors {
            what,
            cases: cases.len(),
            median: quantile(&errors, 0.5),
            ninth_tenth: quantile(&errors, 0.9),
            worst: quantile(&errors, 1.0),
            within: [0.05, 0.1, 0.15, 0.25]
                .map(|limit| errors.iter().filter(|&&error| error <= limit).count()),
            median_of_low: quantile(&sorted(&|case| Some(case.error_of_low())), 0.5),
            baseline_median: Some(quantile(&sorted(&Case::baseline_error), 0.5))
                .filter(|median| median.is_finite()),
            repeated: both(&Case::repeat_error),
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
    group(STEPS, &|case| case.phase == STEP && !case.depends_on_data);
    group(STEPS_OF_DATA, &|case| case.phase == STEP && case.depends_on_data);
    group(PHASES, &|case| is_phase(case) && !case.depends_on_data);
    group(PHASES_OF_DATA, &|case| is_phase(case) && case.depends_on_data);
    group(STRANGERS, &|case| case.phase == STRANGER);
    for (name, _) in EXECUTIONS {
        group(&format!("whole steps, {name}"), &|case| case.phase == STEP && case.execution == name);
    }
    for phase in Phase::ALL {
        group(&format!("{} of programs", phase.name()), &|case| {
            !case.depends_on_data && case.phase == phase.name()
        });
    }
    for phase in Phase::ALL {
        group(&format!("{} of fast and lists", phase.name()), &|case| {
            case.depends_on_data && case.phase == phase.name()
        });
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
            low: 80.0,
            quartiles: [99.0, 101.0],
            halves: Some([if execution == "eager" { 102.0 } else { 150.0 }, 100.0]),
            baseline: (execution != "lists").then_some(50.0),
            depends_on_data: execution == "lists",
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
        assert_eq!((programs.cases, programs.within), (3, [1, 2, 2, 2]));
        assert!((programs.median - 0.08).abs() < 1e-9 && (programs.worst - 0.4).abs() < 1e-9);
        assert!((programs.median_of_low - 0.275).abs() < 1e-9, "{}", programs.median_of_low);
        assert_eq!(programs.baseline_median, Some(0.5));
        assert!((programs.repeated.unwrap()[0] - 0.02).abs() < 1e-9);
        assert_eq!((of(PHASES_OF_DATA).baseline_median, of(STRANGERS).cases), (None, 1));
    }

    #[test]
    fn a_step_is_the_sum_of_its_phases() {
        let step = Case::step(&[case(102.0, "eager", "forces"), case(92.0, "eager", "index")]).unwrap();
        assert_eq!((step.phase, step.predicted, step.measured, step.low), (STEP, 194.0, 200.0, 160.0));
        assert_eq!((step.halves, step.baseline), (Some([204.0, 200.0]), Some(100.0)));
        assert!(Case::step(&[]).is_none());
    }
}
