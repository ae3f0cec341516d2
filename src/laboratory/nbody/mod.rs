//! Bodies that attract each other, PWP: what is measured and shown beside a run.

mod items;
mod study;

use super::Laboratory;
use items::ITEMS;

/// Items, verbs and charts.
pub(super) static LABORATORY: Laboratory =
    Laboratory { method: "nbody", items: ITEMS, verbs: &[], charts: &[], works: &study::rates::WORKS };
