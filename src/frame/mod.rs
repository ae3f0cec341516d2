//! Results as tables with typed columns. Data files, tables and charts of a page, and the values of claims are all made from a
//! [`ResultFrame`].

mod columns;
mod convert;
pub(crate) mod csv;
mod expression;
mod names;
mod rows;
mod table;

pub(crate) use columns::Role;
pub use columns::{Digits, FrameColumn, FrameValue, ResultFrame};
pub use expression::{ExpressionScope, Expressions};
pub use rows::FrameBuilder;
pub(crate) use table::FormattedTable;
pub use table::TableCell;
