//! What is measured of hard discs.

use super::quantities::QUANTITIES;
use crate::method::{Bench, BenchOption, Until};

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
