//! Warnings of a run: limits of theory, checks of the scene, checks along the run.

use serde::{Deserialize, Serialize};
use stripmine_physics::method::{Prepared, RunWarning};
use stripmine_physics::number::significant;

/// Moment and weight of an alarm, rising.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Finding {
    /// The step is within the limit.
    Within,
    /// A warning before the run.
    Warned,
    /// The scene is refused.
    Refused,
    /// A warning of the run itself.
    WarnedByRun,
}

impl Finding {
    /// True if the user is told.
    pub(crate) fn is_told(self) -> bool {
        self != Finding::Within
    }
}

/// Finding of a check.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Alarm {
    pub check: String,
    pub(crate) finding: Finding,
    /// The value over its limit, above 1 where the user is told; none where nothing of the kind is allowed.
    pub share: Option<f64>,
    /// Sentence for a reader.
    pub message: String,
}

impl Alarm {
    /// Findings of a scene before it runs: every limit of its step, within it or not, and every warning of its check.
    pub(crate) fn before(scene: &Prepared) -> Vec<Alarm> {
        let mut alarms: Vec<Alarm> = vec![];
        let limits = scene.step_limits.iter().map(|limit| {
            let finding = if limit.is_passed() { Finding::Warned } else { Finding::Within };
            let share = significant(limit.share, 3);
            let message = format!("the step is {share} times the limit \"{}\" of theory", limit.name);
            (limit.name, finding, limit.share, message)
        });
        let warnings = scene.warnings.iter().map(|warning| {
            let finding = if warning.is_refusal { Finding::Refused } else { Finding::Warned };
            (warning.check, finding, warning.share, format!("checked: {}", warning.message))
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

    /// The check, its value over the limit, and the warning that it led to.
    pub(crate) fn words(&self) -> String {
        let share = self.share.map_or(String::new(), |share| format!(" {}", significant(share, 3)));
        let told = match self.finding {
            Finding::Within => "",
            Finding::Warned => " warned",
            Finding::Refused => " refused",
            Finding::WarnedByRun => " warned by the run",
        };
        format!("{}{share}{told}", self.check)
    }

    /// Warning of a run. Checks differ in the side on which their limit lies.
    pub(crate) fn of_run(warning: &RunWarning) -> Alarm {
        let share = (warning.value / warning.limit).abs();
        let share = share.max(share.recip());
        Alarm {
            check: warning.check.to_owned(),
            finding: Finding::WarnedByRun,
            share: Some(share).filter(|share| share.is_finite()),
            message: format!("warned of: {}", warning.message),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_of_a_run_rise_above_one_on_either_side_of_a_limit() {
        let share = |value: f64, limit: f64| {
            Alarm::of_run(&RunWarning { check: "c", value, limit, message: String::new() }).share
        };
        assert_eq!([share(-0.03, 0.01), share(5.0, 15.0)], [Some(3.0); 2]);
        assert_eq!([share(4.0, 0.0), share(f64::NAN, 0.01)], [None; 2]);
    }
}
