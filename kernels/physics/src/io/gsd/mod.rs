//! Trajectories as GSD, the General Simulation Data format of HOOMD-blue: file layer 2.0, schema `hoomd` 1.4. Each frame is found
//! by its number, without those before it.
//!
//! ```text
//! heading   256 bytes: where the names and the index are
//! names     one after the other, each with a 0 behind it
//! index     32 bytes a chunk: its frame, name, size and place; zeros where there is none yet
//! chunks    rows of numbers, each at a multiple of 8 bytes
//! index     twice as large, where the one before is full: what that one says, and more
//! chunks    …
//! ```
//!
//! What the schema knows is in single precision, positions from the centre of the box. The same in double precision, as the run has
//! it, is below `log/`.
//!
//! The crate `hoomd-gsd` 1.4.0 does not replace the file layer: it cannot cut frames off behind a checkpoint, the place of its index
//! depends on when it is synced (a resumed file has other bytes), it asserts what a damaged index says, and it brings 60 crates.

mod error;
mod file;
mod layout;
mod reader;
mod writer;

pub use error::{Place, ReadError, Reason};
pub use reader::Frames;
pub use writer::{LoggedFrame, Writer};

use super::opened::SinkKind;
use super::output_format::{FrameWriting, OutputFormat};
use super::trajectory::{FrameReading, reader};

pub(crate) const FORMAT: OutputFormat = OutputFormat {
    key: "gsd",
    doc: "Snapshots as trajectory.gsd, with an index: positions and velocities in single and in double precision, and the row of thermo.csv.",
    is_default: false,
    needs_box: false,
    file: "trajectory.gsd",
    writing: FrameWriting::Growing(SinkKind::of::<Writer>()),
    reading: FrameReading::Opens(|path| Ok(reader(Frames::open(path)?))),
};

/// The chunks of a frame; behind them comes a `log/` for each quantity that is logged. Readers expect every `log/` in the first frame.
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
/// Periods moved since the start, where they are followed.
const IMAGE: &str = "particles/image";
const TIME: &str = "log/time";
/// Sides and lower left corner of the box in double precision; sides without end where there is no box.
const SIDES: &str = "log/box/sides";
const CORNER: &str = "log/box/corner";
/// 1 where the box repeats.
const PERIODIC: &str = "log/box/periodic";
const ID: &str = "log/particles/id";
const RADIUS: &str = "log/particles/radius";
const EXACT_MASS: &str = "log/particles/mass";
/// Two coordinates in the plane, three in space.
const EXACT_POSITION: &str = "log/particles/position";
const EXACT_VELOCITY: &str = "log/particles/velocity";
const ANGLE: &str = "log/particles/angle";
const OMEGA: &str = "log/particles/omega";

/// The type of a grain and of a wall disc, by their numbers; as in extended XYZ.
const TYPE_NAMES: [[u8; 3]; 2] = [*b"Si\0", *b"W\0\0"];
