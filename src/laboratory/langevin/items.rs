//! What can be reproduced of this method: each item a study and its section of the report.

use super::sections;
use super::study::{accuracy, diffusion, losses, sectors};
use crate::console::Failure;
use crate::laboratory::programs;
use crate::laboratory::running::prepared;
use crate::report::Chapter::{Beyond, Sources};
use crate::results::{Item, Lab, Made, Size};
use stripmine_physics::method::langevin::keys::LAW;
use stripmine_physics::method::langevin::options::PairLaw;
use stripmine_physics::scene::Overrides;

/// Every item, in the order of its chapter.
pub(super) const ITEMS: &[Item] = &[
    Item::full("langevin-losses", Sources, 20.0, lost, "Langevin: particles lost over the step"),
    Item::quick(
        "langevin-sectors",
        Sources,
        [3.0, 41.0],
        cost,
        "Langevin: wall time over the number of sectors, and where it goes",
    ),
    Item::full(
        "langevin-diffusion",
        Sources,
        13.0,
        displaced,
        "Langevin: mean square displacement, velocities, temperature",
    ),
    Item::full(
        "langevin-accuracy",
        Beyond,
        57.0,
        errors,
        "Langevin: the error of the step in a Lennard-Jones fluid",
    ),
    Item::quick(
        "langevin-programs",
        Beyond,
        [0.1, 0.1],
        counted,
        "Langevin: the law as whole-array operations, counted and charged by clocks",
    ),
];

fn lost(lab: &Lab<'_>, _: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    let data = losses::losses(40_000, progress)?;
    Made::new(sections::losses::section(&data), &data)
}

fn cost(lab: &Lab<'_>, effort: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    let effort = match effort {
        Size::Quick => sectors::Effort { fewest: 100, seconds: 0.05, rounds: 1 },
        Size::Full | Size::All => sectors::Effort { fewest: 3, seconds: 0.06, rounds: 3 },
    };
    let data = sectors::sectors(&effort, progress)?;
    Made::new(sections::sectors::section(&data), &data)
}

fn displaced(lab: &Lab<'_>, _: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    let data = diffusion::diffusion(progress)?;
    Made::new(sections::diffusion::section(&data), &data)
}

fn errors(lab: &Lab<'_>, effort: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    let time = if effort == Size::Quick { 80.0 } else { 640.0 };
    let data = accuracy::accuracy(time, progress)?;
    Made::new(sections::accuracy::section(&data), &data)
}

fn counted(lab: &Lab<'_>, _: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
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
