//! Cases of a validation, and the errors of their predictions.

use super::EXECUTIONS;
use crate::frame::{FrameBuilder, ResultFrame};
use crate::statistics::quantile;

/// Name of a whole step among the phases.
const STEP: &str = "step";
/// Name of a program of a law without calibration.
pub(super) const UNCALIBRATED_LAW: &str = "law";
/// Number of worst cases in the table.
const NAMED: usize = 12;

/// Phase of a step of one run, a whole step, or a program of a law without calibration.
#[derive(Clone, Debug)]
pub(super) struct ValidationCase {
    /// Precision, NP and ρ; or the law and the length of the vectors.
    pub(super) place: String,
    pub(super) execution: &'static str,
    /// Name of the phase, [`STEP`] or [`UNCALIBRATED_LAW`].
    pub(super) phase: &'static str,
    /// Nanoseconds.
    pub(super) predicted: f64,
    pub(super) measured: f64,
}

impl ValidationCase {
    /// Whole step as the sum of its phases; `None` without phases.
    pub(super) fn step(phases: &[ValidationCase]) -> Option<ValidationCase> {
        let sum = |of: fn(&ValidationCase) -> f64| phases.iter().map(of).sum::<f64>();
        let (predicted, measured) = (sum(|case| case.predicted), sum(|case| case.measured));
        Some(ValidationCase { phase: STEP, predicted, measured, ..phases.first()?.clone() })
    }

    /// Error relative to the measured time.
    fn error(&self) -> f64 {
        self.predicted / self.measured - 1.0
    }

    /// Returns true if the work depends on the data.
    fn depends_on_data(&self) -> bool {
        EXECUTIONS.contains(&(self.execution, None))
    }
}

/// Frames of the errors by group, of the worst cases, and of all cases.
pub(super) fn frames(cases: &[ValidationCase]) -> [ResultFrame; 3] {
    let of = |errors: &[f64], share| 100.0 * quantile(errors, share).unwrap_or(f64::NAN);
    let mut worst: Vec<&ValidationCase> = cases.iter().collect();
    worst.sort_by(|a, b| b.error().abs().total_cmp(&a.error().abs()));
    [
        FrameBuilder::of(groups(cases))
            .text("cases of", |(what, _)| what.clone())
            .count("cases", |(_, errors)| errors.len())
            .number("median (%)", 1, |(_, errors)| of(errors, 0.5))
            .number("90 % below (%)", 1, |(_, errors)| of(errors, 0.9))
            .number("worst (%)", 1, |(_, errors)| of(errors, 1.0))
            .frame("errors", "Errors of the predictions"),
        FrameBuilder::of(worst.into_iter().take(NAMED))
            .text("case", |case| format!("{}, {}, {}", case.phase, case.execution, case.place))
            .number("predicted (ns)", 0, |case| case.predicted)
            .number("measured (ns)", 0, |case| case.measured)
            .number("error (%)", 1, |case| 100.0 * case.error())
            .frame("worst", "The worst cases"),
        FrameBuilder::of(cases)
            .text("phase", |case| case.phase)
            .text("execution", |case| case.execution)
            .text("place", |case| &case.place)
            .number("predicted (ns)", 0, |case| case.predicted)
            .number("measured (ns)", 0, |case| case.measured)
            .frame("cases", "Every case"),
    ]
}

/// Groups of cases with the sorted magnitudes of their errors.
fn groups(cases: &[ValidationCase]) -> Vec<(String, Vec<f64>)> {
    let mut groups = vec![];
    let mut group = |what: String, keep: &dyn Fn(&ValidationCase) -> bool| {
        let mut errors: Vec<f64> = cases.iter().filter(|it| keep(it)).map(|it| it.error().abs()).collect();
        errors.sort_by(f64::total_cmp);
        if !errors.is_empty() {
            groups.push((what, errors));
        }
    };
    let engines = [("eager, strip-mined and chained", false), ("fast and lists", true)];
    for (kind, is_step) in [("whole steps", true), ("phases", false)] {
        for (engine, depends) in engines {
            group(format!("{kind}, {engine}"), &|case| {
                case.phase != UNCALIBRATED_LAW
                    && (case.phase == STEP) == is_step
                    && case.depends_on_data() == depends
            });
        }
    }
    group("laws that nothing was calibrated on".into(), &|case| case.phase == UNCALIBRATED_LAW);
    for (name, _) in EXECUTIONS {
        group(format!("whole steps, {name}"), &|case| case.phase == STEP && case.execution == name);
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case(predicted: f64, execution: &'static str, phase: &'static str) -> ValidationCase {
        ValidationCase { place: "here".into(), execution, phase, predicted, measured: 100.0 }
    }

    #[test]
    fn errors_are_grouped() {
        let cases = [
            case(102.0, "eager", "forces"),
            case(92.0, "eager", "index"),
            case(140.0, "chained", "forces"),
            case(80.0, "lists", "forces"),
            case(110.0, "eager", UNCALIBRATED_LAW),
        ];
        let groups = groups(&cases);
        let of = |what: &str| &groups.iter().find(|(known, _)| known == what).unwrap().1;
        let programs = of("phases, eager, strip-mined and chained");
        let expected = [0.02, 0.08, 0.4];
        assert!(programs.iter().zip(expected).all(|(error, known)| (error - known).abs() < 1e-9));
        assert_eq!((programs.len(), of("phases, fast and lists").len()), (3, 1));
        assert_eq!(of("laws that nothing was calibrated on").len(), 1);
    }

    #[test]
    fn a_step_is_the_sum_of_its_phases() {
        let step =
            ValidationCase::step(&[case(102.0, "eager", "forces"), case(92.0, "eager", "index")]).unwrap();
        assert_eq!((step.phase, step.predicted, step.measured), (STEP, 194.0, 200.0));
        assert!(!step.depends_on_data() && ValidationCase::step(&[]).is_none());
    }
}
