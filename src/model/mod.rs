//! Timing model: cost of counted operations on a vector machine.
//!
//! A [`machine`] states, with the provenance of every number, the start-up of its units and the expansion of operations that it
//! lacks. A clock converts the counts of a run to clock periods on such a machine. The clocks form a ladder over the same counts: the
//! formula of BP93 section 3 is its first vector rung, and every rung above adds one refinement, so a table shows the effect of
//! each.

pub mod clock;
mod file;
pub mod host;
pub mod machine;
mod machine_file;
pub mod machines;
mod sourced;
mod whole_registers;
