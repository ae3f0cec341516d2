//! Configurations and stability parameters of Langevin dynamics.

use super::checked::prepare;
use super::keys::{BATH_TEMPERATURE, DRAG, INTEGRATOR, SEARCH};
use super::laws::STRENGTH;
use super::options::{PairSearchKind, SchemeKind};
use crate::method::trials::settings;
use crate::method::{ChoiceEffect, Parameter, Prepared, SMALLEST_RADIUS, SettingAxis, Trials};
use crate::scene::{DT, Key, Overrides, PRECISION, Precision, SceneValues};

/// Trial configurations of particles in a bath.
pub(super) static TRIALS: Trials = Trials {
    step: &DT,
    references: [
        &[("integrator", "baoab"), ("precision", "f64")],
        &[("integrator", "stochastic"), ("precision", "f64")],
    ],
    // A bath exchanges energy with the particles.
    balance: None,
    shadow: None,
    encounter: |_, _| None,
    has_trajectories: false,
    has_late_encounters: false,
    adaptive: &[],
    length: SMALLEST_RADIUS,
    has_contacts: false,
    observables: &["temperature", "potential", "pressure"],
    fluctuating: &[],
    inertia: |_| None,
    theory: |_, _, _| None,
    parameters: PARAMETERS,
    at_any_step: prepare,
};

pub(super) const AXES: &[SettingAxis] = &[
    SettingAxis {
        name: "integrator",
        decides: ChoiceEffect::Order,
        settings: settings! {
            "baoab" [INTEGRATOR = SchemeKind::Baoab],
            "stochastic" [INTEGRATOR = SchemeKind::Stochastic],
        },
        own: |prepared| setting_of(prepared, "integrator"),
    },
    SettingAxis {
        name: "precision",
        decides: ChoiceEffect::Precision,
        settings: settings! {
            "f64" [PRECISION = Precision::F64],
            "mixed" [PRECISION = Precision::Mixed],
            "f32" [PRECISION = Precision::F32],
        },
        own: |prepared| setting_of(prepared, "precision"),
    },
    SettingAxis {
        name: "search",
        decides: ChoiceEffect::Cost,
        settings: settings! {
            "neighbor-list" [SEARCH = PairSearchKind::NeighborList],
            "sectors" [SEARCH = PairSearchKind::Sectors],
            "lattice" [SEARCH = PairSearchKind::Lattice],
        },
        own: |prepared| setting_of(prepared, "search"),
    },
];

/// Parameters that a stability map may vary.
const PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "strength",
        label: "strength ε of the pairs",
        unit: "energy",
        bounds: [1e-300, 1e300],
        is_logarithmic: true,
        range: |values| around(values, &STRENGTH),
        overrides: |_, value| Overrides::new().set(&STRENGTH, value),
        marks: |_| vec![],
    },
    Parameter {
        name: "temperature",
        label: "temperature kT of the bath",
        unit: "energy",
        bounds: [1e-300, 1e300],
        is_logarithmic: true,
        range: |values| around(values, &BATH_TEMPERATURE),
        overrides: |_, value| Overrides::new().set(&BATH_TEMPERATURE, value),
        marks: |_| vec![],
    },
    Parameter {
        name: "friction",
        label: "friction γ of the bath",
        unit: "mass/time",
        bounds: [1e-300, 1e300],
        is_logarithmic: true,
        range: |values| around(values, &DRAG),
        overrides: |_, value| Overrides::new().set(&DRAG, value),
        marks: |_| vec![],
    },
];

/// Range from a thirtieth of a value to thirty times the value.
fn around(values: &SceneValues, key: &Key) -> Option<[f64; 2]> {
    values.number(key).filter(|value| *value > 0.0).map(|value| [value / 30.0, value * 30.0])
}

fn setting_of(prepared: &Prepared, name: &str) -> Option<String> {
    Some(prepared.settings.get(name)?.as_str()?.to_owned())
}
