//! The cases of a validation, and how far off their predictions are.

use super::runs::{EXECUTIONS, PRECISIONS, UNSETTLED};
use crate::method::lattice_md::Phase;
use crate::method::lattice_md::study::phase_times::{FAST, FAST_LISTS, LISTS, QUIET};
use serde::Serialize;

/// The group of all executions of programs.
pub const PROGRAMS: &str = "eager, strip-mined and chained";
/// The group of all executions whose work depends on the data.
pub const OF_DATA: &str = "fast and lists";

/// Those among the first that were measured on an undisturbed core, and whose halves are no more than [`UNSETTLED`] apart: no
/// prediction can be shown to be nearer than that.
pub const PROGRAMS_SETTLED: &str = "eager, strip-mined and chained, undisturbed and repeated within 10 %";
/// Those among the second.
pub const OF_DATA_SETTLED: &str = "fast and lists, undisturbed and repeated within 10 %";

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
    /// Nanoseconds on an undisturbed core: the sum over the segments of a low quantile of the samples.
    pub measured: f64,
    /// The sums over the segments of the lower and of the upper quartile of the samples.
    pub quartiles: [f64; 2],
    /// The same by the rounds of even number alone and by those of odd number; none of one round. Every round lays the run
    /// out again, in other pages of memory.
    pub halves: Option<[f64; 2]>,
    /// The share that was measured on an undisturbed core, and not corrected for a slowdown.
    pub quiet: f64,
    /// Nanoseconds by the trivial baseline: operations times elements, at the cost of a sum in the cache; none where
    /// what is executed depends on the data.
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
        self.halves.map(|[even, odd]| even.max(odd) / even.min(odd) - 1.0)
    }

    /// Whether what is executed depends on the data.
    pub fn depends_on_data(&self) -> bool {
        [FAST, FAST_LISTS, LISTS].contains(&self.execution)
    }

    /// All that distinguishes it from the others.
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
        let both = |of: &dyn Fn(&Case) -> Option<f64>| {
            Some([0.5, 0.9].map(|share| quantile(&sorted(of), share))).filter(|shares| shares[0].is_finite())
        };
        Errors {
            what,
            cases: cases.len(),
            median: quantile(&errors, 0.5),
            ninth_tenth: quantile(&errors, 0.9),
            worst: quantile(&errors, 1.0),
            within: [0.05, 0.1, 0.2, 0.3].map(|limit| errors.iter().filter(|&&error| error <= limit).count()),
            baseline_median: Some(quantile(&sorted(&Case::baseline_error), 0.5))
                .filter(|median| median.is_finite()),
            repeated: both(&Case::repeat_error),
        }
    }
}

/// The errors by execution, phase and precision.
pub(super) fn errors(cases: &[Case]) -> Vec<Errors> {
    let mut errors = vec![];
    let mut group = |what: &str, keep: &dyn Fn(&Case) -> bool| {
        let kept: Vec<&Case> = cases.iter().filter(|case| keep(case)).collect();
        if !kept.is_empty() {
            errors.push(Errors::of(what.to_owned(), &kept));
        }
    };
    group(PROGRAMS, &|case| !case.depends_on_data());
    group(OF_DATA, &Case::depends_on_data);
    let settled =
        |case: &Case| case.quiet >= QUIET && case.repeat_error().is_some_and(|apart| apart <= UNSETTLED);
    group(PROGRAMS_SETTLED, &|case| !case.depends_on_data() && settled(case));
    group(OF_DATA_SETTLED, &|case| case.depends_on_data() && settled(case));
    EXECUTIONS.iter().for_each(|(name, _)| group(name, &|case| case.execution == *name));
    let straight = |case: &Case| !case.depends_on_data();
    Phase::ALL.iter().for_each(|phase| {
        group(&format!("{} of programs", phase.name()), &|case| straight(case) && case.phase == phase.name());
    });
    Phase::ALL.iter().for_each(|phase| {
        let of_data = |case: &Case| case.depends_on_data() && case.phase == phase.name();
        group(&format!("{} of fast and lists", phase.name()), &of_data);
    });
    PRECISIONS.iter().for_each(|name| group(name, &|case| straight(case) && case.precision == *name));
    errors
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
            halves: Some([if execution == "eager" { 102.0 } else { 150.0 }, 100.0]),
            quiet: 1.0,
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
        assert_eq!((of(PROGRAMS_SETTLED).cases, of(PROGRAMS_SETTLED).within), (2, [1, 2, 2, 2]));
    }
}
