//! Box of a planar scene.

use super::SceneError;
use super::binding::Binding;
use super::disc_keys::SIDED;
use super::keys::Fallback::{Is, Otherwise};
use super::keys::KeyValueKind::{Pair, Switches};
use super::keys::NumberRange::{Finite, Positive};
use super::keys::{KeyValue, Use, define_keys};
use super::values::SceneValues;
use crate::input::MistakeKind;

const ALWAYS: Use = None;

define_keys! {
    /// Planar box with gravity.
    pub static PLANAR_DOMAIN;
    ORIGIN = "domain" "origin", Pair(Finite), "length", Is("[0.0, 0.0]"), ALWAYS,
        "Lower left corner of the box.";
    SIDES = "domain" "sides", Pair(Positive), "length", Otherwise("the box of `file`, or a box for `count` at `packing_fraction`"), SIDED,
        "Sides of the box. Without them it is that of the start file, or the one in which `count` grains have `packing_fraction`: a square, a pipe of `clear_width`, or a box of `fill_height`. A hexagonal start always computes them.";
    PERIODIC = "domain" "periodic", Switches, "", Is("[true, true]"), ALWAYS,
        "Periodicity of the sides along x and y. A disc that leaves through a closed side stops the run, unless the side is a wall.";
    GRAVITY = "domain" "gravity", Pair(Finite), "length/time²", Is("[0.0, 0.0]"), ALWAYS,
        "Acceleration of gravity.";
}

/// Planar box of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneDomain {
    /// Lower left corner (length).
    pub origin: [f64; 2],
    /// Sides (length); none if a hexagonal start sets them.
    pub sides: Option<[f64; 2]>,
    /// Periodicity of the sides.
    pub periodic: [bool; 2],
    /// Acceleration of gravity (length/time²).
    pub gravity: [f64; 2],
}

impl SceneDomain {
    /// Binds its keys.
    pub fn bind(&mut self, binding: &mut dyn Binding) {
        binding.pair(&ORIGIN, &mut self.origin);
        binding.pair_if_any(&SIDES, &mut self.sides);
        binding.switches(&PERIODIC, &mut self.periodic);
        binding.pair(&GRAVITY, &mut self.gravity);
    }

    /// Box, if the scene states its sides.
    pub(crate) fn stated(&self) -> Option<crate::domain::Domain> {
        let sides = self.sides?;
        Some(crate::domain::Domain::planar(self.origin, sides, self.periodic))
    }
}

/// Checks that sides are periodic as a start requires.
pub(super) fn check_periodicity(values: &SceneValues, needed: [bool; 2], why: &str) -> Option<SceneError> {
    let Some(KeyValue::Switches(periodic)) = values.value(&PERIODIC) else { return None };
    (periodic != needed).then(|| {
        let found = KeyValue::Switches(periodic).to_toml();
        values
            .spot(&PERIODIC)
            .error(MistakeKind::Contradiction, format!("`domain.periodic` is {found}, but {why}"))
            .expecting(format!("periodic = {}", KeyValue::Switches(needed).to_toml()))
    })
}
