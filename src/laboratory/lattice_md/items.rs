//! Items of lattice MD: each is a study with a page in the folder `pages`.

use super::study::{
    corrector, damping, density_cost, efficiency_table, identity, ladder, listing, mask, misprints,
    model_validation, other_models, pipe_flow, precision, printed, scaling, searches, unequal, useful_work,
    wave_spectra,
};
use crate::results::Item;

/// Every item, in the order of its chapter.
pub(super) const ITEMS: &[Item] = &[
    Item::of("table", efficiency_table::reproduce),
    Item::of("ladder", ladder::reproduce),
    Item::of("listing", listing::reproduce),
    Item::of("mask", mask::reproduce),
    Item::of("misprints", misprints::reproduce),
    Item::of("corrector", corrector::reproduce),
    Item::of("cost", density_cost::reproduce),
    Item::of("useful-work", useful_work::reproduce),
    Item::of("printed", printed::reproduce),
    Item::of("scaling", scaling::reproduce),
    Item::of("searches", searches::reproduce),
    Item::of("unequal", unequal::reproduce),
    Item::of("validation", model_validation::reproduce),
    Item::of("other-models", other_models::reproduce),
    Item::of("identity", identity::reproduce),
    Item::of("precision", precision::reproduce),
    Item::of("pipe-small", pipe_flow::small_pipe),
    Item::of("pipe", pipe_flow::whole_pipe),
    Item::of("pipe-thin", pipe_flow::thin_pipe),
    Item::of("waves", damping::reproduce),
    Item::of("wave-spectra", wave_spectra::reproduce),
];
