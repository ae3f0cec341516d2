//! How granular discs may be run, and what theory says of the error.

use super::benches::QUANTITIES;
use super::keys::{FRICTION, INERTIA, NORMAL_DAMPING, SHEAR_DAMPING};
use super::options::Inertia;
use crate::method::{Axis, Decides, Prepared, Purpose, Setting, Theory, Trials};
use crate::scene::{DT, Values};
use crate::words::Words;

macro_rules! settings {
    ($($name:literal [$($override:literal),*],)*) => {
        &[$(Setting { name: $name, overrides: &[$($override),*] }),*]
    };
}

/// Every way to run a scene of granular discs.
pub(super) static TRIALS: Trials = Trials {
    step: &DT,
    axes: AXES,
    references: [
        &[("integrator", "gear6"), ("precision", "f64")],
        &[("integrator", "gear5"), ("precision", "f64")],
    ],
    balance: Some(("balance_error", &["kinetic", "rotational", "elastic"])),
    observables: &["temperature", "flow", "contacts"],
    inertia,
    theory,
    shown: &[
        ("two-discs", "two-discs", &["run.time=3.2"]),
        ("dense-gas", "dense-gas", &["particles.count=100"]),
        ("pipe-small", "pipe-small", &[]),
        ("shaken-box", "shaken-box", &[]),
    ],
};

const AXES: &[Axis] = &[
    Axis {
        name: "integrator",
        decides: Decides::Order,
        settings: settings! {
            "velocity-verlet" ["integrator.kind=velocity-verlet"],
            "gear4" ["integrator.kind=gear", "integrator.values=4"],
            "gear5" ["integrator.kind=gear", "integrator.values=5"],
            "gear6" ["integrator.kind=gear", "integrator.values=6"],
        },
        own: |prepared| setting_of(prepared, "integrator"),
    },
    Axis {
        name: "precision",
        decides: Decides::Digits,
        settings: settings! {
            "f64" ["machine.precision=f64"],
            "mixed" ["machine.precision=mixed"],
            "f32" ["machine.precision=f32"],
        },
        own: |prepared| setting_of(prepared, "precision"),
    },
    Axis {
        name: "search",
        decides: Decides::Cost,
        settings: settings! {
            "lattice" ["search.by=lattice"],
            "sectors" ["search.by=sectors"],
            "neighbor-list" ["search.by=neighbor-list"],
        },
        own: |prepared| fact_of(prepared, "search"),
    },
    Axis {
        name: "execution",
        decides: Decides::Cost,
        settings: settings! {
            "fast" ["machine.engine=fast"],
            "chained" ["machine.engine=programs", "machine.execution=chained"],
            "eager" ["machine.engine=programs", "machine.execution=eager"],
        },
        own: |prepared| setting_of(prepared, "execution"),
    },
];

fn setting_of(prepared: &dyn Prepared, name: &str) -> Option<String> {
    Some(prepared.settings().get(name)?.as_str()?.to_owned())
}

fn fact_of(prepared: &dyn Prepared, name: &str) -> Option<String> {
    let fact = prepared.facts().into_iter().filter_map(|fact| fact.data).find(|(known, _)| *known == name)?;
    Some(fact.1.as_str()?.to_owned())
}

fn inertia(values: &Values) -> Option<f64> {
    let has_friction =
        [&FRICTION, &SHEAR_DAMPING].iter().all(|key| values.number(key).is_some_and(|v| v > 0.0));
    let inertia = values.choice(&INERTIA).and_then(|word| Inertia::parse(&word))?;
    has_friction.then(|| inertia.factor())
}

/// The order of positions after contacts: that of the scheme, or what the law, or the start, leaves of it.
fn theory(values: &Values, prepared: &dyn Prepared, integrator: &Setting) -> Option<Theory> {
    let is_damped = values.number(&NORMAL_DAMPING)? > 0.0;
    let scheme = match integrator.name {
        "velocity-verlet" if is_damped => (1.0, "velocities of the damping lag by half a step"),
        "velocity-verlet" => (2.0, "the order of the scheme"),
        "gear4" => (3.0, "the order of the scheme"),
        "gear5" => (4.0, "the order of the scheme"),
        _ => (5.0, "the order of the scheme"),
    };
    let jump = (1.0, "the damping force jumps from zero where a contact begins");
    let kink = (2.5, "the Hertz force ξ^1.5 has a kink where a contact begins and ends");
    let touching =
        (2.0, "moving discs touch at the start, and Gear's scheme begins without the third derivatives");
    let is_gear = integrator.name != "velocity-verlet";
    let start = (is_gear && touches(prepared)).then_some(touching);
    let law = if is_damped { jump } else { kink };
    // Earlier ones are named where several are equal.
    let least =
        [Some(law), start, Some(scheme)].into_iter().flatten().reduce(|a, b| if b.0 < a.0 { b } else { a });
    least.map(|(order, why)| Theory { order, why })
}

/// Whether discs touch at the start while they move; where all are at rest the third derivatives are zero.
fn touches(prepared: &dyn Prepared) -> bool {
    let moves = prepared.particles().grains().iter().any(|disc| disc.velocity != [0.0; 3]);
    let place = QUANTITIES.iter().position(|quantity| quantity.name == "contacts");
    let observed = || prepared.start(Purpose::Measurement).ok().map(|simulation| simulation.observe());
    let contacts = |place: usize| Some(*observed()?.get(place)?);
    moves && place.and_then(contacts).is_some_and(|contacts| contacts > 0.0)
}
