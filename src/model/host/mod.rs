//! Today's hosts, in one line for every execution: `t = start-up + operations × time + bytes × time of their level`. Passes of the
//! interpreter are charged by their operation, compiled loops by the classes of theirs, bytes by how much the program goes over
//! before it meets them again; and work whose amount depends on the data by units of it.

mod file;
mod lane;
mod levels;
mod model;
mod rates;

pub use file::{BadEntry, FORMAT, HostFileError, default_model};
pub use lane::{LaneCosts, class_counts};
pub use levels::{Around, Level};
pub use model::{HostModel, Measured, OutOfRange};
pub use rates::{Amounts, MAKING, PhaseRate, Rates};
