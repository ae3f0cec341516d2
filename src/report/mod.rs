//! Reports: finished data as tables. Each export is one small file; none of them runs physics.

pub mod csv;
pub mod efficiency_table;
pub mod markdown;
pub mod origin;
pub mod page;
pub mod table;
pub mod terminal;

pub use table::{Cell, Table};
