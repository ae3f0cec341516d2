//! Means of two configurations with their errors, and their difference over its error.

use crate::cli::display::{mean_or_reason, reasons};
use crate::report::{FormattedTable, FrameBuilder, TableCell};
use serde::Serialize;
use stripmine_physics::averages::{Average, AverageOutcome, RunAverages};

/// Mean of a quantity in two configurations.
#[derive(Clone, Debug, Serialize)]
pub(super) struct ComparedMean {
    first: Average,
    second: Average,
    /// Second mean less the first (the quantity's unit); none if one has no mean.
    difference: Option<f64>,
    /// Standard error of the difference, √(s₁² + s₂²): the two runs count as independent.
    standard_error: Option<f64>,
    /// Difference over its standard error.
    sigmas: Option<f64>,
}

/// Compares the means of quantities that both configurations have.
pub(super) fn compared_means([first, second]: [RunAverages; 2]) -> Vec<ComparedMean> {
    let twin = |of: &Average| second.quantities.iter().find(|it| it.quantity == of.quantity).cloned();
    first.quantities.into_iter().filter_map(|first| Some(ComparedMean::of(twin(&first)?, first))).collect()
}

impl ComparedMean {
    fn of(second: Average, first: Average) -> ComparedMean {
        let both = match (&first.outcome, &second.outcome) {
            (AverageOutcome::Mean(one), AverageOutcome::Mean(other)) => {
                Some([one, other].map(|it| [it.mean, it.standard_error]))
            }
            _ => None,
        };
        let [difference, standard_error] = [0, 1].map(|at| both.map(|both| difference_with_error(both)[at]));
        let sigmas = difference.zip(standard_error).map(|(difference, error)| difference / error);
        ComparedMean { first, second, difference, standard_error, sigmas: sigmas.filter(|it| it.is_finite()) }
    }
}

/// Second mean less the first and its standard error, from both means with theirs.
fn difference_with_error([one, other]: [[f64; 2]; 2]) -> [f64; 2] {
    [other[0] - one[0], one[1].hypot(other[1])]
}

/// Table of the means, one line for each quantity.
pub(super) fn means_table(means: &[ComparedMean]) -> FormattedTable {
    FrameBuilder::of(means)
        .text("quantity", |it| it.first.quantity)
        .text("first ± 95 %", |it| mean_or_reason(&it.first))
        .text("second ± 95 %", |it| mean_or_reason(&it.second))
        .cell("σ", |it| it.sigmas.map_or(TableCell::Nothing, |sigmas| TableCell::Number(sigmas, 1)))
        .table("means", "Means of both configurations")
        .notes(reasons(means.iter().flat_map(|it| [&it.first, &it.second])))
        .note("σ: second mean less the first, over the standard error √(s₁² + s₂²) of independent runs. Beyond 3 it is hardly chance.")
}

#[cfg(test)]
mod tests {
    use super::difference_with_error;

    /// By hand: 2.5 − 2 = 0.5, and √(0.03² + 0.04²) = 0.05.
    #[test]
    fn errors_of_both_means_are_combined() {
        let [difference, error] = difference_with_error([[2.0, 0.03], [2.5, 0.04]]);
        assert!((difference - 0.5).abs() < 1e-12 && (error - 0.05).abs() < 1e-12);
    }
}
