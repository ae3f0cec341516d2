//! Benchmark of hard discs.

use super::quantities::QUANTITIES;
use crate::method::entry::bench_options;
use crate::method::{Bench, Until};

/// Benchmarks of the method.
pub(crate) const BENCHES: &[Bench] = &[Bench {
    name: "hard-disks",
    doc: "ISO99's event-driven hard discs",
    preset: "hard-disks",
    rate: "collisions_per_second",
    until: Until::Events,
    amount: |_| 2_000_000,
    least_warm_up: 200,
    defaults: &[("particles", "2500"), ("packing-fraction", "0.50")],
    options: bench_options! {
        "particles" [], |count| vec![format!("particles.count={count}")];
        "packing-fraction" [], |fraction| vec![format!("particles.packing_fraction={fraction}")];
        "engine" ["auto", "fast", "reference", "cell-crossing"], |engine| vec![format!("machine.engine={engine}")];
        "instruction-set" [], |set| vec![format!("machine.instruction_set={set}")];
        "mask" [], |mask| vec![format!("search.mask={mask}")];
    },
    overrides: &[],
    quantities: QUANTITIES,
    compared: &["temperature"],
    at_end: &["compressibility", "energy_error"],
}];
