//! Items of hard discs: each is a study with a page in the folder `pages`.

use super::study::{
    atmosphere, cells, collapse, complexity, cooling, crossing, errors, fluid, lifetimes, masks, precision,
    pressures, rates, soft_hard, structure, unequal,
};
use crate::results::Item;

/// Every item, in the order of its chapter.
pub(super) const ITEMS: &[Item] = &[
    Item::of("hard-disks-fluid", fluid::reproduce),
    Item::of("hard-disks-structure", structure::reproduce),
    Item::of("hard-disks-rates", rates::reproduce),
    Item::of("hard-disks-masks", masks::reproduce),
    Item::of("hard-disks-cells", cells::reproduce),
    Item::of("hard-disks-lifetimes", lifetimes::reproduce),
    Item::of("hard-disks-crossing", crossing::reproduce),
    Item::of("hard-disks-unequal", unequal::reproduce),
    Item::of("hard-disks-complexity", complexity::reproduce),
    Item::of("hard-disks-cooling", cooling::reproduce),
    Item::of("hard-disks-collapse", collapse::reproduce),
    Item::of("hard-disks-precision", precision::reproduce),
    Item::of("hard-disks-atmosphere", atmosphere::reproduce),
    Item::of("hard-disks-errors", errors::reproduce),
    Item::of("hard-disks-pressures", pressures::reproduce),
    Item::of("soft-hard", soft_hard::reproduce),
];
