//! Items of N-body dynamics: each is a study with a page in the folder `pages`.

use super::study::{collapse, energy, force, rates};
use crate::console::CommandFailure;
use crate::laboratory::programs;
use crate::laboratory::running::prepare_preset;
use crate::results::{FinishedItem, Item, StudyEnvironment, StudySize};
use stripmine_physics::method::nbody::keys::COUNT;
use stripmine_physics::scene::Overrides;

/// Every item, in the order of its chapter.
pub(super) const ITEMS: &[Item] = &[
    Item::of("nbody-energy", energy::reproduce),
    Item::of("nbody-force", force::reproduce),
    Item::of("nbody-rates", rates::reproduce),
    Item::of("nbody-collapse", collapse::reproduce),
    Item::of("nbody-programs", reproduce_programs),
];

fn reproduce_programs(_: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let scene = |count: u64| prepare_preset("plummer", &Overrides::new().set(&COUNT, count));
    programs::programs_item(&[("plummer, N = 1024", scene(1024)?), ("plummer, N = 16", scene(16)?)])
}
