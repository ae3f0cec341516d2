//! Files in and out: the formats that a run writes its particles in, checkpoints, tables that grow with a run; how they are put in
//! their place, and folders that one process at a time writes into and that lose nothing of others.

pub mod checkpoint;
pub(crate) mod dcd;
pub mod extxyz;
mod folder_error;
pub mod growing_file;
pub mod gsd;
pub mod lammps;
pub(crate) mod lock;
pub(crate) mod opened;
pub mod output_format;
pub mod owned_folder;
pub mod regular_file;
pub mod replace;
pub mod run_moment;
pub mod sink;
pub mod table_file;
pub mod trajectory;

pub use folder_error::FolderError;

use output_format::OutputFormat;
use std::path::{Path, PathBuf};

/// The formats that a run writes its particles in, in the order of their keys. Frames are read from the first that has any.
pub static FORMATS: &[OutputFormat] = &[extxyz::FORMAT, dcd::FORMAT, gsd::FORMAT, lammps::DUMP, lammps::DATA];

/// A file that the system would not let be read or written.
#[derive(Debug, thiserror::Error)]
#[error("{}: {action}: {cause}", crate::quoted::path(file))]
pub struct FileError {
    /// The file.
    pub file: PathBuf,
    /// What was being done with it.
    pub action: &'static str,
    /// What the system said.
    pub cause: std::io::Error,
}

impl FileError {
    /// Names the file and the action that failed.
    pub fn at(file: &Path, action: &'static str) -> impl FnOnce(std::io::Error) -> FileError {
        move |cause| FileError { file: file.to_owned(), action, cause }
    }
}
