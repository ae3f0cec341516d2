//! Laboratory of N-body dynamics (PWP): bodies that attract each other.

mod items;
mod study;

use super::Laboratory;
use items::ITEMS;

/// Items, verbs and charts.
pub(super) static LABORATORY: Laboratory =
    Laboratory { method: "nbody", items: ITEMS, verbs: &[], charts: &[], works: &study::rates::WORKS };
