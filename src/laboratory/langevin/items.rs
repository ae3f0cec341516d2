//! What can be reproduced of this method: each item a study and its section of the report.

use super::sections;
use super::study::{accuracy, diffusion, losses, sectors};
use crate::console::Failure;
use crate::laboratory::programs;
use crate::laboratory::running::prepared;
use crate::results::{Effort, Item, Made, Progress};
use stripmine_physics::method::langevin::keys::LAW;
use stripmine_physics::method::langevin::options::PairLaw;
use stripmine_physics::scene::Overrides;

macro_rules! items {
    ($($name:literal, $seconds:expr, $is_quick:literal, $make:ident, $doc:literal;)*) => {
        &[$(Item { name: $name, doc: $doc, seconds: $seconds, is_quick: $is_quick, make: $make }),*]
    };
}

/// Every item, in the order of the page: name, seconds that it takes about (quick and in full), whether it is made
/// where only little time is given (what is the same everywhere is made in full or not at all), and what makes it.
pub(super) const ITEMS: &[Item] = items! {
    "langevin-losses", [20.0, 20.0], false, lost, "Langevin: particles lost over the step";
    "langevin-sectors", [3.0, 30.0], true, cost, "Langevin: wall time over the number of sectors, and where it goes";
    "langevin-diffusion", [13.0, 13.0], false, displaced, "Langevin: mean square displacement, velocities, temperature";
    "langevin-accuracy", [10.0, 58.0], false, errors, "Langevin: the error of the step in a Lennard-Jones fluid";
    "langevin-programs", [1.0, 1.0], true, counted, "Langevin: the law as whole-array operations, counted and charged by clocks";
};

fn lost(_: Effort, progress: Progress<'_>) -> Result<Made, Failure> {
    let data = losses::losses(40_000, progress)?;
    Made::new(sections::losses::section(&data), &data)
}

fn cost(effort: Effort, progress: Progress<'_>) -> Result<Made, Failure> {
    let effort = match effort {
        Effort::Quick => sectors::Effort { fewest: 100, seconds: 0.05, rounds: 1 },
        Effort::Full => sectors::Effort { fewest: 3, seconds: 0.06, rounds: 3 },
    };
    let data = sectors::sectors(&effort, progress)?;
    Made::new(sections::sectors::section(&data), &data)
}

fn displaced(_: Effort, progress: Progress<'_>) -> Result<Made, Failure> {
    let data = diffusion::diffusion(progress)?;
    Made::new(sections::diffusion::section(&data), &data)
}

fn errors(effort: Effort, progress: Progress<'_>) -> Result<Made, Failure> {
    let time = if effort == Effort::Full { 640.0 } else { 80.0 };
    let data = accuracy::accuracy(time, progress)?;
    Made::new(sections::accuracy::section(&data), &data)
}

fn counted(_: Effort, progress: Progress<'_>) -> Result<Made, Failure> {
    let repulsive = Overrides::new().set(&LAW, PairLaw::Wca);
    let scenes = [
        ("langevin-dense, WCA", prepared("langevin-dense", &repulsive)?),
        ("langevin-dense, cut off at 2.5", prepared("langevin-dense", &[])?),
    ];
    progress(1.0);
    programs::made(
        ("langevin-programs", "Langevin: the pair law on the vector machine"),
        (
            "What does the law of the pairs cost on the vector machine of BP93?",
            "The source runs on sectors. On the lattice of BP93 its law is whole-array operations at every place of a mask: 24 for the \
         repulsion, 120 up to 2.5 diameters.",
        ),
        &scenes,
    )
}
