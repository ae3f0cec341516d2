//! The timing model: what counted operations cost on a vector machine.
//!
//! A [`machine`] states, with the provenance of every number, how long its units take to fill and what it does about operations it
//! lacks. A clock turns the counts of a run into clock periods on such a machine. The clocks form a ladder over the same counts: the
//! formula of BP93 section 3 is its first vector rung, and every refinement is one rung more, so that a table can show what each of
//! them adds.

pub mod clock;
mod file;
pub mod host;
pub mod machine;
mod machine_file;
pub mod machines;
