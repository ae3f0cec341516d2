//! Reading and writing of files: formats for particles, checkpoints, tables that grow during a run. Files are replaced atomically. One process at a
//! time writes to a folder, and files of others in it are never lost.

pub mod checkpoint;
pub(crate) mod dcd;
pub mod extxyz;
mod folder_error;
pub mod growing_file;
pub mod gsd;
pub mod lammps;
pub(crate) mod lock;
pub(crate) mod numbers;
pub(crate) mod open_sinks;
pub mod output_format;
pub mod owned_folder;
mod plane;
pub mod regular_file;
pub mod replace;
pub mod run_moment;
pub mod sink;
mod species;
pub mod start_files;
pub mod table_file;
pub mod trajectory;

pub use folder_error::FolderError;

use output_format::OutputFormat;
use std::path::{Path, PathBuf};

/// Formats for particles, in the order of their keys. Frames are read from the first one that has any.
pub static FORMATS: &[OutputFormat] = &[extxyz::FORMAT, dcd::FORMAT, gsd::FORMAT, lammps::DUMP, lammps::DATA];

/// Failure of the system to read or write a file.
#[derive(Debug, thiserror::Error)]
#[error("{}: {action}: {cause}", crate::quoted::path(file))]
pub struct FileError {
    /// Path of the file.
    pub file: PathBuf,
    /// Action that failed.
    pub action: &'static str,
    /// Error of the system.
    pub cause: std::io::Error,
}

impl FileError {
    /// Adds the file and the failed action to an error of the system.
    pub fn at(file: &Path, action: &'static str) -> impl FnOnce(std::io::Error) -> FileError {
        move |cause| FileError { file: file.to_owned(), action, cause }
    }
}
