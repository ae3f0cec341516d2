//! What is observed and what is measured of particles in a bath.

use crate::method::{Bench, BenchOption, Quantity, Until};

macro_rules! quantities {
    ($($name:literal, $unit:literal, $doc:literal;)*) => {
        &[$(Quantity { name: $name, unit: $unit, doc: $doc }),*]
    };
}

/// What is observed, in the order of the columns.
pub(super) const QUANTITIES: &[Quantity] = quantities! {
    "time", "time", "The time.";
    "kinetic", "energy", "Kinetic energy; by baoab of the velocities after the bath, which have m⟨v²⟩ = kT but for higher orders than dt², where those of the end of the step, in trajectory.xyz, are low by dt²⟨F²⟩/(4 m).";
    "potential", "energy", "Energy of the pairs.";
    "temperature", "energy", "Kinetic energy a particle and dimension: over N, for a bath does not conserve momentum, and all 2 N degrees of freedom have its temperature.";
    "pressure", "force/length", "Pressure of the motion and of the pairs, over the area of the box.";
    "msd", "length²", "Mean square displacement since the start, by the positions as if there were no sides.";
    "rms", "length", "Its root.";
    "momentum_x", "mass·length/time", "Momentum along x.";
    "momentum_y", "mass·length/time", "Momentum along y.";
    "lost", "", "Particles lost since the start.";
};

macro_rules! options {
    ($($name:literal, $values:expr, $overrides:expr;)*) => {
        &[$(BenchOption { name: $name, values: &$values, overrides: $overrides }),*]
    };
}

/// The benchmark: the source's system.
pub(super) const BENCHES: &[Bench] = &[Bench {
    name: "langevin",
    doc: "LAN17's particles in a bath",
    preset: "langevin-report",
    rate: "particle_steps_per_second",
    until: Until::Steps,
    amount: |particles| (40_000_000 / particles.max(1)).clamp(20, 20_000),
    defaults: &[("particles", "40000")],
    options: options! {
        // The source's density, 4 particles in a unit of area.
        "particles", [], |count| {
            let side = count.parse::<f64>().map_or(100.0, |count| (count / 4.0).sqrt());
            vec![format!("particles.count={count}"), format!("domain.sides=[{side:?}, {side:?}]")]
        };
        "law", ["none", "wca", "lennard-jones"], |law| vec![format!("law.kind={law}")];
        "search", ["auto", "lattice", "sectors", "neighbor-list"], |by| vec![format!("search.by={by}")];
        "sectors", [], |count| vec!["search.by=sectors".to_owned(), format!("search.sectors={count}")];
        "sort", ["auto", "when-needed", "every-step"], |sort| {
            vec!["search.by=sectors".to_owned(), format!("search.sort={sort}")]
        };
        "skin", [], |skin| vec!["search.by=neighbor-list".to_owned(), format!("search.skin={skin}")];
        "integrator", ["baoab", "stochastic", "as-printed"], |kind| vec![format!("integrator.kind={kind}")];
        "precision", [], |precision| vec![format!("machine.precision={precision}")];
        "instruction-set", [], |set| vec![format!("machine.instruction_set={set}")];
    },
    overrides: &["integrator.dt=0.001"],
    quantities: QUANTITIES,
    compared: &["temperature"],
    at_end: &["pressure"],
}];
