//! What is observed and what is measured of granular discs.

use super::document::Document;
use crate::method::{Bench, BenchOption, Quantity, Until};
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

macro_rules! options {
    ($($name:literal, $values:expr, $overrides:expr;)*) => {
        &[$(BenchOption { name: $name, values: &$values, overrides: $overrides }),*]
    };
}

/// The options of `bench`: name, values where they are named here, and what a value says in a scene.
const OPTIONS: &[BenchOption] = options! {
    "particles", [], |count| vec![format!("particles.count={count}")];
    "packing-fraction", [], |fraction| vec![format!("particles.packing_fraction={fraction}")];
    "precision", [], |precision| vec![format!("machine.precision={precision}")];
    "integrator", ["gear4", "gear5", "gear6", "velocity-verlet"], |name| match name.strip_prefix("gear") {
        Some(values) => vec![format!("integrator.values={values}")],
        None => vec![format!("integrator.kind={name}")],
    };
    "engine", ["auto", "fast", "programs"], |engine| vec![format!("machine.engine={engine}")];
    "execution", [], |execution| {
        vec!["machine.engine=programs".to_owned(), format!("machine.execution={execution}")]
    };
    "instruction-set", [], |set| vec![format!("machine.instruction_set={set}")];
    "frictionless", [], |_| vec!["law.friction=0".to_owned()];
    "cell-edge", [], |edge| vec![format!("search.cell_edge={edge}")];
};

macro_rules! quantities {
    ($($name:literal, $unit:literal, $doc:literal;)*) => {
        &[$(Quantity { name: $name, unit: $unit, doc: $doc }),*]
    };
}

/// What is observed, in the order of the columns.
pub(super) const QUANTITIES: &[Quantity] = quantities! {
    "time", "time", "The time.";
    "kinetic", "energy", "Kinetic energy of the grains' translation.";
    "rotational", "energy", "Kinetic energy of their rotation.";
    "elastic", "energy", "Energy of the Hertz contacts.";
    "gravitational", "energy", "Potential energy in gravity, from the box's corner; jumps where a grain crosses a periodic side along gravity.";
    "dissipated", "energy", "What contacts have turned into heat since the start.";
    "gravity_work", "energy", "What gravity has put in since the start.";
    "wall_work", "energy", "What moving walls have put in since the start.";
    "balance_error", "energy", "The energy that there is, less what there should be.";
    "momentum_x", "mass·length/time", "Momentum of the grains along x.";
    "momentum_y", "mass·length/time", "Momentum of the grains along y.";
    "temperature", "energy", "Kinetic energy a grain and dimension, about the mean motion: over N, also where momentum is conserved and 2 N − 2 degrees of freedom move; the temperature of these is N/(N − 1) times it.";
    "pressure", "force/length", "Pressure of the grains, of their motion and of the contacts between them, over the area of the whole box.";
    "flow", "length/time", "Mean velocity of the grains along gravity, or along x without gravity.";
    "deepest_penetration", "", "The deepest contact, as a fraction of the sum of the radii.";
    "contacts", "", "Contacts with at least one grain.";
    "deep_disc_steps", "", "Grains in contacts deeper than law.max_penetration, summed over the steps.";
    "long_steps", "", "Discs that moved farther in a step than contacts can be seen, summed over the steps.";
};
