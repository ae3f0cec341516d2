//! What is observed and what is measured of bodies.

use crate::method::{Bench, BenchOption, Quantity, Until};

macro_rules! quantities {
    ($($name:literal, $unit:literal, $doc:literal;)*) => {
        &[$(Quantity { name: $name, unit: $unit, doc: $doc }),*]
    };
}

/// What is observed, in the order of the columns.
pub(super) const QUANTITIES: &[Quantity] = quantities! {
    "time", "time", "The time.";
    "kinetic", "energy", "Kinetic energy.";
    "potential", "energy", "Energy of the softened pairs.";
    "energy_error", "", "The energy less that of the start, over that of the start.";
    "virial_ratio", "", "Kinetic energy over the magnitude of the potential energy: 0.5 in equilibrium.";
    "momentum", "mass·length/time", "Magnitude of the momentum.";
    "angular_momentum_x", "mass·length²/time", "Angular momentum about the origin, along x.";
    "angular_momentum_y", "mass·length²/time", "The same along y.";
    "angular_momentum_z", "mass·length²/time", "The same along z.";
    "centre", "length", "Distance of the centre of mass from the origin.";
    "balance_error", "energy", "The energy less that of the start.";
    "half_mass_radius", "length", "Distance from the centre of mass within which half of the mass is.";
};

macro_rules! options {
    ($($name:literal, $values:expr, $overrides:expr;)*) => {
        &[$(BenchOption { name: $name, values: &$values, overrides: $overrides }),*]
    };
}

/// What makes a bench of an engine: only the fast one has estimated roots.
fn of_engine(engine: &str, mut more: Vec<String>) -> Vec<String> {
    if engine != "fast" {
        more.push("machine.arithmetic=exact".to_owned());
    }
    more.push(format!("machine.engine={engine}"));
    more
}

/// The benchmark.
pub(super) const BENCHES: &[Bench] = &[Bench {
    name: "nbody",
    doc: "PWP's all-pairs gravity",
    preset: "plummer",
    rate: "interactions_per_second",
    until: Until::Steps,
    // Two thousand million directed interactions.
    amount: |bodies| (2_000_000_000 / (bodies * bodies).max(1)).clamp(5, 20_000),
    defaults: &[("particles", "4096")],
    options: options! {
        "particles", [], |count| vec![format!("particles.count={count}")];
        "precision", ["f64", "mixed"], |precision| vec![format!("machine.precision={precision}")];
        "integrator", [], |kind| vec![format!("integrator.kind={kind}")];
        "engine", ["fast", "programs", "reference"], |engine| of_engine(engine, vec![]);
        "execution", [], |execution| of_engine("programs", vec![format!("machine.execution={execution}")]);
        "arithmetic", ["exact", "estimated", "raw"], |kind| vec![format!("machine.arithmetic={kind}")];
        "instruction-set", [], |set| vec![format!("machine.instruction_set={set}")];
    },
    overrides: &["machine.engine=fast", "machine.arithmetic=estimated"],
    quantities: QUANTITIES,
    compared: &["virial_ratio"],
    at_end: &["energy_error"],
}];
