//! Trial configurations of bodies, and the theoretical order of their error.

use super::checked::prepare;
use super::keys::{ECCENTRICITY, ENGINE, INTEGRATOR, SOFTENING};
use super::options::ForceEngine;
use super::schemes::SchemeName;
use crate::method::trials::settings;
use crate::method::{
    AxisSetting, ChoiceEffect, DistanceUnit, EnergyBalanceNames, Parameter, Prepared, SettingAxis,
    TheoreticalOrder, Trials, Twin,
};
use crate::particles::{Particle, Particles};
use crate::scene::{DT, Overrides, PRECISION, Precision, SceneValues};

/// Trial configurations of bodies. Studies use the x-y plane, in which the orbits of two and three bodies lie.
pub(super) static TRIALS: Trials = Trials {
    step: &DT,
    references: [
        &[("integrator", "yoshida-8"), ("precision", "f64")],
        &[("integrator", "gear-6"), ("precision", "f64")],
    ],
    balance: Some(EnergyBalanceNames {
        error: "balance_error",
        energies: &["kinetic", "potential"],
        inputs: &[],
    }),
    shadow: None,
    encounter: |_, _| None,
    has_trajectories: true,
    has_late_encounters: true,
    adaptive: &["ias15"],
    length: DistanceUnit { unit: "sizes of the system", of: size },
    has_contacts: false,
    observables: &["virial_ratio", "half_mass_radius"],
    fluctuating: &[],
    inertia: |_| None,
    theory,
    parameters: PARAMETERS,
    at_any_step: prepare,
};

/// Simplifications of a scene.
pub(super) const TWINS: &[Twin] = &[];

pub(super) const AXES: &[SettingAxis] = &[
    SettingAxis {
        name: "integrator",
        decides: ChoiceEffect::Order,
        settings: settings! {
            "damped-euler" [INTEGRATOR = SchemeName::DampedEuler],
            "leapfrog" [INTEGRATOR = SchemeName::Leapfrog],
            "yoshida-4" [INTEGRATOR = SchemeName::Yoshida4],
            "yoshida-6" [INTEGRATOR = SchemeName::Yoshida6],
            "yoshida-8" [INTEGRATOR = SchemeName::Yoshida8],
            "runge-kutta-4" [INTEGRATOR = SchemeName::RungeKutta4],
            "hermite-4" [INTEGRATOR = SchemeName::Hermite4],
            "gear-6" [INTEGRATOR = SchemeName::Gear6],
            "ias15" [INTEGRATOR = SchemeName::Ias15],
        },
        own: |prepared| setting_of(prepared, "integrator"),
    },
    SettingAxis {
        name: "precision",
        decides: ChoiceEffect::Precision,
        settings: settings! {
            "f64" [PRECISION = Precision::F64],
            "mixed" [PRECISION = Precision::Mixed],
        },
        own: |prepared| setting_of(prepared, "precision"),
    },
    SettingAxis {
        name: "engine",
        decides: ChoiceEffect::Cost,
        settings: settings! {
            "fast" [ENGINE = ForceEngine::Fast],
            "reference" [ENGINE = ForceEngine::Reference],
        },
        own: |prepared| setting_of(prepared, "engine"),
    },
];

const PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "eccentricity",
        label: "eccentricity of the orbit",
        unit: "",
        bounds: [0.0, 0.999],
        is_logarithmic: false,
        range: |values| values.is_used(&ECCENTRICITY).then_some([0.0, 0.95]),
        overrides: |_, value| Overrides::new().set(&ECCENTRICITY, value),
        marks: |_| vec![],
    },
    Parameter {
        name: "softening",
        label: "softening of the attraction",
        unit: "length",
        bounds: [1e-300, 1e300],
        is_logarithmic: true,
        range: |values| values.number(&SOFTENING).filter(|it| *it > 0.0).map(|it| [it / 30.0, it * 30.0]),
        overrides: |_, value| Overrides::new().set(&SOFTENING, value),
        marks: |_| vec![],
    },
];

fn setting_of(prepared: &Prepared, name: &str) -> Option<String> {
    Some(prepared.settings.get(name)?.as_str()?.to_owned())
}

/// Order of the position error: that of the scheme, as the forces are smooth.
fn theory(_: &SceneValues, _: &Prepared, integrator: &AxisSetting) -> Option<TheoreticalOrder> {
    let order = match integrator.name {
        "damped-euler" => 1.0,
        "leapfrog" => 2.0,
        "yoshida-6" => 6.0,
        "yoshida-8" => 8.0,
        "gear-6" => 5.0,
        "ias15" => 15.0,
        _ => 4.0,
    };
    Some(TheoreticalOrder { order, why: "the order of the scheme" })
}

/// Root mean square distance of the bodies from their mean position at the start (length).
fn size(particles: &Particles) -> f64 {
    let all = particles.all();
    let count = all.len() as f64;
    let middle = [0, 1, 2].map(|axis| all.iter().map(|body| body.position[axis]).sum::<f64>() / count);
    let square =
        |body: &Particle| (0..3).map(|axis| (body.position[axis] - middle[axis]).powi(2)).sum::<f64>();
    (all.iter().map(square).sum::<f64>() / count).sqrt()
}
