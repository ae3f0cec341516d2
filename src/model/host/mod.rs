//! Today's hosts, in one line for every execution: `t = start-ups + operations × time + bytes × time of their level`. Operations are
//! charged alike, but for those through an index vector; bytes by how much the program goes over before it visits them again. Work
//! whose amount depends on the data is charged by units of it.

mod costs;
mod file;
mod model;
mod out_of_range;
mod rates;

pub use costs::LaneCosts;
pub(crate) use costs::{Around, Costs, charges};
pub(crate) use file::FORMAT;
pub use file::default_model;
pub use model::HostModel;
pub(crate) use model::Measured;
pub(crate) use out_of_range::OutOfRange;
pub(crate) use rates::{Amounts, MAKING, Rates, Units};
