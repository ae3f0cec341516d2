//! What becomes of a run, and which kind of failure that is.

use super::alarm::{Alarm, Finding};
use super::reference::Expected;
use crate::study::averages::Means;
use serde::{Deserialize, Serialize};
use stripmine_physics::method::FailureKind;

/// The energy is wrong where its balance is off by more than this part of the energy that passed through.
pub const DRIFT: f64 = 0.1;

/// What becomes of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Class {
    /// It comes to its end, and its means are those of the reference.
    Works,
    /// It comes to its end with means that are wrong, and nothing stops it.
    Silent,
    /// It comes to its end with less energy than there should be.
    EnergyLoss,
    /// It comes to its end with more energy than there should be.
    EnergyGrowth,
    Penetration,
    /// A particle moves so far in a step that contacts pass unseen.
    MaskOutrun,
    /// Two particles are where one may be.
    SharedCell,
    ParticleLost,
    /// Numbers that are none.
    NonFinite,
    Stopped,
    /// The scene cannot be, whatever the step.
    Refused,
}

impl Class {
    /// Every class with its name, from what works on.
    pub const ALL: [(Class, &'static str); 11] = [
        (Class::Works, "works"),
        (Class::Silent, "wrong but silent"),
        (Class::EnergyLoss, "energy lost"),
        (Class::EnergyGrowth, "energy growth"),
        (Class::Penetration, "penetration"),
        (Class::MaskOutrun, "mask outrun"),
        (Class::SharedCell, "two in a cell"),
        (Class::ParticleLost, "particle lost"),
        (Class::NonFinite, "non-finite"),
        (Class::Stopped, "stopped otherwise"),
        (Class::Refused, "no such scene"),
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        Class::ALL.iter().find(|(class, _)| *class == self).map_or("", |(_, name)| name)
    }

    /// Whether the run comes to its end.
    pub const fn ends(self) -> bool {
        matches!(self, Class::Works | Class::Silent | Class::EnergyLoss | Class::EnergyGrowth)
    }

    /// Whether the run comes to its end and is wrong: what a user may take for a result.
    pub const fn is_unseen(self) -> bool {
        self.ends() && !matches!(self, Class::Works)
    }

    /// The class of what stops a run.
    pub fn of(kind: FailureKind) -> Class {
        match kind {
            FailureKind::NOT_FINITE | FailureKind::OVERFLOW => Class::NonFinite,
            FailureKind::OUT_OF_BOX => Class::ParticleLost,
            FailureKind::CONFLICT => Class::SharedCell,
            FailureKind::TOO_DEEP => Class::Penetration,
            FailureKind::LONG_STEP => Class::MaskOutrun,
            _ => Class::Stopped,
        }
    }
}

/// A run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ran {
    /// Findings of the scene before the run.
    pub foreseen: Vec<Alarm>,
    pub end: End,
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum End {
    /// It was never begun, or stopped, and why.
    Broken(Class, String),
    Whole {
        /// Means over its second half.
        means: Means,
        /// The root mean square speed over it (length/time).
        speed: f64,
        /// The error of its energy over the energy that passed through; none where that is not followed.
        energy: Option<f64>,
        /// Warnings of the run.
        warned: Vec<Alarm>,
    },
}

/// A place of a map.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    pub class: Class,
    /// What was seen, in a line.
    pub what: String,
    /// Whether the class is certain: means of a run that works might have told it from a wrong one.
    pub is_decided: bool,
    /// Findings of every limit and check.
    pub alarms: Vec<Alarm>,
}

impl Cell {
    /// The gravest finding before the run.
    pub fn foreseen(&self) -> Finding {
        let before = self.alarms.iter().map(|alarm| alarm.finding).filter(|it| *it != Finding::WarnedByRun);
        before.max().unwrap_or(Finding::Within)
    }

    /// Names of the checks that found something.
    pub fn checks(&self, is_meant: impl Fn(Finding) -> bool) -> Vec<&str> {
        let found = self.alarms.iter().filter(|alarm| is_meant(alarm.finding));
        found.map(|alarm| alarm.check.as_str()).collect()
    }

    /// Whether the run itself warned.
    pub fn warned_by_run(&self) -> bool {
        self.alarms.iter().any(|alarm| alarm.finding == Finding::WarnedByRun)
    }

    /// Whether the run works for certain.
    pub fn is_right(&self) -> bool {
        self.class == Class::Works && self.is_decided
    }
}

impl Ran {
    /// The run held against what is expected of it.
    pub fn judged(&self, expected: Option<&Expected>) -> Cell {
        let decides = || expected.is_some_and(Expected::decides);
        let cell = |class: Class, what: String, warned: &[Alarm]| Cell {
            class,
            what,
            is_decided: class != Class::Works || decides(),
            alarms: [&self.foreseen[..], warned].concat(),
        };
        match &self.end {
            End::Broken(class, what) => cell(*class, what.clone(), &[]),
            End::Whole { means, energy, warned, .. } => {
                let drift = energy.unwrap_or(0.0);
                if drift.abs() > DRIFT || drift.is_nan() {
                    let class = if drift < 0.0 { Class::EnergyLoss } else { Class::EnergyGrowth };
                    let what = format!("the energy is off by {:.0} % of what passed through", 100.0 * drift);
                    return cell(class, what, warned);
                }
                match expected.and_then(|expected| expected.worst(means)) {
                    Some(off) => cell(Class::Silent, off, warned),
                    None => cell(Class::Works, String::new(), warned),
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn whole(energy: f64) -> Ran {
        let end = End::Whole { means: Means::new(), speed: 1.0, energy: Some(energy), warned: vec![] };
        Ran { foreseen: vec![], end }
    }

    #[test]
    fn wrong_energies_are_found_by_their_sign() {
        let class = |energy: f64| whole(energy).judged(None).class;
        assert_eq!(class(0.09), Class::Works);
        assert_eq!([class(0.11), class(f64::NAN)], [Class::EnergyGrowth; 2]);
        assert_eq!(class(-0.11), Class::EnergyLoss);
    }
}
