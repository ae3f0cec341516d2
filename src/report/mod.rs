//! Reports: finished data as tables, figures and pages. Each export is one small file; none of them runs physics.

pub mod csv;
pub mod figure;
pub mod html;
pub mod markdown;
pub mod page;
pub mod section;
pub mod table;
pub mod terminal;

pub use section::{Part, Section, Verdict};
pub use table::{Cell, Rows, Table};
