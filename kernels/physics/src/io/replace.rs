//! Atomic replacement of whole files, through temporary files with random names.

use super::{FileError, FolderError};
use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::Path;
use tempfile::{Builder, NamedTempFile};

/// Prefix and suffix of the names of temporary files and folders.
const TEMPORARY: [&str; 2] = [".stripmine-", ".part"];

/// Returns true for a name of this program's temporary files or folders.
pub(crate) fn is_temporary(name: &str) -> bool {
    name.starts_with(TEMPORARY[0]) && name.ends_with(TEMPORARY[1])
}

/// Builder of temporary files or folders with the usual permissions: `mode` under the user's mask.
pub(crate) fn temporary<'a>(mode: u32) -> Builder<'a, 'a> {
    let mut builder = Builder::new();
    builder.prefix(TEMPORARY[0]).suffix(TEMPORARY[1]).rand_bytes(16);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(mode));
    #[cfg(not(unix))]
    let _ = mode;
    builder
}

/// Folder of a path.
pub(crate) fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Replaces the file at `path` by the output of `write`. At every moment the complete old or new file exists, and on return the new one is on the
/// disk. A link at `path` is replaced, not followed.
///
/// # Errors
/// If the system refuses to write it; then the old file stays.
pub fn replace(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>,
) -> Result<(), FileError> {
    let written = written_beside(path, write).map_err(FileError::at(path, "writing"))?;
    written.persist(path).map_err(|error| FileError::at(path, "replacing")(error.error))?;
    sync_folder(folder_of(path)).map_err(FileError::at(path, "replacing"))
}

/// Writes a whole file at `path` atomically; with `overwrite` it may replace another.
///
/// # Errors
/// If `path` exists and `overwrite` is false, or the system refuses to write the file; then the old file stays.
pub fn write_atomically_new(path: &Path, text: &str, overwrite: bool) -> io::Result<()> {
    let file = written_beside(path, |out| out.write_all(text.as_bytes()))?;
    let placed = if overwrite { file.persist(path) } else { file.persist_noclobber(path) };
    placed.map(drop).map_err(|refused| refused.error)
}

/// Checks that a file may be written: `path` must not exist, or must be a file and `overwrite` true.
///
/// # Errors
/// [`FolderError::Exists`] with advice, or [`FolderError::NoFile`].
pub fn check_may_write(path: &Path, overwrite: bool, remedy: &'static str) -> Result<(), FolderError> {
    match path.symlink_metadata() {
        Ok(_) if !overwrite => Err(FolderError::Exists(path.to_owned(), remedy)),
        // A link is replaced, not followed.
        Ok(there) if !there.is_file() && !there.is_symlink() => {
            Err(FolderError::NoFile(path.to_owned(), remedy))
        }
        _ => Ok(()),
    }
}

/// Creates and removes a file beside `path`, to detect missing permissions before the work for it starts.
///
/// # Errors
/// The system's error.
pub fn check_folder_writable(path: &Path) -> io::Result<()> {
    temporary(0o666).tempfile_in(folder_of(path)).map(drop)
}

/// Temporary file in the folder of `path` with the output of `write`, synced to the disk.
///
/// # Errors
/// If the system refuses to write it.
pub(crate) fn written_beside(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>,
) -> io::Result<NamedTempFile> {
    let file = temporary(0o666).tempfile_in(folder_of(path))?;
    let mut out = BufWriter::new(file.as_file());
    write(&mut out)?;
    out.flush()?;
    drop(out);
    file.as_file().sync_all()?;
    Ok(file)
}

/// Syncs the renames in a folder to the disk.
///
/// # Errors
/// If the folder cannot be opened or synced.
pub(crate) fn sync_folder(folder: &Path) -> io::Result<()> {
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}

/// Removes a file or a link, never the target of a link; a missing file is not an error.
///
/// # Errors
/// If it exists and cannot be removed.
pub fn remove_if_there(path: &Path) -> Result<(), FileError> {
    match fs::remove_file(path) {
        Err(cause) if cause.kind() != ErrorKind::NotFound => Err(FileError::at(path, "removing")(cause)),
        _ => Ok(()),
    }
}

/// Returns true if `path` is still a name of the open file, and not a link. Without file numbers in the system, returns true if a file of that name
/// exists.
///
/// # Errors
/// If the system cannot examine `path`.
pub(crate) fn is_name_of(path: &Path, file: &File) -> io::Result<bool> {
    let there = match fs::symlink_metadata(path) {
        Ok(there) => there,
        Err(cause) if cause.kind() == ErrorKind::NotFound => return Ok(false),
        Err(cause) => return Err(cause),
    };
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let open = file.metadata()?;
        Ok(there.is_file() && (there.dev(), there.ino()) == (open.dev(), open.ino()))
    }
    #[cfg(not(unix))]
    {
        let _ = file;
        Ok(there.is_file())
    }
}
