//! What can be reproduced of this method: each item a study and its section of the report.

use super::sections;
use super::study::{atmosphere, collapse, complexity, cooling, fluid, masks, precision, rates, soft_hard, structure};
use crate::console::Failure;
use crate::report::Chapter::{Host, Sources};
use crate::results::{Item, Lab, Made, Size};

/// Every item, in the order of its chapter.
pub(super) const ITEMS: &[Item] = &[
    Item::of("hard-disks-fluid", fluid::made),
    Item::of("hard-disks-structure", structure::made),
    Item::quick(
        "hard-disks-rates",
        Sources,
        [4.0, 24.0],
        speed,
        "Hard discs: collisions a second, the fast engine and the source's",
    )
    .with_memory(400),
    Item::quick(
        "hard-disks-masks",
        Sources,
        [3.0, 20.0],
        comparison,
        "Hard discs: cost over mask and density, and the source's formula",
    ),
    Item::quick(
        "hard-disks-complexity",
        Sources,
        [2.0, 45.0],
        growth,
        "Hard discs: operations and time of a collision over the number of discs",
    )
    .with_more(450.0)
    .with_memory(500),
    Item::of("hard-disks-cooling", cooling::made),
    Item::of("hard-disks-collapse", collapse::made),
    Item::full("hard-disks-precision", Host, 70.0, error, "Hard discs: error of Z against processor time"),
    Item::of("hard-disks-atmosphere", atmosphere::made),
    Item::of("soft-hard", soft_hard::made),
];

fn speed(lab: &Lab<'_>, effort: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    let packing_fractions = vec![0.10, 0.30, 0.50, 0.65, 0.70];
    let effort = match effort {
        Size::Quick => rates::Effort { discs: vec![2500], packing_fractions, rounds: 1, collisions: 50_000 },
        Size::Full | Size::All => {
            rates::Effort { discs: vec![2500, 250_000], packing_fractions, rounds: 3, collisions: 100_000 }
        }
    };
    let data = rates::rates(&effort, progress)?;
    Made::new(sections::rates::section(&data), &data)
}

fn comparison(lab: &Lab<'_>, effort: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    let (densities, turns): (&[f64], _) = match effort {
        Size::Quick => (&[0.10, 0.50], (1, 3000)),
        Size::Full | Size::All => (&[0.02, 0.10, 0.30, 0.50, 0.70], (3, 10_000)),
    };
    let data = masks::masks(2500, densities, turns, progress)?;
    Made::new(sections::masks::section(&data), &data)
}

fn growth(lab: &Lab<'_>, effort: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    let effort = match effort {
        Size::Quick => complexity::Effort {
            discs: vec![1000, 10_000],
            packing_fractions: vec![0.50],
            rounds: 1,
            collisions: 20_000,
            most_by_reference: 10_000,
        },
        Size::Full => complexity::Effort {
            discs: vec![1000, 10_000, 100_000, 1_000_000],
            packing_fractions: vec![0.30, 0.70],
            rounds: 3,
            collisions: 200_000,
            most_by_reference: 100_000,
        },
        Size::All => complexity::Effort {
            discs: vec![1000, 10_000, 100_000, 1_000_000, 10_000_000],
            packing_fractions: vec![0.30, 0.70],
            rounds: 3,
            collisions: 1_000_000,
            most_by_reference: 1_000_000,
        },
    };
    let data = complexity::complexity(&effort, progress)?;
    Made::new(sections::complexity::section(&data), &data)
}

fn error(lab: &Lab<'_>, _: Size) -> Result<Made, Failure> {
    let progress = lab.progress;
    let effort = precision::Effort { discs: vec![100, 1000, 10_000], collisions: 1_000_000 };
    let data = precision::precision(&effort, progress)?;
    Made::new(sections::precision::section(&data), &data)
}
