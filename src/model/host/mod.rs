//! Today's hosts: what a pass of the interpreter takes, `t = t0 + n (tau + e0 + sum of e_level)`, with the level of each
//! operand found by reuse distance on the passes that are executed; what compiled loops take, by their classes of operations; and what
//! a unit of the work takes whose amount depends on the data.

mod cost;
mod file;
mod lane;
mod levels;
mod loops;
mod model;
mod rates;
mod reuse;

pub use cost::{Estimate, OutOfRange, PassCost};
pub use file::{BadEntry, FORMAT, HostFileError, default_model};
pub use lane::{Change, LaneCosts};
pub use levels::{Level, Surroundings, Transfer, Wait, beyond, from_afar};
pub use loops::{LoopCosts, class_counts, overlapped};
pub use model::{HostModel, Measured};
pub use rates::{Amounts, MAKING, PhaseRate, Rates};
pub use reuse::{LINE, Since, Touch, Vector, element_bytes, touched_arrays, touches};
