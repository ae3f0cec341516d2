//! Extended XYZ: consecutive frames of text, as OVITO, ASE and MDAnalysis read them.
//!
//! A frame is the number of discs, a comment line of `key=value`, and a row for each disc:
//!
//! ```text
//! 1
//! Lattice="9.0 0.0 0.0 0.0 8.0 0.0 0.0 0.0 1.0" Origin="0.0 0.0 -0.5" pbc="T F F" Properties=… Time=0.5 step=9
//! Si 0.5 0.5 0.0 1 0.0 -0.1 0.0 0.5 2.0 0.0 0.0 0.25 2.0 0.0 -0.2 0.0
//! ```
//!
//! Species `W` is a wall disc, `Si` or any other name a grain. z is 0, and the angular velocity is the z component of `omega`. The format has no
//! angle of a disc.
//!
//! Frames of other programs may omit species, ids (rows are then numbered from 1) and `omega` (0). They may have planar vectors (`pos:R:2`,
//! `velo:R:2`, `omega:R:1`), and momenta with masses instead of velocities. Ids that begin at 0 are raised by one.

mod error;
mod format;
mod header;
mod reader;
mod rows;
mod writer;

pub use error::{Mistake, XyzMistakeKind, XyzReadError};
pub use format::ForeignFormat;
pub use reader::{FrameChoice, XyzFrames, read};
pub(crate) use reader::{ParsedFrame, read_start};
pub(crate) use rows::FrameColumns;
pub(crate) use writer::FORMAT;
pub use writer::write;

use crate::particles::Particles;

/// Columns of a frame that are read back.
pub(crate) const PROPERTIES: &str = "species:S:1:pos:R:3:id:I:1:velo:R:3:radius:R:1:mass:R:1:omega:R:3";

/// Further columns: masses and momenta, from which ASE derives velocities. OVITO reads `mass` and `velo`.
pub(crate) const OF_ASE: &str = "masses:R:1:momenta:R:3";

/// Extent of the box in z (length), without meaning in the plane: from −1/2 to 1/2, as LAMMPS requires for two dimensions.
pub(super) const DEPTH: [f64; 2] = [-0.5, 0.5];

/// Contents allowed in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FrameContents {
    /// Planar discs in a box, as scenes start from.
    Plane,
    /// Everything that runs write: also bodies in space, and frames without a box, whose sides are infinite.
    Space,
    /// Start of a scene of another program: box, velocities, radii and masses may be missing, and so may the keys of the comment line.
    Start {
        /// True if particles must be in one plane z = const.
        is_planar: bool,
    },
}

impl FrameContents {
    /// True if other keys of the scene supply what a frame lacks.
    fn may_lack(self) -> bool {
        matches!(self, FrameContents::Start { .. })
    }

    /// True if velocities have no third component.
    fn is_planar(self) -> bool {
        matches!(self, FrameContents::Plane | FrameContents::Start { is_planar: true })
    }
}

/// Discs in their box at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct ParticleFrame {
    /// Discs of the frame.
    pub particles: Particles,
    /// Sides of the box (length).
    pub cell: [f64; 2],
    /// Lower left corner of the box (length).
    pub origin: [f64; 2],
    /// Periodicity along x and y, if the frame states it; other programs assume periodic.
    pub periodic: Option<[bool; 2]>,
    /// Simulated time (time).
    pub time: f64,
    /// Number of steps done.
    pub step: u64,
    /// Seed of the random numbers that made the scene.
    pub seed: Option<u64>,
    /// True if ids of the file begin at 0 and were raised by one.
    pub has_raised_ids: bool,
}
