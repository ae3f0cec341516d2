//! What the studies say, as items of the report.

pub mod collapse;
pub mod rates;
