//! Items of this method: each a study, with its page in the folder `pages`.

use super::sections;
use super::study::{accuracy, diffusion, losses, sectors};
use crate::console::Failure;
use crate::laboratory::programs;
use crate::laboratory::running::prepared;
use crate::report::Chapter::Sources;
use crate::results::{Item, Lab, Made, Size};
use stripmine_physics::method::langevin::keys::LAW;
use stripmine_physics::method::langevin::options::PairLaw;
use stripmine_physics::scene::Overrides;

/// Every item, in the order of its chapter.
pub(super) const ITEMS: &[Item] = &[
    Item::of("langevin-losses", losses::made),
    Item::quick(
        "langevin-sectors",
        Sources,
        [3.0, 41.0],
        cost,
        "Langevin: wall time over the number of sectors, and where it goes",
    ),
    Item::of("langevin-diffusion", diffusion::made),
    Item::of("langevin-accuracy", accuracy::made),
    Item::of("langevin-programs", counted),
];

fn cost(lab: &Lab<'_>, effort: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    let effort = match effort {
        Size::Quick => sectors::Effort { fewest: 100, seconds: 0.05, rounds: 1 },
        Size::Full | Size::All => sectors::Effort { fewest: 3, seconds: 0.06, rounds: 3 },
    };
    let data = sectors::sectors(&effort, progress)?;
    Made::new(sections::sectors::section(&data), &data)
}

fn counted(_: &Lab<'_>, _: Size) -> Result<Made, Failure> {
    let scene = |overrides: &[String]| prepared("langevin-dense", overrides);
    let repulsive = Overrides::new().set(&LAW, PairLaw::Wca);
    programs::made(&[
        ("langevin-dense, WCA", scene(&repulsive)?),
        ("langevin-dense, cut off at 2.5", scene(&[])?),
    ])
}
