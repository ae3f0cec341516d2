//! Start files: particles in the formats of other programs. One file here reads one format; [`START_FORMATS`] lists them, and recognition, messages
//! and documentation follow from the list.
//!
//! A file may lack what keys of the scene supply: velocities, radii, masses, the box. [`StartFrame`] says what it lacks, and the start of the scene
//! fills it in or names the key.

mod gsd;
mod lammps_data;
mod lammps_dump;
mod sph;
mod text;
mod xyz;

use super::extxyz::{ForeignFormat, XyzReadError};
use super::gsd::GsdReadError;
use super::regular_file;
use super::species::kind_and_species;
use crate::particles::{ParticleKind, Particles};
use crate::quoted;
use std::io::Read;
use std::path::{Path, PathBuf};
use text::TextReadError;

/// Format of start files.
pub struct StartFormat {
    /// Name in messages.
    pub name: &'static str,
    /// True if a file that begins with these bytes has the format.
    recognises: fn(&[u8]) -> bool,
    read: fn(&Path, StartRequest) -> Result<StartFrame, StartFileError>,
    /// Names of the columns for velocities, radii and masses.
    columns: [&'static str; 3],
}

/// Formats, in the order in which they are tried.
pub static START_FORMATS: &[&StartFormat] =
    &[&gsd::FORMAT, &lammps_dump::FORMAT, &lammps_data::FORMAT, &sph::FORMAT, &xyz::FORMAT];

/// Names of all formats, for messages.
pub fn start_format_names() -> String {
    let names: Vec<&str> = START_FORMATS.iter().map(|format| format.name).collect();
    match names.split_last() {
        Some((last, rest)) => format!("{} or {last}", rest.join(", ")),
        None => String::new(),
    }
}

/// Frame to read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct StartRequest {
    /// Number of the frame, from 0; the last one if none.
    pub frame: Option<u64>,
    /// True if particles must be in one plane z = const, which becomes z = 0.
    pub is_planar: bool,
}

/// Quantity that a file may lack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StartQuantity {
    /// Velocities.
    Velocity,
    /// Radii.
    Radius,
    /// Masses.
    Mass,
}

impl StartQuantity {
    /// Noun for messages.
    pub(crate) fn noun(self) -> &'static str {
        match self {
            StartQuantity::Velocity => "velocity",
            StartQuantity::Radius => "radius",
            StartQuantity::Mass => "mass",
        }
    }
}

/// Source of a quantity of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum QuantitySource {
    /// The file states it.
    Stated,
    /// The file omits it, and its format defines this value then.
    Default(f64),
    /// The file lacks it.
    Missing,
}

/// Frame of a start file.
#[derive(Clone, Debug, PartialEq)]
pub struct StartFrame {
    /// Particles; numbers that the file lacks are 0.
    pub particles: Particles,
    /// Box, if the file has one.
    pub cell: Option<StartBox>,
    /// Periodicity along x and y, if the file states it.
    pub periodic: Option<[bool; 2]>,
    /// Sources of velocities, radii and masses.
    sources: [QuantitySource; 3],
    /// True if momenta stand for velocities, because the file lacks masses.
    pub has_momenta: bool,
    /// Line that names the columns, if the file has lines.
    pub line: Option<usize>,
    /// Column names of its format.
    columns: [&'static str; 3],
    /// True if ids of the file begin at 0 and were raised by one.
    pub has_raised_ids: bool,
}

/// Box of a start file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StartBox {
    /// Lower left corner (length).
    pub corner: [f64; 2],
    /// Sides (length).
    pub sides: [f64; 2],
    /// True if the corner is a convention of the format, and the scene's own corner applies.
    pub is_movable: bool,
    /// Relative precision of its numbers.
    pub precision: f64,
}

impl StartBox {
    /// Precision of numbers in text or in double precision.
    const DOUBLE: f64 = 1e-9;
    /// Precision of numbers in single precision.
    const SINGLE: f64 = 1e-6;
}

impl StartFrame {
    /// Source of a quantity.
    pub fn source(&self, quantity: StartQuantity) -> QuantitySource {
        self.sources[quantity as usize]
    }

    /// Name of the column of a quantity.
    pub fn column(&self, quantity: StartQuantity) -> &'static str {
        self.columns[quantity as usize]
    }
}

/// Reason why a start file cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum StartFileError {
    /// A mistake in XYZ.
    #[error(transparent)]
    Xyz(#[from] XyzReadError),
    /// A mistake in GSD.
    #[error(transparent)]
    Gsd(#[from] GsdReadError),
    /// A mistake in another text.
    #[error(transparent)]
    Text(#[from] TextReadError),
    /// A format that is not read.
    #[error(
        "{}: this is {found}; expected {}: convert it, for example with OVITO (Export File, XYZ)",
        quoted::path(file),
        start_format_names()
    )]
    Foreign {
        /// Path of the file.
        file: PathBuf,
        /// Format found.
        found: ForeignFormat,
    },
    /// A format that nothing recognises.
    #[error("{}: the format is not recognised; expected {}", quoted::path(file), start_format_names())]
    Unknown {
        /// Path of the file.
        file: PathBuf,
    },
    /// A frame that the file does not have.
    #[error("{}: there is no frame {asked}; expected a number from 0 to {}, as the file has {count} frames", quoted::path(file), count.saturating_sub(1))]
    NoFrame {
        /// Path of the file.
        file: PathBuf,
        /// Number asked for.
        asked: u64,
        /// Number of frames.
        count: u64,
    },
    /// A file without a frame.
    #[error("{}: the file is empty; expected {}", quoted::path(file), start_format_names())]
    Empty {
        /// Path of the file.
        file: PathBuf,
    },
}

impl StartFileError {
    /// Error for a frame beyond the last of `count`.
    fn beyond(file: &Path, request: StartRequest, count: u64) -> StartFileError {
        match request.frame {
            Some(asked) if count > 0 => StartFileError::NoFrame { file: file.to_owned(), asked, count },
            _ => StartFileError::Empty { file: file.to_owned() },
        }
    }
}

/// Reads a frame of a file in any of the formats.
///
/// # Errors
/// [`StartFileError`] with file, line and expectation.
pub fn read_start_file(path: &Path, request: StartRequest) -> Result<StartFrame, StartFileError> {
    /// Bytes by which a format is recognised.
    const HEAD: u64 = 1 << 16;
    let mut head = vec![];
    let read = regular_file::open(path).and_then(|file| file.take(HEAD).read_to_end(&mut head));
    read.map_err(|cause| TextReadError::of_system(path, cause))?;
    if head.trim_ascii().is_empty() {
        return Err(StartFileError::Empty { file: path.to_owned() });
    }
    if let Some(format) = START_FORMATS.iter().find(|format| (format.recognises)(&head)) {
        return (format.read)(path, request);
    }
    let file = path.to_owned();
    Err(match ForeignFormat::of(&head) {
        Some(found) => StartFileError::Foreign { file, found },
        None => StartFileError::Unknown { file },
    })
}

/// Kind and species of a type of LAMMPS; types are numbered from 1. In files of this program one of them is that of wall discs.
fn particle_of_type(name: &str, is_own: bool) -> (ParticleKind, u8) {
    let number = name.parse::<u32>().map_or(0, |number| number.saturating_sub(1));
    match is_own {
        true => kind_and_species(number),
        false => (ParticleKind::Grain, number.min(u8::MAX.into()) as u8),
    }
}

/// Lines of the first bytes of a file, without a byte-order mark.
fn lines(head: &[u8]) -> impl Iterator<Item = &[u8]> {
    let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
    head.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii)
}

/// True if a text is a whole number.
fn is_count(line: &[u8]) -> bool {
    std::str::from_utf8(line).is_ok_and(|text| text.parse::<u64>().is_ok())
}
