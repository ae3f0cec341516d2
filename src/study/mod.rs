//! Studies: one file per question a user asks, each a function from parameters to a dataset.

pub mod efficiency_table;
pub mod throughput;
