//! Warnings of a run: theoretical limits, checks of the scene, and checks during the run.

use serde::{Deserialize, Serialize};
use stripmine_physics::method::{Prepared, RunWarning};
use stripmine_physics::number::significant;

/// Time and severity of a warning, in rising order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum WarningLevel {
    Within,
    Warned,
    Refused,
    WarnedByRun,
}

impl WarningLevel {
    /// True if the user is warned.
    pub(crate) fn is_warning(self) -> bool {
        self != WarningLevel::Within
    }
}

/// Result of a check.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Alarm {
    pub check: String,
    pub(crate) finding: WarningLevel,
    /// Value over its limit, above 1 where the user is warned; none where any value is an error.
    pub share: Option<f64>,
    /// Message for the user.
    pub message: String,
}

impl Alarm {
    /// Results of all checks before a run: every limit of its step, exceeded or not, and every warning of its check.
    pub(crate) fn before(scene: &Prepared) -> Vec<Alarm> {
        let mut alarms: Vec<Alarm> = vec![];
        let limits = scene.step_limits.iter().map(|limit| {
            let finding = if limit.is_passed() { WarningLevel::Warned } else { WarningLevel::Within };
            let share = significant(limit.share, 3);
            let message = format!("the step is {share} times the theoretical limit \"{}\"", limit.name);
            (limit.name, finding, limit.share, message)
        });
        let warnings = scene.warnings.iter().map(|warning| {
            let finding = if warning.is_refusal { WarningLevel::Refused } else { WarningLevel::Warned };
            (warning.check, finding, warning.share, format!("check: {}", warning.message))
        });
        for (check, finding, share, message) in limits.chain(warnings) {
            let share = Some(share).filter(|share| share.is_finite());
            match alarms.iter_mut().find(|alarm| alarm.check == check) {
                Some(known) => known.finding = known.finding.max(finding),
                None => alarms.push(Alarm { check: check.to_owned(), finding, share, message }),
            }
        }
        alarms
    }

    /// Describes the check, its value over the limit, and the resulting warning.
    pub(crate) fn words(&self) -> String {
        let share = self.share.map_or(String::new(), |share| format!(" {}", significant(share, 3)));
        let told = match self.finding {
            WarningLevel::Within => "",
            WarningLevel::Warned => " warned",
            WarningLevel::Refused => " refused",
            WarningLevel::WarnedByRun => " warned by the run",
        };
        format!("{}{share}{told}", self.check)
    }

    /// Warning during a run. The limit of a check may be an upper or a lower bound.
    pub(crate) fn of_run(warning: &RunWarning) -> Alarm {
        let share = (warning.value / warning.limit).abs();
        let share = share.max(share.recip());
        Alarm {
            check: warning.check.to_owned(),
            finding: WarningLevel::WarnedByRun,
            share: Some(share).filter(|share| share.is_finite()),
            message: format!("warning: {}", warning.message),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exceeded_limits_have_shares_above_one() {
        let share = |value: f64, limit: f64| {
            Alarm::of_run(&RunWarning { check: "c", value, limit, message: String::new() }).share
        };
        assert_eq!([share(-0.03, 0.01), share(5.0, 15.0)], [Some(3.0); 2]);
        assert_eq!([share(4.0, 0.0), share(f64::NAN, 0.01)], [None; 2]);
    }
}
