//! Lattice MD of granular discs, BP93: what is measured and shown beside a run.
//!
//! Ask what a step costs, by the source's count and by the programs that run:
//!
//! ```
//! use stripmine::laboratory::lattice_md::study::efficiency_table::{Question, efficiency_table};
//! use stripmine::model::machines;
//!
//! let table = efficiency_table(&Question::default(), &machines::preset("paper")?)?;
//! use stripmine_physics::method::lattice_md::Part;
//! let forces = table.source.iter().find(|row| row.part == "forces").expect("a step has forces");
//! assert_eq!(forces.nop, 1656);
//! // The source's own program, and ours.
//! assert!(table.printed.of(Part::Forces) < 1656 && table.ours.of(Part::Forces) < 1656);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod items;
pub mod sections;
pub mod study;
mod verbs;

use super::Laboratory;
use items::ITEMS;
use verbs::{CHARTS, VERBS};

/// Items, verbs and charts.
pub(super) static LABORATORY: Laboratory =
    Laboratory { method: "lattice-md", items: ITEMS, verbs: VERBS, charts: CHARTS, works: &[] };
