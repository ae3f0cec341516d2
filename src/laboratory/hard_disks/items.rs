//! What can be reproduced of this method: each item a study and its section of the report.

use super::sections;
use super::study::soft_hard::{Question, soft_hard};
use super::study::{atmosphere, collapse, cooling, fluid, masks, precision, rates, structure};
use super::verbs::question;
use crate::console::Failure;
use crate::results::{Effort, Item, Made, Progress};

macro_rules! items {
    ($($name:literal, $seconds:expr, $is_quick:literal, $make:ident, $doc:literal;)*) => {
        &[$(Item { name: $name, doc: $doc, seconds: $seconds, is_quick: $is_quick, make: $make }),*]
    };
}

/// Every item, in the order of the page: name, seconds that it takes about (quick and in full), whether it is made
/// where only little time is given (what is the same everywhere is made in full or not at all), and what makes it.
pub(super) const ITEMS: &[Item] = items! {
    "hard-disks-fluid", [30.0, 30.0], false, pressure, "Hard discs: pressure and collision rate of the fluid";
    "hard-disks-structure", [20.0, 20.0], false, melting, "Hard discs: order, free times and speeds on both sides of melting";
    "hard-disks-rates", [4.0, 18.0], true, speed, "Hard discs: collisions a second, the fast engine and the source's";
    "hard-disks-masks", [3.0, 20.0], true, comparison, "Hard discs: cost over mask and density, and the source's formula";
    "hard-disks-cooling", [6.0, 6.0], false, haff, "Hard discs: Haff's law, and inelastic collapse";
    "hard-disks-collapse", [24.0, 24.0], false, collapses, "Hard discs: inelastic collapse over restitution and number of discs";
    "hard-disks-precision", [63.0, 63.0], false, error, "Hard discs: error of Z against processor time";
    "hard-disks-atmosphere", [14.0, 14.0], false, open_system, "Hard discs above a hot floor, without a ceiling";
    "soft-hard", [2.0, 12.0], true, limit, "Soft discs of growing stiffness against hard ones";
};

fn pressure(_: Effort, progress: Progress<'_>) -> Result<Made, Failure> {
    let data = fluid::fluids(&fluid::Effort { discs: 10_000, collisions: 10_000_000 }, progress)?;
    Made::new(sections::fluid::section(&data), &data)
}

fn melting(_: Effort, progress: Progress<'_>) -> Result<Made, Failure> {
    let data = structure::structures(4096, progress)?;
    Made::new(sections::structure::section(&data), &data)
}

fn speed(effort: Effort, progress: Progress<'_>) -> Result<Made, Failure> {
    let packing_fractions = vec![0.10, 0.30, 0.50, 0.65, 0.70];
    let effort = match effort {
        Effort::Quick => {
            rates::Effort { discs: vec![2500], packing_fractions, rounds: 1, collisions: 50_000 }
        }
        Effort::Full => {
            rates::Effort { discs: vec![2500, 250_000], packing_fractions, rounds: 3, collisions: 100_000 }
        }
    };
    let data = rates::rates(&effort, progress)?;
    Made::new(sections::rates::section(&data), &data)
}

fn comparison(effort: Effort, progress: Progress<'_>) -> Result<Made, Failure> {
    let (densities, turns): (&[f64], _) = match effort {
        Effort::Quick => (&[0.10, 0.50], (1, 3000)),
        Effort::Full => (&[0.02, 0.10, 0.30, 0.50, 0.70], (3, 10_000)),
    };
    let data = masks::masks(2500, densities, turns, progress)?;
    Made::new(sections::masks::section(&data), &data)
}

fn haff(_: Effort, progress: Progress<'_>) -> Result<Made, Failure> {
    let data = cooling::cooling(10_000, 12.0, progress)?;
    Made::new(sections::cooling::section(&data), &data)
}

fn collapses(_: Effort, progress: Progress<'_>) -> Result<Made, Failure> {
    let data = collapse::collapses(progress)?;
    Made::new(sections::collapse::section(&data), &data)
}

fn error(_: Effort, progress: Progress<'_>) -> Result<Made, Failure> {
    let effort = precision::Effort { discs: vec![100, 1000, 10_000], collisions: 1_000_000 };
    let data = precision::precision(&effort, progress)?;
    Made::new(sections::precision::section(&data), &data)
}

fn open_system(_: Effort, progress: Progress<'_>) -> Result<Made, Failure> {
    let data = atmosphere::atmosphere(600, progress)?;
    Made::new(sections::atmosphere::section(&data), &data)
}

fn limit(effort: Effort, progress: Progress<'_>) -> Result<Made, Failure> {
    let question = match effort {
        Effort::Quick => {
            Question { discs: 200, stiffnesses: vec![1e3, 1e4, 1e5], seeds: 2, time: 4.0, ..question() }
        }
        Effort::Full => question(),
    };
    let data = soft_hard(&question, progress)?;
    Made::new(sections::soft_hard::section(&data, "stripmine reproduce --only soft-hard".into()), &data)
}
