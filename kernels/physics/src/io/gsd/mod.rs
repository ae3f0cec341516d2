//! Trajectories as GSD, the General Simulation Data format of HOOMD-blue: file layer 2.0, schema `hoomd` 1.4. Frames can be read in any order.
//!
//! ```text
//! heading   256 bytes: locations of the names and the index
//! names     one after the other, each followed by a 0
//! index     32 bytes a chunk: its frame, name, size and location; zeros for unused entries
//! chunks    rows of numbers, each at a multiple of 8 bytes
//! index     twice as large, once the previous one is full: its entries, and more
//! chunks    …
//! ```
//!
//! Fields of the schema are in single precision, with positions relative to the centre of the box. Their double-precision values are below `log/`.
//!
//! The crate `hoomd-gsd` 1.4.0 cannot replace the file layer. It cannot truncate frames after a checkpoint. The location of its index depends on
//! when it is synced, so a resumed file has other bytes. It asserts what a damaged index states, and it brings 60 crates.

mod error;
mod file;
mod foreign;
mod layout;
mod reader;
mod writer;

pub use error::{GsdErrorKind, GsdLocation, GsdReadError};
pub(crate) use foreign::ForeignFrame;
pub(crate) use layout::SIGNATURE;
pub use reader::GsdFrames;
pub use writer::{GsdWriter, LoggedFrame};

use super::open_sinks::SinkKind;
use super::output_format::{FrameWriting, OutputFormat};
use super::trajectory::{FrameReading, reader};

pub(crate) const FORMAT: OutputFormat = OutputFormat {
    key: "gsd",
    doc: "Snapshots as trajectory.gsd, with an index: positions and velocities in single and in double precision, and the row of thermo.csv.",
    is_default: false,
    needs_box: false,
    file: "trajectory.gsd",
    writing: FrameWriting::Growing(SinkKind::of::<GsdWriter>()),
    reading: FrameReading::Opens(|path| Ok(reader(GsdFrames::open(path)?))),
};

/// Chunks of a frame, before a `log/` for each logged quantity. Readers expect every `log/` in the first frame.
const CHUNKS: [&str; 22] = [
    STEP,
    DIMENSIONS,
    BOX,
    COUNT,
    TYPES,
    TYPE,
    MASS,
    DIAMETER,
    POSITION,
    VELOCITY,
    IMAGE,
    TIME,
    SIDES,
    CORNER,
    PERIODIC,
    ID,
    RADIUS,
    EXACT_MASS,
    EXACT_POSITION,
    EXACT_VELOCITY,
    ANGLE,
    OMEGA,
];

const STEP: &str = "configuration/step";
const DIMENSIONS: &str = "configuration/dimensions";
const BOX: &str = "configuration/box";
const COUNT: &str = "particles/N";
const TYPES: &str = "particles/types";
const TYPE: &str = "particles/typeid";
const MASS: &str = "particles/mass";
const DIAMETER: &str = "particles/diameter";
const POSITION: &str = "particles/position";
const VELOCITY: &str = "particles/velocity";
/// Periods crossed since the start, if they are counted.
const IMAGE: &str = "particles/image";
const TIME: &str = "log/time";
/// Sides and lower left corner of the box in double precision; infinite sides without a box.
const SIDES: &str = "log/box/sides";
const CORNER: &str = "log/box/corner";
/// 1 for periodic sides.
const PERIODIC: &str = "log/box/periodic";
const ID: &str = "log/particles/id";
const RADIUS: &str = "log/particles/radius";
const EXACT_MASS: &str = "log/particles/mass";
/// Two coordinates in the plane, three in space.
const EXACT_POSITION: &str = "log/particles/position";
const EXACT_VELOCITY: &str = "log/particles/velocity";
const ANGLE: &str = "log/particles/angle";
const OMEGA: &str = "log/particles/omega";

/// Type names of grains and wall discs, by type number; as in extended XYZ.
const TYPE_NAMES: [[u8; 3]; 2] = [*b"Si\0", *b"W\0\0"];
