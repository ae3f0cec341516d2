//! Whole files put in their place in one step, by way of temporary files whose names cannot be foreseen.

use super::{FileError, FolderError};
use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::Path;
use tempfile::{Builder, NamedTempFile};

/// How the names of temporary files and folders begin and end; what is between is random.
const TEMPORARY: [&str; 2] = [".stripmine-", ".part"];

/// Whether a temporary file or folder of this program is called so.
pub(crate) fn is_temporary(name: &str) -> bool {
    name.starts_with(TEMPORARY[0]) && name.ends_with(TEMPORARY[1])
}

/// Names for temporary files or folders, with permissions as for any others: what the user's mask leaves of `mode`.
pub(crate) fn temporary<'a>(mode: u32) -> Builder<'a, 'a> {
    let mut builder = Builder::new();
    builder.prefix(TEMPORARY[0]).suffix(TEMPORARY[1]).rand_bytes(16);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(mode));
    #[cfg(not(unix))]
    let _ = mode;
    builder
}

/// The folder that a path lies in.
pub(crate) fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Puts what `write` writes in the place of the file at `path`: at every moment the old or the new one is there, whole,
/// and when this returns the new one is on the disk. A link at `path` is replaced, not followed.
///
/// # Errors
/// If the system does not let it be written; then what was at `path` stays.
pub fn replace(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>,
) -> Result<(), FileError> {
    let written = written_beside(path, write).map_err(FileError::at(path, "writing"))?;
    written.persist(path).map_err(|error| FileError::at(path, "replacing")(error.error))?;
    sync_folder(folder_of(path)).map_err(FileError::at(path, "replacing"))
}

/// Puts a whole file at `path` where nothing is or, with `overwrite`, in the place of what is there.
///
/// # Errors
/// If something is there that is to stay, or the system does not let the file be written; then what was at `path` stays.
pub fn put(path: &Path, text: &str, overwrite: bool) -> io::Result<()> {
    let file = written_beside(path, |out| out.write_all(text.as_bytes()))?;
    let placed = if overwrite { file.persist(path) } else { file.persist_noclobber(path) };
    placed.map(drop).map_err(|refused| refused.error)
}

/// Refuses to put a file where something is that is to stay: without `overwrite` anything, and always what is no file.
///
/// # Errors
/// [`FolderError::Exists`] with what to do, or [`FolderError::NoFile`].
pub fn may_put(path: &Path, overwrite: bool, remedy: &'static str) -> Result<(), FolderError> {
    match path.symlink_metadata() {
        Ok(_) if !overwrite => Err(FolderError::Exists(path.to_owned(), remedy)),
        // A link is replaced, not followed.
        Ok(there) if !there.is_file() && !there.is_symlink() => {
            Err(FolderError::NoFile(path.to_owned(), remedy))
        }
        _ => Ok(()),
    }
}

/// Makes a file beside `path` and removes it: whether one can be put there is known before the work for it is done.
///
/// # Errors
/// What the system says.
pub fn try_beside(path: &Path) -> io::Result<()> {
    temporary(0o666).tempfile_in(folder_of(path)).map(drop)
}

/// A temporary file in the folder of `path` that holds what `write` writes, on the disk.
///
/// # Errors
/// If the system does not let it be written.
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

/// Makes the renamings in a folder last.
///
/// # Errors
/// If the folder cannot be opened or its entries not be written to the disk.
pub(crate) fn sync_folder(folder: &Path) -> io::Result<()> {
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}

/// Removes a file or a link, never what the link points to; one that is not there is no error.
///
/// # Errors
/// If it is there and cannot be removed.
pub fn remove_if_there(path: &Path) -> Result<(), FileError> {
    match fs::remove_file(path) {
        Err(cause) if cause.kind() != ErrorKind::NotFound => Err(FileError::at(path, "removing")(cause)),
        _ => Ok(()),
    }
}

/// Whether `path` is still a name of the open file, and no link. Where the system has no numbers for its files, whether
/// there is a file of that name.
///
/// # Errors
/// If the system does not say what is there.
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
