//! Items of this method: each a study, with its page in the folder `pages`.

use super::sections;
use super::study::{collapse, energy, rates};
use crate::console::Failure;
use crate::laboratory::programs;
use crate::laboratory::running::prepared;
use crate::report::Chapter::Host;
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
    Item::of("nbody-collapse", collapse::made),
    Item::of("nbody-programs", counted),
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

fn counted(_: &Lab<'_>, _: Size) -> Result<Made, Failure> {
    let scene = |count: u64| prepared("plummer", &Overrides::new().set(&COUNT, count));
    programs::made(&[("plummer, N = 1024", scene(1024)?), ("plummer, N = 16", scene(16)?)])
}
