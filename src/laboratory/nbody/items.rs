//! Items of N-body dynamics: each is a study with a page in the folder `pages`.

use super::study::{collapse, energy, rates};
use crate::console::CommandFailure;
use crate::laboratory::programs;
use crate::laboratory::running::prepared;
use crate::results::{FinishedItem, Item, StudyEnvironment, StudySize};
use stripmine_physics::method::nbody::keys::COUNT;
use stripmine_physics::scene::Overrides;

/// Every item, in the order of its chapter.
pub(super) const ITEMS: &[Item] = &[
    Item::of("nbody-energy", energy::made),
    Item::of("nbody-rates", rates::made),
    Item::of("nbody-collapse", collapse::made),
    Item::of("nbody-programs", counted),
];

fn counted(_: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let scene = |count: u64| prepared("plummer", &Overrides::new().set(&COUNT, count));
    programs::made(&[("plummer, N = 1024", scene(1024)?), ("plummer, N = 16", scene(16)?)])
}
