//! Trials of granular discs: choices, parameters, twins and the theoretical order of the error.

use super::document::GranularDocument;
use super::encounter::encounter;
use super::hard::hard;
use super::keys::{
    COORDINATES, ENGINE, EXECUTION, FRICTION, INERTIA, INTEGRATOR, LAW, MAX_PENETRATION, NORMAL_DAMPING,
    SEARCH, SHEAR_DAMPING, STIFFNESS, VALUES,
};
use super::options::{EngineChoice, Inertia, IntegratorKind, SearchKind};
use super::quantities::QUANTITIES;
use crate::method::observed::quantity_index;
use crate::method::trials::settings;
use crate::method::{
    AxisSetting, ChoiceEffect, EnergyBalanceNames, Parameter, Prepared, SMALLEST_RADIUS, SettingAxis,
    ShadowEnergy, SimplifiedModel, StartPurpose, TheoreticalOrder, Trials, Twin,
};
use crate::scene::{
    DT, KeyValue, ORIGIN, Overrides, PACKING_FRACTION, PRECISION, Precision, RADIUS_CUT, RADIUS_SPREAD,
    SPEED, SceneValues, TEMPERATURE, VELOCITIES,
};
use crate::words::Words;
use stripmine_kernels::law::spring::Spring;
use stripmine_kernels::sweep::lattice::Coordinates;

/// Configurations of granular discs and their measures.
pub(super) static TRIALS: Trials = Trials {
    step: &DT,
    references: [
        &[("integrator", "gear6"), ("precision", "f64")],
        &[("integrator", "gear5"), ("precision", "f64")],
    ],
    balance: Some(EnergyBalanceNames {
        error: "balance_error",
        energies: &["kinetic", "rotational", "elastic"],
        inputs: &["gravity_work", "wall_work"],
    }),
    shadow: Some(ShadowEnergy { integrators: &["velocity-verlet"], temperature: "temperature" }),
    encounter,
    has_trajectories: true,
    has_late_encounters: false,
    adaptive: &[],
    length: SMALLEST_RADIUS,
    has_contacts: true,
    observables: &["temperature", "pressure", "flow", "contacts"],
    fluctuating: &["pressure", "contacts"],
    inertia,
    theory,
    parameters: PARAMETERS,
    at_any_step: |values| GranularDocument::read(values)?.prepare_at_any_step(),
};

/// Parameters that a map may vary. A value that a scene cannot have is rejected by its check and marked in the map.
const PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "stiffness",
        label: "stiffness of contacts",
        unit: "force/length^1.5",
        bounds: [1e-300, 1e300],
        is_logarithmic: true,
        range: |values| around(values.number(&STIFFNESS)?, 30.0),
        overrides: |_, value| Overrides::new().set(&STIFFNESS, value),
        marks: |_| vec![],
    },
    Parameter {
        name: "damping",
        label: "normal damping",
        unit: "1/time",
        bounds: [0.0, 1e300],
        is_logarithmic: true,
        range: |values| around(values.number(&NORMAL_DAMPING)?, 30.0),
        overrides: |_, value| Overrides::new().set(&NORMAL_DAMPING, value),
        marks: |_| vec![],
    },
    Parameter {
        name: "shear-damping",
        label: "tangential damping",
        unit: "1/time",
        bounds: [0.0, 1e300],
        is_logarithmic: true,
        range: |values| around(values.number(&SHEAR_DAMPING)?, 30.0),
        overrides: |_, value| Overrides::new().set(&SHEAR_DAMPING, value),
        marks: |_| vec![],
    },
    Parameter {
        name: "friction",
        label: "coefficient of friction",
        unit: "",
        bounds: [0.0, 1e3],
        is_logarithmic: false,
        range: |values| (values.number(&FRICTION)? > 0.0).then_some([0.0, 2.0]),
        overrides: |_, value| Overrides::new().set(&FRICTION, value),
        marks: |_| vec![],
    },
    Parameter {
        name: "density",
        label: "packing fraction",
        unit: "",
        bounds: [1e-3, 0.907],
        is_logarithmic: false,
        range: |values| values.is_given(&PACKING_FRACTION).then_some([0.05, 0.85]),
        overrides: |_, value| Overrides::new().set(&PACKING_FRACTION, value),
        marks: |_| vec![],
    },
    Parameter {
        name: "speed",
        label: "initial speed relative to that of the scene",
        unit: "",
        bounds: [0.0, 1e12],
        is_logarithmic: true,
        range: |values| (!faster(values, 1.0).is_empty()).then_some([0.1, 100.0]),
        overrides: faster,
        marks: |_| vec![],
    },
    Parameter {
        name: "size-ratio",
        label: "largest radius over smallest",
        unit: "",
        bounds: [1.0, 3.0],
        is_logarithmic: false,
        range: |values| values.is_used(&RADIUS_SPREAD).then_some([1.0, 1.6]),
        overrides: |_, ratio| {
            let cut = (ratio - 1.0) / (ratio + 1.0);
            Overrides::new().set(&RADIUS_SPREAD, 0.5 * cut).set(&RADIUS_CUT, cut)
        },
        marks: largest_ratio,
    },
    Parameter {
        name: "distance-from-origin",
        label: "distance of the box from the origin of coordinates",
        unit: "length",
        bounds: [0.0, 1e12],
        is_logarithmic: true,
        range: |values| (values.choice(&PRECISION)? != Precision::F64.word()).then_some([10.0, 1e6]),
        overrides: |_, value| {
            Overrides::new()
                .set(&ORIGIN, [value; 2])
                .set(&ENGINE, EngineChoice::Programs)
                .set(&COORDINATES, Coordinates::Absolute)
        },
        marks: |_| vec![],
    },
];

/// Ratio of radii up to which a cell for one smallest disc can have the side of BP93, the largest radius: √2 (1 − max_penetration).
fn largest_ratio(values: &SceneValues) -> Vec<(f64, String)> {
    let ratio = values.number(&MAX_PENETRATION).map(|depth| std::f64::consts::SQRT_2 * (1.0 - depth));
    ratio
        .map(|ratio| (ratio, format!("{ratio:.4}: limit of the lattice with 5 × 5 cells")))
        .into_iter()
        .collect()
}

/// Returns the range from a fraction of a value to a multiple.
fn around(value: f64, factor: f64) -> Option<[f64; 2]> {
    (value > 0.0).then_some([value / factor, value * factor])
}

/// Returns overrides that multiply the initial speeds by a factor.
fn faster(values: &SceneValues, factor: f64) -> Overrides {
    let mut overrides = Overrides::new();
    for (key, power) in [(&TEMPERATURE, 2), (&SPEED, 1)] {
        if let Some(value) = values.number(key) {
            overrides = overrides.set(key, value * factor.powi(power));
        }
    }
    match values.value(&VELOCITIES) {
        Some(KeyValue::Pairs(all)) => {
            let all: Vec<[f64; 2]> = all.iter().map(|pair| pair.map(|part| factor * part)).collect();
            overrides.set(&VELOCITIES, all)
        }
        _ => overrides,
    }
}

/// Simpler models of a scene.
pub(super) const TWINS: &[Twin] = &[
    Twin {
        name: "friction and spin",
        becomes: SimplifiedModel::Overridden(|values| {
            (values.number(&FRICTION)? > 0.0)
                .then(|| Overrides::new().set(&FRICTION, 0.0).set(&SHEAR_DAMPING, 0.0))
        }),
    },
    Twin {
        name: "a spread of radii",
        becomes: SimplifiedModel::Overridden(|values| {
            let spreads = values.is_used(&RADIUS_SPREAD) && values.number(&RADIUS_SPREAD)? > 0.0;
            spreads.then(|| Overrides::new().set(&RADIUS_SPREAD, 0.0))
        }),
    },
    Twin {
        name: "three quarters of the stiffness",
        becomes: SimplifiedModel::Overridden(|values| {
            Some(Overrides::new().set(&STIFFNESS, 0.25 * values.number(&STIFFNESS)?))
        }),
    },
    Twin {
        name: "softness (hard discs from collision to collision)",
        becomes: SimplifiedModel::Rewritten(hard),
    },
];

pub(super) const AXES: &[SettingAxis] = &[
    SettingAxis {
        name: "integrator",
        decides: ChoiceEffect::Order,
        settings: settings! {
            "velocity-verlet" [INTEGRATOR = IntegratorKind::VelocityVerlet],
            "gear4" [INTEGRATOR = IntegratorKind::Gear, VALUES = 4_u64],
            "gear5" [INTEGRATOR = IntegratorKind::Gear, VALUES = 5_u64],
            "gear6" [INTEGRATOR = IntegratorKind::Gear, VALUES = 6_u64],
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
            "lattice" [SEARCH = SearchKind::Lattice],
            "sectors" [SEARCH = SearchKind::Sectors],
            "neighbor-list" [SEARCH = SearchKind::NeighborList],
        },
        own: |prepared| fact_of(prepared, "search"),
    },
    SettingAxis {
        name: "execution",
        decides: ChoiceEffect::Cost,
        settings: settings! {
            "fast" [ENGINE = EngineChoice::Fast],
            "chained" [ENGINE = EngineChoice::Programs, EXECUTION = "chained"],
            "eager" [ENGINE = EngineChoice::Programs, EXECUTION = "eager"],
        },
        own: |prepared| setting_of(prepared, "execution"),
    },
];

fn setting_of(prepared: &Prepared, name: &str) -> Option<String> {
    Some(prepared.settings.get(name)?.as_str()?.to_owned())
}

fn fact_of(prepared: &Prepared, name: &str) -> Option<String> {
    let fact =
        prepared.facts.iter().filter_map(|fact| fact.data.as_ref()).find(|(known, _)| *known == name)?;
    Some(fact.1.as_str()?.to_owned())
}

fn inertia(values: &SceneValues) -> Option<f64> {
    let has_friction =
        [&FRICTION, &SHEAR_DAMPING].iter().all(|key| values.number(key).is_some_and(|v| v > 0.0));
    let inertia = values.choice(&INERTIA).and_then(|word| Inertia::parse(&word))?;
    has_friction.then(|| inertia.factor())
}

/// Returns the order of positions after contacts: that of the scheme, unless the law or the start reduces it.
fn theory(values: &SceneValues, prepared: &Prepared, integrator: &AxisSetting) -> Option<TheoreticalOrder> {
    let is_damped = values.number(&NORMAL_DAMPING)? > 0.0;
    let scheme = match integrator.name {
        "velocity-verlet" if is_damped => (1.0, "velocities of the damping lag by half a step"),
        "velocity-verlet" => (2.0, "the order of the scheme"),
        "gear4" => (3.0, "the order of the scheme"),
        "gear5" => (4.0, "the order of the scheme"),
        _ => (5.0, "the order of the scheme"),
    };
    let jump = (1.0, "the damping force jumps from zero where a contact begins");
    let spring = values.choice(&LAW).and_then(|word| Spring::parse(&word))?;
    let kink = (spring.exponent() + 1.0, spring.kink());
    let touching =
        (2.0, "moving discs touch at the start, and Gear's scheme starts without third derivatives");
    let is_gear = integrator.name != "velocity-verlet";
    let start = (is_gear && touches(prepared)).then_some(touching);
    let law = if is_damped { jump } else { kink };
    // Of several equal orders the first is named.
    let least =
        [Some(law), start, Some(scheme)].into_iter().flatten().reduce(|a, b| if b.0 < a.0 { b } else { a });
    least.map(|(order, why)| TheoreticalOrder { order, why })
}

/// True if moving discs touch at the start; with all discs at rest the third derivatives are zero.
fn touches(prepared: &Prepared) -> bool {
    let moves = prepared.particles().grains().iter().any(|disc| disc.velocity != [0.0; 3]);
    const CONTACTS: usize = quantity_index(QUANTITIES, "contacts");
    let started = || prepared.start(StartPurpose::Measurement);
    moves && started().is_ok_and(|simulation| simulation.observe()[CONTACTS] > 0.0)
}
