//! What is observed and what is measured of hard discs.

use crate::method::{Bench, BenchOption, Quantity, Until};

macro_rules! quantities {
    ($($name:literal, $unit:literal, $doc:literal;)*) => {
        &[$(Quantity { name: $name, unit: $unit, doc: $doc }),*]
    };
}

/// What is observed, in the order of the columns.
pub const QUANTITIES: &[Quantity] = quantities! {
    "time", "time", "The time.";
    "events", "", "Collisions since the start, of pairs and at walls.";
    "collisions", "", "Collisions of pairs since the start.";
    "kinetic", "energy", "Kinetic energy.";
    "energy_error", "", "The kinetic energy less that of the start, over that of the start: rounding where all collisions are elastic.";
    "temperature", "energy", "Kinetic energy a disc and dimension, about the mean motion: over N, also where momentum is conserved and 2 N − 2 degrees of freedom move; the temperature of these is N/(N − 1) times it.";
    "momentum_x", "mass·length/time", "Momentum along x.";
    "momentum_y", "mass·length/time", "Momentum along y.";
    "virial", "mass·length²/time", "Impulse times distance of the centres, summed over the collisions since the start.";
    "compressibility", "", "Z = p A/(N kT): 1 + virial/(2 N kT t) since the start, with the temperature as it is.";
    "collision_rate", "1/time", "Collisions of a disc in a unit of time since the start: twice the collisions of pairs over the discs.";
};

/// The benchmark.
pub const BENCHES: &[Bench] = &[Bench {
    name: "hard-disks",
    doc: "ISO99's event-driven hard discs",
    preset: "hard-disks",
    rate: "collisions_per_second",
    until: Until::Events,
    amount: |_| 2_000_000,
    defaults: &[("particles", "2500"), ("packing-fraction", "0.50")],
    options: &[
        BenchOption {
            name: "particles",
            values: &[],
            overrides: |count| vec![format!("particles.count={count}")],
        },
        BenchOption {
            name: "packing-fraction",
            values: &[],
            overrides: |fraction| vec![format!("particles.packing_fraction={fraction}")],
        },
        BenchOption {
            name: "engine",
            values: &["auto", "fast", "reference"],
            overrides: |engine| vec![format!("machine.engine={engine}")],
        },
        BenchOption {
            name: "instruction-set",
            values: &[],
            overrides: |set| vec![format!("machine.instruction_set={set}")],
        },
        BenchOption { name: "mask", values: &[], overrides: |mask| vec![format!("search.mask={mask}")] },
    ],
    overrides: &[],
    quantities: QUANTITIES,
    compared: &["temperature"],
    at_end: &["compressibility", "energy_error"],
}];
