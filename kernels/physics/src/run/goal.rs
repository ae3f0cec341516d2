//! The end of a run by what is known of a mean.

use crate::averages::{Average, Estimate, Outcome, Rows};
use crate::method::{Prepared, Quantity};
use crate::scene::{Target, Width};

/// Rows at which the mean is looked at first.
const FIRST: u64 = 32;
/// Then whenever there is this part more of them: looking is little beside the run, and chance has few tries.
const PART: u64 = 8;
/// Independent samples that end a run, more than a mean needs: of many looks the one with the shortest bar ends it.
const FEWEST_SAMPLES: f64 = 30.0;

/// The mean that a run is to find.
#[derive(Clone, Debug)]
pub(super) struct Goal {
    target: Target,
    place: usize,
    /// Rows of the last look, and whether it was reached then.
    looked: (u64, bool),
}

/// How well a mean is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Known {
    /// Half the width of its interval of 95 %, in the terms of the target; none where there is no mean.
    pub(super) error: Option<Width>,
    /// About when it is known well enough (time); none where nothing tells.
    pub(super) enough_at: Option<f64>,
    pub(super) is_enough: bool,
}

impl Goal {
    /// That of a scene, if it has one.
    pub(super) fn of(prepared: &Prepared, quantities: &[Quantity]) -> Option<Goal> {
        let target = prepared.target.clone()?;
        let place = quantities.iter().position(|quantity| quantity.name == target.quantity)?;
        Some(Goal { target, place, looked: (0, false) })
    }

    /// What is asked for.
    pub(super) fn target(&self) -> &Target {
        &self.target
    }

    /// Whether it is reached, where it is the time to look: after a number of rows, the same in however many sessions.
    pub(super) fn is_reached(&mut self, rows: &Rows) -> bool {
        let count = rows.count();
        if self.looked.0 != count {
            self.looked = (count, is_looked_at(count) && self.known(rows).is_enough);
        }
        self.looked.1
    }

    /// What is known now.
    pub(super) fn known(&self, rows: &Rows) -> Known {
        match Average::of(rows, self.place).outcome {
            Outcome::Mean(found) => self.of_mean(&found),
            Outcome::TooShort { enough_at, .. } => {
                Known { error: None, enough_at: Some(enough_at), is_enough: false }
            }
            // What has not varied may do so later.
            Outcome::Constant { .. }
            | Outcome::Undefined
            | Outcome::Changing { .. }
            | Outcome::Kept { .. } => Known { error: None, enough_at: None, is_enough: false },
        }
    }

    fn of_mean(&self, found: &Estimate) -> Known {
        let error = self.target.error.same_of(found.mean, found.bar);
        let wanted = match (self.target.error, error) {
            (Width::Percent(wanted), Width::Percent(found)) => found / wanted,
            (Width::Absolute(wanted), Width::Absolute(found)) => found / wanted,
            _ => f64::INFINITY,
        };
        // The square of the error goes with the time that is averaged over.
        let longer = wanted.powi(2).max(FEWEST_SAMPLES / found.independent_samples).max(1.0);
        let has_samples = found.independent_samples >= FEWEST_SAMPLES;
        Known {
            error: has_samples.then_some(error),
            enough_at: Some(found.equilibrated_at + found.span * longer),
            is_enough: has_samples && self.target.error.holds(found.mean, found.bar),
        }
    }
}

fn is_looked_at(rows: u64) -> bool {
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
    fn looks_come_at_numbers_of_rows_that_grow() {
        let looks: Vec<u64> = (0..60).filter(|&rows| is_looked_at(rows)).collect();
        assert_eq!(looks, [32, 36, 40, 45, 50, 56]);
        assert!((0..1_000_000).filter(|&rows| is_looked_at(rows)).count() < 100);
    }
}
