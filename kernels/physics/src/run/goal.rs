//! End of a run at a target error of a mean.

use crate::averages::{Average, AverageOutcome, AveragedRows, Estimate};
use crate::method::{ObservedQuantity, Prepared};
use crate::scene::{MeanTarget, Width};

/// Number of rows at the first check of the mean.
const FIRST: u64 = 32;
/// Inverse of the fraction by which rows grow between checks: checks then cost little, and a lucky one is unlikely.
const PART: u64 = 8;
/// Independent samples that end a run, more than a mean needs: of many checks, the one with the smallest error bar ends it.
const FEWEST_SAMPLES: f64 = 30.0;

/// Target error of a run, with the state of its checks.
#[derive(Clone, Debug)]
pub(super) struct RunGoal {
    target: MeanTarget,
    place: usize,
    /// Number of rows at the last check, and true if the target was reached then.
    looked: (u64, bool),
}

/// Present error of a mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TargetProgress {
    /// Half-width of the 95 % confidence interval, in the terms of the target; none without a mean.
    pub(super) error: Option<Width>,
    /// Estimated time at which the target is reached (time); none if unknown.
    pub(super) enough_at: Option<f64>,
    pub(super) is_enough: bool,
}

impl RunGoal {
    /// Goal of a scene, if it has one.
    pub(super) fn of(prepared: &Prepared, quantities: &[ObservedQuantity]) -> Option<RunGoal> {
        let target = prepared.target.clone()?;
        let place = quantities.iter().position(|quantity| quantity.name == target.quantity)?;
        Some(RunGoal { target, place, looked: (0, false) })
    }

    /// Target error.
    pub(super) fn target(&self) -> &MeanTarget {
        &self.target
    }

    /// Returns true if the target is reached. It is checked at certain numbers of rows, which are the same for any number of sessions.
    pub(super) fn is_reached(&mut self, rows: &AveragedRows) -> bool {
        let count = rows.count();
        if self.looked.0 != count {
            self.looked = (count, is_checked_at(count) && self.progress_to_target(rows).is_enough);
        }
        self.looked.1
    }

    /// Present error of the mean.
    pub(super) fn progress_to_target(&self, rows: &AveragedRows) -> TargetProgress {
        match Average::of(rows, self.place).outcome {
            AverageOutcome::Mean(found) => self.of_mean(&found),
            AverageOutcome::TooShort { enough_at, .. } => {
                TargetProgress { error: None, enough_at: Some(enough_at), is_enough: false }
            }
            // A quantity that has been constant may vary later.
            AverageOutcome::Constant { .. }
            | AverageOutcome::Undefined
            | AverageOutcome::Changing { .. }
            | AverageOutcome::Kept { .. } => {
                TargetProgress { error: None, enough_at: None, is_enough: false }
            }
        }
    }

    fn of_mean(&self, found: &Estimate) -> TargetProgress {
        let error = self.target.error.in_same_terms(found.mean, found.bar);
        let wanted = match (self.target.error, error) {
            (Width::Percent(wanted), Width::Percent(found)) => found / wanted,
            (Width::Absolute(wanted), Width::Absolute(found)) => found / wanted,
            _ => f64::INFINITY,
        };
        // The squared error is inversely proportional to the averaged time.
        let longer = wanted.powi(2).max(FEWEST_SAMPLES / found.independent_samples).max(1.0);
        let has_samples = found.independent_samples >= FEWEST_SAMPLES;
        TargetProgress {
            error: has_samples.then_some(error),
            enough_at: Some(found.equilibrated_at + found.span * longer),
            is_enough: has_samples && self.target.error.admits_half_width(found.mean, found.bar),
        }
    }
}

fn is_checked_at(rows: u64) -> bool {
    let mut next = FIRST;
    while next < rows {
        next += next / PART;
    }
    next == rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checks_come_at_growing_row_counts() {
        let looks: Vec<u64> = (0..60).filter(|&rows| is_checked_at(rows)).collect();
        assert_eq!(looks, [32, 36, 40, 45, 50, 56]);
        assert!((0..1_000_000).filter(|&rows| is_checked_at(rows)).count() < 100);
    }
}
