//! Scenes that plans are judged by. No constant of the planner was fitted on them.

use super::regret::Asked;

/// A scene, what is asked of it, and the error.
const fn ask(
    preset: &'static str,
    overrides: &'static [&'static str],
    quantity: &'static str,
    error: &'static str,
) -> Asked {
    Asked { preset, overrides, quantity, error }
}

/// Forty scenes: packing fractions from 0.01 to 0.7, 2 to 100 000 particles, gas to liquid and cluster, elastic to sticky, all methods.
pub const SCENES: &[Asked] = &[
    // Hard discs.
    ask("hard-disks", &["particles.count=100", "particles.packing_fraction=0.01"], "compressibility", "0.5%"),
    ask("hard-disks", &["particles.count=100", "particles.packing_fraction=0.3"], "compressibility", "0.3%"),
    ask("hard-disks", &["particles.count=1000", "particles.packing_fraction=0.5"], "compressibility", "0.3%"),
    ask("hard-disks", &["particles.count=10000", "particles.packing_fraction=0.3"], "collision_rate", "0.3%"),
    ask(
        "hard-disks",
        &["particles.count=10000", "particles.packing_fraction=0.65"],
        "compressibility",
        "0.5%",
    ),
    ask(
        "hard-disks",
        &["particles.count=50000", "particles.packing_fraction=0.1"],
        "compressibility",
        "0.2%",
    ),
    ask("melting", &["particles.count=1000", "particles.packing_fraction=0.7"], "compressibility", "1%"),
    ask("hard-disks", &["particles.count=400", "particles.packing_fraction=0.6"], "collision_rate", "1%"),
    // A bath.
    ask("langevin-free", &["particles.count=100"], "temperature", "1%"),
    ask("langevin-free", &["particles.count=10000"], "temperature", "0.3%"),
    ask("langevin-dense", &[], "potential", "0.5%"),
    ask("langevin-dense", &[], "pressure", "2%"),
    ask("langevin-dense", &[], "temperature", "1%"),
    ask("langevin-dense", &["law.kind=wca"], "pressure", "1%"),
    ask("langevin-dense", &["law.kind=wca", "domain.sides=[60.0, 60.0]"], "pressure", "1%"),
    ask("langevin-dense", &["law.kind=wca", "domain.sides=[200.0, 200.0]"], "pressure", "2%"),
    ask("langevin-dense", &["law.drag=10.0"], "potential", "0.5%"),
    ask("langevin-dense", &["law.drag=0.1"], "potential", "0.5%"),
    ask("langevin-dense", &["particles.count=100", "domain.sides=[12.0, 12.0]"], "potential", "1%"),
    ask("langevin-dense", &["particles.count=10000", "domain.sides=[120.0, 120.0]"], "potential", "0.5%"),
    ask("langevin-dense", &["law.bath_temperature=2.0"], "pressure", "1%"),
    // Granular discs, elastic and not.
    ask("dense-gas", &[], "pressure", "1%"),
    ask("dense-gas", &[], "temperature", "0.2%"),
    ask("dense-gas", &["particles.packing_fraction=0.3"], "pressure", "1%"),
    ask("dense-gas", &["particles.packing_fraction=0.05"], "pressure", "1%"),
    ask("dense-gas", &["particles.count=100", "particles.packing_fraction=0.4"], "pressure", "2%"),
    ask("dense-gas", &["particles.count=10000", "particles.packing_fraction=0.5"], "pressure", "0.5%"),
    ask("dense-gas", &["law.stiffness=1000.0", "integrator.dt=0.002"], "pressure", "1%"),
    ask("dense-gas", &["particles.temperature=0.0025"], "contacts", "2%"),
    ask("dense-gas", &[], "balance_error", "1e-4"),
    ask("dense-gas", &["particles.count=100"], "balance_error", "1e-6"),
    ask("pipe-small", &["run.time=20.0"], "flow", "10%"),
    ask("pipe-small", &["run.time=20.0", "law.friction=0.0", "law.shear_damping=0.0"], "contacts", "10%"),
    ask("shaken-box", &[], "temperature", "10%"),
    // Bodies.
    ask("kepler", &[], "energy_error", "1e-4"),
    ask("kepler", &["particles.eccentricity=0.9"], "energy_error", "1e-6"),
    ask("figure-eight", &[], "energy_error", "1e-9"),
    ask("plummer", &["particles.count=128"], "balance_error", "1e-3"),
    ask("plummer", &[], "balance_error", "1e-4"),
    ask("two-clusters", &[], "balance_error", "1e-3"),
];
