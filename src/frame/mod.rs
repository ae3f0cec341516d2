//! Results as tables with typed columns. Files for programs, tables and charts of a page, and the values of claims all come from a
//! [`Frame`].

mod columns;
mod convert;
pub(crate) mod csv;
mod expression;
mod names;
mod rows;
mod table;

pub(crate) use columns::Role;
pub use columns::{Column, Digits, Frame, Value};
pub use expression::{Expressions, Scope};
pub use rows::Rows;
pub use table::Cell;
pub(crate) use table::Table;
