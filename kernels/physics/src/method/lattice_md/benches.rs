//! What is measured of granular discs.

use super::document::Document;
use super::quantities::QUANTITIES;
use crate::method::entry::bench_options;
use crate::method::{Bench, BenchOption, Until};
use crate::words::Words;

impl Document {
    /// What measures its way of finding contacts.
    pub fn bench(&self) -> &'static Bench {
        let by = self.scene.search.by.word();
        BENCHES.iter().find(|bench| bench.name == by).unwrap_or(&BENCHES[0])
    }
}

/// One for each way of finding contacts, by its name.
pub(super) const BENCHES: &[Bench] = &[
    Bench { name: "lattice", doc: "BP93's lattice method", overrides: &["search.by=lattice"], ..GRANULAR },
    Bench {
        name: "neighbor-list",
        doc: "Neighbour lists: the source's rival of it",
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

/// The granular benchmark, whatever finds the contacts.
const GRANULAR: Bench = Bench {
    name: "",
    doc: "",
    preset: "bench",
    rate: "particle_steps_per_second",
    until: Until::Steps,
    // About 10⁷ particle-steps a second, to the order of magnitude.
    amount: |particles| (10_000_000 / particles.max(1)).clamp(20, 20_000),
    defaults: &[("particles", "10000"), ("packing-fraction", "0.84"), ("integrator", "gear5")],
    options: OPTIONS,
    overrides: &[],
    quantities: QUANTITIES,
    compared: &["temperature"],
    at_end: &["contacts"],
};

/// The options of `bench`.
const OPTIONS: &[BenchOption] = bench_options! {
    "particles" Count [], |count| vec![format!("particles.count={count}")], "Number of particles, at least";
    "packing-fraction" Number [], |fraction| vec![format!("particles.packing_fraction={fraction}")], "Area of the discs over that of the box";
    "precision" Word [], |precision| vec![format!("machine.precision={precision}")], "Precision of state and forces: f64, f32 or mixed";
    "integrator" Word ["gear4", "gear5", "gear6", "velocity-verlet"], |name| match name.strip_prefix("gear") {
        Some(values) => vec![format!("integrator.values={values}")],
        None => vec![format!("integrator.kind={name}")],
    }, "Integrator, such as gear4, gear5, gear6, velocity-verlet, baoab or stochastic";
    "engine" Word ["auto", "fast", "programs"], |engine| vec![format!("machine.engine={engine}")], "What moves the particles: auto, fast, or programs of lattice MD, reference of hard discs; the fastest by default";
    // The source has no clamp.
    "text" Word ["ours", "printed"], |text| {
        let clamped = format!("law.cohesionless={}", text != "printed");
        vec!["machine.engine=programs".to_owned(), format!("machine.text={text}"), clamped]
    }, "Whose programs: ours, or printed for the source's own; implies programs";
    "execution" Word [], |execution| {
        vec!["machine.engine=programs".to_owned(), format!("machine.execution={execution}")]
    }, "How programs are executed: eager, strip:N or chained; implies programs";
    "instruction-set" Word [], |set| vec![format!("machine.instruction_set={set}")], "scalar, avx2, avx512, wide, or auto for the widest there is";
    "frictionless" Nothing [], |_| vec!["law.friction=0".to_owned()], "Leave out friction, and with it rotation";
    "cell-edge" Number [], |edge| vec![format!("search.cell_edge={edge}")], "Side of a lattice cell; the largest that the geometry allows by default";
};
