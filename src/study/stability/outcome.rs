//! Outcome of a run, and its class.

use super::averages::Means;
use super::reference::Expected;
use crate::study::alarm::{Alarm, Finding};
use crate::study::trial::{Cause, RunFailure};
use serde::{Deserialize, Serialize};

/// Largest error of the energy balance, in parts of the energy that passed through.
pub(crate) const DRIFT: f64 = 0.1;

/// Class of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Class {
    /// Finishes with the means of the reference.
    Works,
    /// Finishes with wrong means and no other sign of failure.
    Silent,
    /// Finishes with too little energy.
    EnergyLoss,
    /// Finishes with too much energy.
    EnergyGrowth,
    /// Does not finish.
    Failed(Cause),
}

impl Class {
    /// Every class of a run that was started, from `Works` on.
    pub(crate) const BEGUN: [Class; 10] = [
        Class::Works,
        Class::Silent,
        Class::EnergyLoss,
        Class::EnergyGrowth,
        Class::Failed(Cause::Penetration),
        Class::Failed(Cause::MaskOutrun),
        Class::Failed(Cause::SharedCell),
        Class::Failed(Cause::ParticleLost),
        Class::Failed(Cause::NonFinite),
        Class::Failed(Cause::Other),
    ];

    pub(crate) const fn name(self) -> &'static str {
        match self {
            Class::Works => "works",
            Class::Silent => "wrong but silent",
            Class::EnergyLoss => "energy lost",
            Class::EnergyGrowth => "energy growth",
            Class::Failed(cause) => cause.name(),
        }
    }

    /// True if the run finishes.
    pub(crate) const fn ends(self) -> bool {
        !matches!(self, Class::Failed(_))
    }

    /// True if the run finishes and is wrong: a user may mistake it for a result.
    pub(crate) const fn is_unseen(self) -> bool {
        self.ends() && !matches!(self, Class::Works)
    }
}

/// A run, or its failure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Ran {
    /// Warnings before the run.
    pub(crate) foreseen: Vec<Alarm>,
    pub end: Result<Whole, RunFailure>,
}

/// Results of a run that finished.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Whole {
    /// Means over its second half.
    pub(crate) means: Means,
    /// Root mean square speed over it (length/time).
    pub speed: f64,
    /// Error of its energy balance over the energy that passed through; none where the method has no balance.
    pub energy: Option<f64>,
    /// Warnings during the run.
    pub(crate) warned: Vec<Alarm>,
}

/// A point of a map.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Cell {
    pub(crate) class: Class,
    /// Reason for the class, in a line.
    pub what: String,
    /// True if the class is certain: for a run that works, its means could have revealed an error.
    pub(crate) is_decided: bool,
    /// Results of every limit and check.
    pub(crate) alarms: Vec<Alarm>,
}

impl Cell {
    /// Most severe warning before the run.
    pub(crate) fn foreseen(&self) -> Finding {
        let before = self.alarms.iter().map(|alarm| alarm.finding).filter(|it| *it != Finding::WarnedByRun);
        before.max().unwrap_or(Finding::Within)
    }

    /// Names of the checks that warned during the run.
    pub(crate) fn warned_by_run(&self) -> Vec<&str> {
        let warned = self.alarms.iter().filter(|alarm| alarm.finding == Finding::WarnedByRun);
        warned.map(|alarm| alarm.check.as_str()).collect()
    }

    /// True if the run works with certainty.
    pub(crate) fn is_right(&self) -> bool {
        self.class == Class::Works && self.is_decided
    }
}

impl Ran {
    /// Judges the run by comparison with the expected means.
    pub(crate) fn judged(&self, expected: Option<&Expected>) -> Cell {
        let (class, what) = match &self.end {
            Err(failure) => (Class::Failed(failure.cause), failure.why.clone()),
            Ok(whole) => whole.judged(expected),
        };
        let warned = self.end.as_ref().map_or(&[][..], |whole| &whole.warned);
        Cell {
            class,
            what,
            is_decided: class != Class::Works || expected.is_some_and(Expected::decides),
            alarms: [&self.foreseen[..], warned].concat(),
        }
    }
}

impl Whole {
    fn judged(&self, expected: Option<&Expected>) -> (Class, String) {
        let drift = self.energy.unwrap_or(0.0);
        if drift.abs() > DRIFT || drift.is_nan() {
            let class = if drift < 0.0 { Class::EnergyLoss } else { Class::EnergyGrowth };
            return (
                class,
                format!(
                    "the energy balance has an error of {:.0} % of the energy that passed through",
                    100.0 * drift
                ),
            );
        }
        match expected.and_then(|expected| expected.worst(&self.means)) {
            Some(off) => (Class::Silent, off),
            None => (Class::Works, String::new()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn whole(energy: f64) -> Ran {
        let end = Whole { means: Means::new(), speed: 1.0, energy: Some(energy), warned: vec![] };
        Ran { foreseen: vec![], end: Ok(end) }
    }

    #[test]
    fn wrong_energies_are_found_by_their_sign() {
        let class = |energy: f64| whole(energy).judged(None).class;
        assert_eq!(class(0.09), Class::Works);
        assert_eq!([class(0.11), class(f64::NAN)], [Class::EnergyGrowth; 2]);
        assert_eq!(class(-0.11), Class::EnergyLoss);
    }
}
