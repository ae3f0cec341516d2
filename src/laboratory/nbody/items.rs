//! What can be reproduced of this method: each item a study and its section of the report.

use super::sections;
use super::study::{collapse, energy, rates};
use crate::console::Failure;
use crate::laboratory::programs;
use crate::laboratory::running::prepared;
use crate::report::Chapter::{Beyond, Host};
use crate::results::{Item, Lab, Made, Size};
use stripmine_physics::method::nbody::keys::COUNT;
use stripmine_physics::scene::Overrides;

/// Every item, in the order of its chapter.
pub(super) const ITEMS: &[Item] = &[
    Item::of("nbody-energy", energy::made),
    Item::quick(
        "nbody-rates",
        Host,
        [3.0, 19.0],
        speed,
        "Bodies: interactions a second and how exact forces are",
    ),
    Item::full("nbody-collapse", Beyond, 20.0, fall, "Bodies: a cold sphere collapses, with a film"),
    Item::quick(
        "nbody-programs",
        Beyond,
        [0.1, 0.1],
        counted,
        "Bodies: all pairs by cyclic shifts, counted and charged by clocks",
    ),
];

fn speed(lab: &Lab<'_>, effort: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    let effort = match effort {
        Size::Quick => rates::Effort { bodies: vec![1024], seconds: 0.05, rounds: 1 },
        Size::Full | Size::All => rates::Effort { bodies: vec![1024, 4096, 16_384], seconds: 0.1, rounds: 3 },
    };
    let data = rates::rates(&effort, progress)?;
    Made::new(sections::rates::section(&data), &data)
}

fn fall(lab: &Lab<'_>, _: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    let data = collapse::collapses(progress)?;
    Made::new(sections::collapse::section(&data), &data)
}

fn counted(lab: &Lab<'_>, _: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    let scene = |count: u64| prepared("plummer", &Overrides::new().set(&COUNT, count));
    let scenes = [("plummer, N = 1024", scene(1024)?), ("plummer, N = 16", scene(16)?)];
    progress(1.0);
    programs::made(
        ("nbody-programs", "Bodies: all pairs by cyclic shifts on the vector machine"),
        (
            "What do the forces between all pairs cost as vector operations?",
            "PWP: every body meets the one that is s places behind it, for s = 1 to N − 1: whole-array operations on shifted vectors. 16 shifts \
         make a program.",
        ),
        &scenes,
    )
}
