//! Extended XYZ: one text frame after the other, as OVITO, ASE and MDAnalysis read it.
//!
//! A frame is the number of discs, a comment line of `key=value`, and a row for each disc:
//!
//! ```text
//! 1
//! Lattice="9.0 0.0 0.0 0.0 8.0 0.0 0.0 0.0 1.0" Origin="0.0 0.0 -0.5" pbc="T F F" Properties=… Time=0.5 step=9
//! Si 0.5 0.5 0.0 1 0.0 -0.1 0.0 0.5 2.0 0.0 0.0 0.25 2.0 0.0 -0.2 0.0
//! ```
//!
//! Species `W` is a wall disc, `Si` or any other name a grain. z is 0; the angular velocity stands in the z component of `omega`.
//! The angle of a disc is not in the format.
//!
//! Frames of other programs may leave out species, ids (rows are then numbered from 1) and `omega` (0), have vectors of the plane
//! (`pos:R:2`, `velo:R:2`, `omega:R:1`), and momenta with masses for velocities. Ids that begin at 0 are each raised by one.

mod error;
mod format;
mod header;
mod reader;
mod real;
mod rows;
mod writer;

pub use error::{Mistake, ReadError, Reason};
pub use format::Format;
pub use reader::{Frames, Which, read};
pub(crate) use writer::FORMAT;
pub use writer::write;

use crate::particles::Particles;

/// The columns of a frame that are read again.
pub(crate) const PROPERTIES: &str = "species:S:1:pos:R:3:id:I:1:velo:R:3:radius:R:1:mass:R:1:omega:R:3";

/// The columns behind them: what ASE knows of masses and velocities, which it has from momenta. OVITO knows `mass` and `velo`.
pub(crate) const OF_ASE: &str = "masses:R:1:momenta:R:3";

/// Extent of the box in z (length), of no meaning in the plane: from −1/2 to 1/2, as LAMMPS wants it for two
/// dimensions.
pub(super) const DEPTH: [f64; 2] = [-0.5, 0.5];

/// What a frame may be of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Room {
    /// Discs in the plane, in a box: what scenes start from.
    Plane,
    /// Whatever runs write: bodies in space too, and frames without a box, whose sides are then infinite.
    Space,
}

/// Discs in their box at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// The discs.
    pub particles: Particles,
    /// Sides of the box (length).
    pub cell: [f64; 2],
    /// Lower left corner of the box (length).
    pub origin: [f64; 2],
    /// Along which axes the box repeats, where the frame says so; others take it for repeating along all.
    pub periodic: Option<[bool; 2]>,
    /// Time (time).
    pub time: f64,
    /// Steps done.
    pub step: u64,
    /// Seed of the random numbers that made the scene.
    pub seed: Option<u64>,
    /// Ids of the file begin at 0, and each was raised by one.
    pub has_raised_ids: bool,
}
