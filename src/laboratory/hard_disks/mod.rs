//! Laboratory of event-driven hard discs (ISO99).

mod items;
mod study;
mod verbs;

use super::Laboratory;
use items::ITEMS;
use verbs::CHARTS;

/// Items, verbs and charts.
pub(super) static LABORATORY: Laboratory = Laboratory {
    method: "hard-disks",
    items: ITEMS,
    verbs: &[],
    charts: CHARTS,
    works: &study::cells::WORKS,
};
