//! Particles in a bath, LAN17: what is measured and shown beside a run.

mod items;
mod study;

use super::Laboratory;
use items::ITEMS;

/// Items, verbs and charts.
pub(super) static LABORATORY: Laboratory =
    Laboratory { method: "langevin", items: ITEMS, verbs: &[], charts: &[], works: &study::sectors::WORKS };
