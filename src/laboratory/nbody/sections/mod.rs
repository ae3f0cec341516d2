//! What the studies say, as items of the report.

pub mod rates;
