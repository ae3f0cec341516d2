//! What is measured of hard discs.

use super::quantities::QUANTITIES;
use crate::method::entry::bench_options;
use crate::method::{Bench, Until};

/// The benchmark.
pub const BENCHES: &[Bench] = &[Bench {
    name: "hard-disks",
    doc: "ISO99's event-driven hard discs",
    preset: "hard-disks",
    rate: "collisions_per_second",
    until: Until::Events,
    amount: |_| 2_000_000,
    defaults: &[("particles", "2500"), ("packing-fraction", "0.50")],
    options: bench_options! {
        "particles" Count [], |count| vec![format!("particles.count={count}")], "Number of particles, at least";
        "packing-fraction" Number [], |fraction| vec![format!("particles.packing_fraction={fraction}")], "Area of the discs over that of the box";
        "engine" Word ["auto", "fast", "reference"], |engine| vec![format!("machine.engine={engine}")], "What moves the particles: auto, fast, or programs of lattice MD, reference of hard discs; the fastest by default";
        "instruction-set" Word [], |set| vec![format!("machine.instruction_set={set}")], "scalar, avx2, avx512, wide, or auto for the widest there is";
        "mask" Word [], |mask| vec![format!("search.mask={mask}")], "Mask of cells around a disc, such as min or r3; the cheapest by default";
    },
    overrides: &[],
    quantities: QUANTITIES,
    compared: &["temperature"],
    at_end: &["compressibility", "energy_error"],
}];
