//! Laboratory of Langevin dynamics (LAN17): particles in a heat bath.

mod items;
mod study;

use super::Laboratory;
use items::ITEMS;

/// Items, verbs and charts.
pub(super) static LABORATORY: Laboratory =
    Laboratory { method: "langevin", items: ITEMS, verbs: &[], charts: &[], works: &study::sectors::WORKS };
