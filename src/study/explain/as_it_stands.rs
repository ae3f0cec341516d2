//! The scene as it stands, returned instead of a plan that is no better.

use super::findings::Findings;
use super::plan::{TIME_WITHIN, own_rows};
use super::recommended::{Decision, LikelyRange, RunPlan};
use super::words::seconds;
use crate::study::StudyCase;
use stripmine_physics::number::significant;
use stripmine_physics::scene::Overrides;

/// Subject of the decision that leaves the scene as it stands.
pub(super) const AS_IT_STANDS: &str = "the scene";

/// Relative difference below which two errors are equal: rounding alone.
const ROUNDING: f64 = 1e-9;

impl RunPlan {
    /// Returns the plan, or the scene as it stands where its error is as small and it takes no longer.
    #[must_use]
    pub(super) fn or_as_it_stands(self, case: &StudyCase, findings: &Findings) -> RunPlan {
        let is_better = |own: &super::recommended::OwnResult| {
            own.seconds <= self.seconds.likely && own.error.most <= self.expected.most * (1.0 + ROUNDING)
        };
        let Some(own) = self.own.clone().filter(is_better) else { return self };
        let of_own =
            findings.configurations.iter().find(|configuration| configuration.label == case.own.label());
        let time = case.duration().unwrap_or(self.time);
        let slower = of_own
            .and_then(|configuration| configuration.step.zip(case.step()))
            .map_or(1.0, |(longest, own)| longest / own);
        let phases = of_own.map_or(vec![], |configuration| {
            configuration.phases.iter().map(|(name, cost)| (name.clone(), cost * slower * time)).collect()
        });
        let run = findings.own_run.as_ref();
        // A conserved quantity has no mean: it is judged over the whole run.
        let why = match self.mean {
            Some(_) => {
                let takes = seconds(self.seconds.likely);
                format!("no plan reaches an equally small error in less time; the best takes {takes}")
            }
            None => format!(
                "no plan reaches an equally small error in less time, over the whole run of {} with its encounters",
                significant(time, 3)
            ),
        };
        RunPlan {
            configuration: case.own.label(),
            decisions: vec![Decision {
                what: AS_IT_STANDS.to_owned(),
                chosen: "keep it as it stands".to_owned(),
                why,
                beside: vec![],
            }],
            expected: own.error,
            deviation: run.map(|run| run.deviation),
            seconds: LikelyRange::within(own.seconds, TIME_WITHIN),
            memory: case.prepared.memory.needed,
            phases,
            step: case.step(),
            time,
            rows: time / own_rows(case, case.step()),
            seeds: 1,
            overrides: Overrides::new(),
            own: None,
            ..self
        }
    }
}
