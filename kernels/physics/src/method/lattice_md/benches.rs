//! Benchmarks of granular discs.

use super::quantities::QUANTITIES;
use crate::method::entry::bench_options;
use crate::method::{Bench, BenchOption, Until};

/// One benchmark for each contact search, by its name.
pub(super) const BENCHES: &[Bench] = &[
    Bench { name: "lattice", doc: "BP93's lattice method", overrides: &["search.by=lattice"], ..GRANULAR },
    Bench {
        name: "neighbor-list",
        doc: "Neighbour lists: BP93's alternative to the lattice",
        overrides: &["search.by=neighbor-list"],
        ..GRANULAR
    },
    Bench {
        name: "sectors",
        doc: "Sectors that hold any number of discs",
        overrides: &["search.by=sectors"],
        ..GRANULAR
    },
];

/// Benchmark shared by all contact searches.
const GRANULAR: Bench = Bench {
    name: "",
    doc: "",
    preset: "bench",
    rate: "particle_steps_per_second",
    until: Until::Steps,
    // About 10⁷ particle-steps a second, to the order of magnitude.
    amount: |particles| (10_000_000 / particles.max(1)).clamp(20, 20_000),
    least_warm_up: 200,
    defaults: &[("particles", "10000"), ("packing-fraction", "0.84"), ("integrator", "gear5")],
    options: OPTIONS,
    overrides: &[],
    quantities: QUANTITIES,
    compared: &["temperature"],
    at_end: &["contacts"],
};

/// Options shared by all of them.
const OPTIONS: &[BenchOption] = bench_options! {
    "particles" [], |count| vec![format!("particles.count={count}")];
    "packing-fraction" [], |fraction| vec![format!("particles.packing_fraction={fraction}")];
    "precision" [], |precision| vec![format!("machine.precision={precision}")];
    "integrator" ["gear4", "gear5", "gear6", "velocity-verlet"], |name| match name.strip_prefix("gear") {
        Some(values) => vec![format!("integrator.values={values}")],
        None => vec![format!("integrator.kind={name}")],
    };
    "engine" ["auto", "fast", "programs"], |engine| vec![format!("machine.engine={engine}")];
    // BP93 has no clamp.
    "text" ["ours", "printed"], |text| {
        let clamped = format!("law.cohesionless={}", text != "printed");
        vec!["machine.engine=programs".to_owned(), format!("machine.text={text}"), clamped]
    };
    "execution" [], |execution| {
        vec!["machine.engine=programs".to_owned(), format!("machine.execution={execution}")]
    };
    "instruction-set" [], |set| vec![format!("machine.instruction_set={set}")];
    "frictionless" [], |_| vec!["law.friction=0".to_owned()];
    "cell-edge" [], |edge| vec![format!("search.cell_edge={edge}")];
};
