//! What can be reproduced of this method: each item a study and its section of the report.

use super::sections;
use super::study::calibration::this_host;
use super::study::model_validation::{self, Calibrated};
use super::study::rounds::Bound;
use super::study::{
    break_even, corrector, crossover, damping, density_cost, efficiency_table, identity, ladder, listing,
    mask, measured_cost, misprints, pipe_flow, precision, printed_cost, threads, useful_work,
};
use crate::console::Failure;
use crate::model::machines;
use crate::report::Chapter::{Host, Sources};
use crate::report::Section;
use crate::results::{Item, Lab, Made, Size};
use serde::Serialize;
use std::time::Duration;

/// Every item, in the order of its chapter.
pub(super) const ITEMS: &[Item] = &[
    Item::of("table", efficiency_table::made),
    Item::of("ladder", ladder::made),
    Item::of("listing", listing::made),
    Item::of("mask", mask::made),
    Item::of("misprints", misprints::made),
    Item::of("corrector", corrector::made),
    Item::of("cost", density_cost::made),
    Item::of("useful-work", useful_work::made),
    Item::quick(
        "printed",
        Sources,
        [6.0, 45.0],
        printed,
        "The printed text run the CRAY's way: NOP·(n + D) against wall time, and what thirty years made of it",
    )
    .with_memory(900),
    Item::quick("measured", Host, [8.0, 21.0], measured, "The same, measured on this host"),
    Item::of("validation", model_validation::made),
    Item::full(
        "atlas",
        Host,
        36.0,
        atlas,
        "Who wins where: occupancy, number of particles, method and machine",
    ),
    Item::quick(
        "crossover",
        Host,
        [4.0, 34.0],
        crossover,
        "Lattice, neighbour lists and sectors: which is the fastest at which density, on this host",
    ),
    Item::quick(
        "threads",
        Host,
        [3.0, 16.0],
        threads,
        "What more threads give, and what the machine has to give",
    ),
    Item::of("identity", identity::made),
    Item::of("precision", precision::made),
    Item::of("pipe-small", pipe_flow::short),
    Item::of("pipe", pipe_flow::whole),
    Item::of("pipe-thin", pipe_flow::thin),
    Item::of("waves", damping::made),
];

fn printed(lab: &Lab<'_>, effort: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    // Short vectors for the line, up to the first cache; long ones for where it breaks.
    let short = [25, 49, 100, 170, 290, 500, 1000, 10_000, 100_000];
    let long = [2000, 5000, 30_000, 300_000, 1_000_000, 3_000_000];
    let effort = match effort {
        Size::Quick => printed_cost::Effort {
            cells: short.to_vec(),
            occupancies: vec![1.0],
            samples: 8,
            particles: 1000,
            rounds: Bound::of(3),
        },
        Size::Full | Size::All => printed_cost::Effort {
            cells: [&short[..], &long].concat(),
            occupancies: vec![0.05, 0.1, 0.5, 1.0],
            samples: 24,
            particles: 10_000,
            rounds: bound(15, 20),
        },
    };
    let data = printed_cost::printed_cost(&effort, progress)?;
    made(sections::printed_cost::section(&data), &data)
}

fn measured(lab: &Lab<'_>, effort: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    let data = measured_cost::measured_cost(&measured_effort(effort), progress)?;
    made(sections::measured_cost::section(&data), &data)
}

fn crossover(lab: &Lab<'_>, effort: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    let data = crossover::crossover(&crossover_effort(effort), progress)?;
    made(sections::crossover::section(&data), &data)
}

fn threads(lab: &Lab<'_>, effort: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let data = threads::threads(cores, &threads_effort(effort), progress)?;
    made(sections::threads::section(&data), &data)
}

fn made(section: Section, data: &impl Serialize) -> Result<Made, Failure> {
    Made::new(section, data)
}

/// Seconds that rounds of the atlas may take in full: scenes are laid out before.
const ATLAS: u64 = 12;

fn bound(most: usize, seconds: u64) -> Bound {
    Bound { most, within: Some(Duration::from_secs(seconds)) }
}

/// The machine of the source, the CRAY of the application, and this host, beside what is measured here.
fn atlas(lab: &Lab<'_>, effort: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    let machines = [machines::preset("paper")?, machines::preset("cray-y-mp-el")?];
    let host = this_host(&|_| {})?;
    let (measured, rounds): (&[usize], Bound) = match effort {
        Size::Quick => (&[300], Bound::of(2)),
        Size::Full | Size::All => (&[100, 300, 1000, 3000, 10_000], bound(6, ATLAS)),
    };
    let data = break_even::atlas(&machines, (host, Calibrated::Now), measured, rounds, progress)?;
    made(sections::break_even::section(&data, "stripmine reproduce --only atlas"), &data)
}

fn measured_effort(effort: Size) -> measured_cost::Effort {
    match effort {
        Size::Quick => measured_cost::Effort {
            particles: vec![100, 1000],
            occupancies: vec![0.1, 0.2],
            equilibration: 50,
            element_steps: 200_000,
            repeats: 3,
        },
        Size::Full | Size::All => measured_cost::Effort {
            particles: vec![100, 300, 1000, 3000, 10_000],
            occupancies: vec![0.01, 0.03, 0.1, 0.2, 0.25],
            equilibration: 100,
            element_steps: 400_000,
            repeats: 5,
        },
    }
}

fn crossover_effort(effort: Size) -> crossover::Effort {
    match effort {
        Size::Quick => crossover::Effort {
            precisions: vec!["f64"],
            particles: vec![4000],
            packing_fractions: vec![0.84, 0.3, 0.1],
            steps: 60,
            repeats: 2,
        },
        Size::Full | Size::All => crossover::Effort {
            precisions: vec!["f64", "mixed", "f32"],
            particles: vec![10_000, 100_000],
            packing_fractions: vec![0.84, 0.8, 0.6, 0.3, 0.1, 0.03],
            steps: 40,
            repeats: 2,
        },
    }
}

fn threads_effort(effort: Size) -> threads::Effort {
    match effort {
        Size::Quick => threads::Effort {
            particles: vec![20_000],
            packing_fractions: vec![0.84],
            rounds: 3,
            particle_steps: 1_000_000,
        },
        Size::Full | Size::All => threads::Effort {
            particles: vec![10_000, 100_000, 300_000],
            packing_fractions: vec![0.84, 0.3],
            rounds: 5,
            particle_steps: 4_000_000,
        },
    }
}
