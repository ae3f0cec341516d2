//! The box of a scene in the plane.

use super::SceneError;
use super::binding::Binding;
use super::disc_keys::SIDED;
use super::keys::Bounds::{Finite, Positive};
use super::keys::Fallback::{Is, Required};
use super::keys::Kind::{Pair, Switches};
use super::keys::{Use, Value, define_keys};
use super::values::Values;
use crate::input::Reason;

const ALWAYS: Use = None;

define_keys! {
    /// A box in the plane, with gravity.
    pub static PLANAR_DOMAIN;
    ORIGIN = "domain" "origin", Pair(Finite), "length", Is("[0.0, 0.0]"), ALWAYS,
        "Lower left corner of the box.";
    SIDES = "domain" "sides", Pair(Positive), "length", Required, SIDED,
        "Sides of the box; a hexagonal start sets them itself, from its packing fraction.";
    PERIODIC = "domain" "periodic", Switches, "", Is("[true, true]"), ALWAYS,
        "Which sides are periodic; a disc that leaves through another one stops the run.";
    GRAVITY = "domain" "gravity", Pair(Finite), "length/time²", Is("[0.0, 0.0]"), ALWAYS,
        "Acceleration of gravity.";
}

/// A box in the plane, as a scene states it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Domain {
    /// Lower left corner (length).
    pub origin: [f64; 2],
    /// Sides (length); none where a hexagonal start sets them.
    pub sides: Option<[f64; 2]>,
    /// Which sides are periodic.
    pub periodic: [bool; 2],
    /// Acceleration of gravity (length/time²).
    pub gravity: [f64; 2],
}

impl Domain {
    /// Meets its keys.
    pub fn bind(&mut self, binding: &mut dyn Binding) {
        binding.pair(&ORIGIN, &mut self.origin);
        binding.pair_if_any(&SIDES, &mut self.sides);
        binding.switches(&PERIODIC, &mut self.periodic);
        binding.pair(&GRAVITY, &mut self.gravity);
    }

    /// The box, where the scene states it.
    pub(crate) fn stated(&self) -> Option<crate::domain::Domain> {
        let sides = self.sides?;
        Some(crate::domain::Domain::planar(self.origin, sides, self.periodic))
    }
}

/// That sides are periodic as a start demands.
pub(super) fn periodic_as(values: &Values, needed: [bool; 2], why: &str) -> Option<SceneError> {
    let Some(Value::Switches(periodic)) = values.value(&PERIODIC) else { return None };
    (periodic != needed).then(|| {
        let found = Value::Switches(periodic).to_toml();
        values
            .spot(&PERIODIC)
            .error(Reason::Contradiction, format!("`domain.periodic` is {found}, but {why}"))
            .expecting(format!("periodic = {}", Value::Switches(needed).to_toml()))
    })
}
