//! Laboratory of lattice MD (BP93): granular discs.

mod items;
mod study;
mod verbs;

use super::Laboratory;
use items::ITEMS;
use study::printed;
use verbs::{CHARTS, VERBS};

/// Items, verbs and charts.
pub(super) static LABORATORY: Laboratory =
    Laboratory { method: "lattice-md", items: ITEMS, verbs: VERBS, charts: CHARTS, works: &[printed::EAGER] };
