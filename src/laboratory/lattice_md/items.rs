//! Items of lattice MD: each is a study with a page in the folder `pages`.

use super::study::{
    corrector, damping, density_cost, efficiency_table, identity, ladder, listing, mask, misprints,
    model_validation, pipe_flow, precision, printed, searches, useful_work,
};
use crate::results::Item;

/// Every item, in the order of its chapter.
pub(super) const ITEMS: &[Item] = &[
    Item::of("table", efficiency_table::made),
    Item::of("ladder", ladder::made),
    Item::of("listing", listing::made),
    Item::of("mask", mask::made),
    Item::of("misprints", misprints::made),
    Item::of("corrector", corrector::made),
    Item::of("cost", density_cost::made),
    Item::of("useful-work", useful_work::made),
    Item::of("printed", printed::made),
    Item::of("searches", searches::made),
    Item::of("validation", model_validation::made),
    Item::of("identity", identity::made),
    Item::of("precision", precision::made),
    Item::of("pipe-small", pipe_flow::short),
    Item::of("pipe", pipe_flow::whole),
    Item::of("pipe-thin", pipe_flow::thin),
    Item::of("waves", damping::made),
];
