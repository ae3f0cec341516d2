//! Today's hosts, in one line for every execution: `t = start-ups + operations × time + bytes × time of their level`. Operations are
//! charged by their class, bytes by how much the program goes over before it meets them again; and work whose amount depends on the
//! data by units of it.

mod file;
mod lane;
mod levels;
mod model;
mod out_of_range;
mod rates;

pub use file::{FORMAT, default_model};
pub use lane::{LaneCosts, class_counts, starts};
pub use levels::{Around, Level};
pub use model::{HostModel, Measured};
pub use out_of_range::OutOfRange;
pub use rates::{Amounts, MAKING, PhaseRate, Rates};
