//! Items of Langevin dynamics: each is a study with a page in the folder `pages`.

use super::study::{accuracy, diffusion, losses, sectors};
use crate::console::CommandFailure;
use crate::laboratory::programs;
use crate::laboratory::running::prepared;
use crate::results::{FinishedItem, Item, StudyEnvironment, StudySize};
use stripmine_physics::method::langevin::laws::{LAW, PairLaw};
use stripmine_physics::scene::Overrides;

/// Every item, in the order of its chapter.
pub(super) const ITEMS: &[Item] = &[
    Item::of("langevin-losses", losses::made),
    Item::of("langevin-sectors", sectors::made),
    Item::of("langevin-diffusion", diffusion::made),
    Item::of("langevin-accuracy", accuracy::made),
    Item::of("langevin-programs", counted),
];

fn counted(_: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let scene = |overrides: &Overrides| prepared("langevin-dense", overrides);
    let repulsive = Overrides::new().set(&LAW, PairLaw::Wca);
    programs::made(&[
        ("langevin-dense, WCA", scene(&repulsive)?),
        ("langevin-dense, cut off at 2.5", scene(&Overrides::new())?),
    ])
}
