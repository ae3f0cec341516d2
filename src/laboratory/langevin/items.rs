//! Items of Langevin dynamics: each is a study with a page in the folder `pages`.

use super::study::{accuracy, diffusion, losses, sectors};
use crate::console::CommandFailure;
use crate::laboratory::programs;
use crate::laboratory::running::prepare_preset;
use crate::results::{FinishedItem, Item, StudyEnvironment, StudySize};
use stripmine_physics::method::langevin::laws::{LAW, PairLaw};
use stripmine_physics::scene::Overrides;

/// Every item, in the order of its chapter.
pub(super) const ITEMS: &[Item] = &[
    Item::of("langevin-losses", losses::reproduce),
    Item::of("langevin-sectors", sectors::reproduce),
    Item::of("langevin-diffusion", diffusion::reproduce),
    Item::of("langevin-accuracy", accuracy::reproduce),
    Item::of("langevin-programs", reproduce_programs),
];

fn reproduce_programs(_: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let scene = |overrides: &Overrides| prepare_preset("langevin-dense", overrides);
    let repulsive = Overrides::new().set(&LAW, PairLaw::Wca);
    programs::programs_item(&[
        ("langevin-dense, WCA", scene(&repulsive)?),
        ("langevin-dense, cut off at 2.5", scene(&Overrides::new())?),
    ])
}
