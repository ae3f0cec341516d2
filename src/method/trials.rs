//! What a method states of its trials: what may be varied of a scene without changing what is simulated, and what theory
//! says of it. Studies of speed, accuracy and stability know a method by this alone.

use super::entry::Prepared;
use crate::scene::{Key, Values};

/// How the scenes of a method may be run, and what is measured of them.
#[derive(Debug)]
pub struct Trials {
    /// The key of the step (time).
    pub step: &'static Key,
    /// What may be chosen; every combination that the method's check accepts is a way to run the scene.
    pub axes: &'static [Axis],
    /// The settings of the reference, one for each axis it names, the most accurate there is; and of a second one with
    /// another integrator, against which it is held.
    pub references: [&'static [(&'static str, &'static str)]; 2],
    /// The quantity that is the error of the energy's balance, and those whose magnitudes add up to its scale.
    pub balance: Option<(&'static str, &'static [&'static str])>,
    /// Quantities that have a mean in a run: what is left of a comparison once trajectories have parted.
    pub observables: &'static [&'static str],
    /// Whether particles rotate, and their moment of inertia over m R² if so.
    pub inertia: fn(&Values) -> Option<f64>,
    /// The order of convergence of positions that theory gives for a setting of the axis that decides it.
    pub theory: fn(&Values, &dyn Prepared, &Setting) -> Option<Theory>,
    /// Scenes that `reproduce` shows: name, preset and overrides.
    pub shown: &'static [(&'static str, &'static str, &'static [&'static str])],
}

/// Something that may be chosen.
#[derive(Debug)]
pub struct Axis {
    /// Its name.
    pub name: &'static str,
    /// What the choice decides.
    pub decides: Decides,
    /// The settings.
    pub settings: &'static [Setting],
    /// The setting of a scene as it was prepared; none if it is not among these.
    pub own: fn(&dyn Prepared) -> Option<String>,
}

/// What a choice decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decides {
    /// The order of convergence.
    Order,
    /// The digits.
    Digits,
    /// The cost; results are equal but for rounding.
    Cost,
}

/// A setting of an axis.
#[derive(Debug)]
pub struct Setting {
    /// Its name.
    pub name: &'static str,
    /// The overrides that it makes in a scene.
    pub overrides: &'static [&'static str],
}

/// What theory says of the error of positions at the end of a short run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Theory {
    /// The power of the step with which the error falls.
    pub order: f64,
    /// What decides it.
    pub why: &'static str,
}

impl Axis {
    /// The setting of a name.
    pub fn setting(&self, name: &str) -> Option<&'static Setting> {
        self.settings.iter().find(|setting| setting.name == name)
    }
}
