//! Items of hard discs: each is a study with a page in the folder `pages`.

use super::study::{
    atmosphere, collapse, complexity, cooling, fluid, masks, precision, rates, soft_hard, structure,
};
use crate::results::Item;

/// Every item, in the order of its chapter.
pub(super) const ITEMS: &[Item] = &[
    Item::of("hard-disks-fluid", fluid::made),
    Item::of("hard-disks-structure", structure::made),
    Item::of("hard-disks-rates", rates::made),
    Item::of("hard-disks-masks", masks::made),
    Item::of("hard-disks-complexity", complexity::made),
    Item::of("hard-disks-cooling", cooling::made),
    Item::of("hard-disks-collapse", collapse::made),
    Item::of("hard-disks-precision", precision::made),
    Item::of("hard-disks-atmosphere", atmosphere::made),
    Item::of("soft-hard", soft_hard::made),
];
