//! Timing model of today's hosts, for every execution: `t = start-ups + operations × time + bytes × time of their level`. All operations cost
//! the same, except those through an index vector. The price of a byte depends on the footprint between two visits. Work
//! whose amount depends on the data is charged per unit.

mod costs;
mod file;
mod model;
mod out_of_range;
mod rates;

pub use costs::LaneCosts;
pub(crate) use costs::{ExecutionPrices, StepArrays, charges};
pub(crate) use file::FORMAT;
pub use file::default_model;
pub use model::HostModel;
pub(crate) use model::MeasurementConditions;
pub(crate) use out_of_range::OutOfRange;
pub(crate) use rates::{AmountUnits, Amounts, MAKING, PhaseRates};
