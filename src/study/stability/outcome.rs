//! Outcome of a run, and its class.

use super::averages::ObservedMeans;
use super::reference::ExpectedMeans;
use crate::study::alarm::{Alarm, WarningLevel};
use crate::study::trial::{FailureCause, RunFailure};
use serde::{Deserialize, Serialize};

/// Largest error of the energy balance, in parts of the energy that passed through.
pub(crate) const DRIFT: f64 = 0.1;

/// Class of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RunClass {
    /// Finishes with the means of the reference.
    Works,
    /// Finishes with wrong means and no other sign of failure.
    Silent,
    /// Finishes with too little energy.
    EnergyLoss,
    /// Finishes with too much energy.
    EnergyGrowth,
    /// Does not finish.
    Failed(FailureCause),
}

impl RunClass {
    /// Every class of a run that was started, from `Works` on.
    pub(crate) const BEGUN: [RunClass; 10] = [
        RunClass::Works,
        RunClass::Silent,
        RunClass::EnergyLoss,
        RunClass::EnergyGrowth,
        RunClass::Failed(FailureCause::Penetration),
        RunClass::Failed(FailureCause::MaskOutrun),
        RunClass::Failed(FailureCause::SharedCell),
        RunClass::Failed(FailureCause::ParticleLost),
        RunClass::Failed(FailureCause::NonFinite),
        RunClass::Failed(FailureCause::Other),
    ];

    pub(crate) const fn name(self) -> &'static str {
        match self {
            RunClass::Works => "works",
            RunClass::Silent => "wrong but silent",
            RunClass::EnergyLoss => "energy lost",
            RunClass::EnergyGrowth => "energy growth",
            RunClass::Failed(cause) => cause.name(),
        }
    }

    /// True if the run finishes.
    pub(crate) const fn ends(self) -> bool {
        !matches!(self, RunClass::Failed(_))
    }

    /// True if the run finishes and is wrong: a user may mistake it for a result.
    pub(crate) const fn is_undetected_failure(self) -> bool {
        self.ends() && !matches!(self, RunClass::Works)
    }
}

/// A run, or its failure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct JudgedRun {
    /// Warnings before the run.
    pub(crate) foreseen: Vec<Alarm>,
    pub end: Result<WholeTrial, RunFailure>,
}

/// Results of a run that finished.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct WholeTrial {
    /// Means over its second half.
    pub(crate) means: ObservedMeans,
    /// Root mean square speed over it (length/time).
    pub speed: f64,
    /// Error of its energy balance over the energy that passed through; none where the method has no balance.
    pub energy: Option<f64>,
    /// Warnings during the run.
    pub(crate) warned: Vec<Alarm>,
}

/// A point of a map.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MapPoint {
    pub(crate) class: RunClass,
    /// Reason for the class, in a line.
    pub what: String,
    /// True if the class is certain: for a run that works, its means could have revealed an error.
    pub(crate) is_decided: bool,
    /// Results of every limit and check.
    pub(crate) alarms: Vec<Alarm>,
}

impl MapPoint {
    /// Most severe warning before the run.
    pub(crate) fn worst_before_run(&self) -> WarningLevel {
        let before =
            self.alarms.iter().map(|alarm| alarm.finding).filter(|it| *it != WarningLevel::WarnedByRun);
        before.max().unwrap_or(WarningLevel::Within)
    }

    /// Names of the checks that warned during the run.
    pub(crate) fn warned_by_run(&self) -> Vec<&str> {
        let warned = self.alarms.iter().filter(|alarm| alarm.finding == WarningLevel::WarnedByRun);
        warned.map(|alarm| alarm.check.as_str()).collect()
    }

    /// True if the run works with certainty.
    pub(crate) fn is_right(&self) -> bool {
        self.class == RunClass::Works && self.is_decided
    }
}

impl JudgedRun {
    /// Judges the run by comparison with the expected means.
    pub(crate) fn judged(&self, expected: Option<&ExpectedMeans>) -> MapPoint {
        let (class, what) = match &self.end {
            Err(failure) => (RunClass::Failed(failure.cause), failure.why.clone()),
            Ok(whole) => whole.judged(expected),
        };
        let warned = self.end.as_ref().map_or(&[][..], |whole| &whole.warned);
        MapPoint {
            class,
            what,
            is_decided: class != RunClass::Works || expected.is_some_and(ExpectedMeans::decides),
            alarms: [&self.foreseen[..], warned].concat(),
        }
    }
}

impl WholeTrial {
    fn judged(&self, expected: Option<&ExpectedMeans>) -> (RunClass, String) {
        let drift = self.energy.unwrap_or(0.0);
        if drift.abs() > DRIFT || drift.is_nan() {
            let class = if drift < 0.0 { RunClass::EnergyLoss } else { RunClass::EnergyGrowth };
            return (
                class,
                format!(
                    "the energy balance has an error of {:.0} % of the energy that passed through",
                    100.0 * drift
                ),
            );
        }
        match expected.and_then(|expected| expected.worst(&self.means)) {
            Some(off) => (RunClass::Silent, off),
            None => (RunClass::Works, String::new()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn whole(energy: f64) -> JudgedRun {
        let end =
            WholeTrial { means: ObservedMeans::new(), speed: 1.0, energy: Some(energy), warned: vec![] };
        JudgedRun { foreseen: vec![], end: Ok(end) }
    }

    #[test]
    fn wrong_energies_are_found_by_their_sign() {
        let class = |energy: f64| whole(energy).judged(None).class;
        assert_eq!(class(0.09), RunClass::Works);
        assert_eq!([class(0.11), class(f64::NAN)], [RunClass::EnergyGrowth; 2]);
        assert_eq!(class(-0.11), RunClass::EnergyLoss);
    }
}
