//! Results as tables with typed columns. Data files, tables and charts of a page, and the values of claims are all made from a
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
