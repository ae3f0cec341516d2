//! Ordinary files, read whole up to a limit. Devices, pipes and the like are refused before they are opened.

use std::fs::{self, File, FileType};
use std::io::{self, ErrorKind, Read};
use std::path::Path;

/// Reason why a readable file is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum UnfitFile {
    /// A folder, a device, a pipe or a socket.
    #[error("it is {0}; expected an ordinary file")]
    Kind(&'static str),
    /// A file too long for its kind.
    #[error("it is longer than {most} bytes, the limit for such a file")]
    TooLong {
        /// Limit (bytes).
        most: u64,
    },
}

/// Opens an ordinary file for reading.
///
/// # Errors
/// The system's error, or [`UnfitFile`] inside an error of kind `InvalidInput`.
pub(crate) fn open(path: &Path) -> io::Result<File> {
    // Opening a pipe would wait for its writer, so the kind is checked before.
    match kind(fs::metadata(path)?.file_type()) {
        None => File::open(path),
        Some(kind) => Err(io::Error::new(ErrorKind::InvalidInput, UnfitFile::Kind(kind))),
    }
}

/// Reads an ordinary file of at most `most` bytes.
///
/// # Errors
/// As for `open`, and if the file is longer.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open(path)?.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return Err(io::Error::new(ErrorKind::InvalidInput, UnfitFile::TooLong { most }));
    }
    Ok(bytes)
}

/// First line that is not UTF-8, from 1; none if all are.
pub(crate) fn line_that_is_not_text(bytes: &[u8]) -> Option<usize> {
    let good = std::str::from_utf8(bytes).err()?.valid_up_to();
    Some(1 + bytes[..good].iter().filter(|byte| **byte == b'\n').count())
}

/// Kind of a file that is not an ordinary one.
fn kind(of: FileType) -> Option<&'static str> {
    if of.is_file() {
        return None;
    }
    if of.is_dir() {
        return Some("a folder");
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        if of.is_fifo() {
            return Some("a pipe");
        }
        if of.is_socket() {
            return Some("a socket");
        }
    }
    Some("a device")
}
