//! Lock of a folder for one writer. The system releases it when the process ends, in whatever way.

use super::replace::{folder_of, is_name_of, remove_if_there};
use super::{FileError, FolderError};
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind, Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// First line of a lock file.
const HEADING: &str = "stripmine lock 1";
/// Largest part of a lock file that is read (bytes).
const LONGEST: u64 = 1000;

/// Exclusive right to write to a folder, until it is dropped.
#[derive(Debug)]
pub(crate) struct Lock {
    path: PathBuf,
    file: File,
    held: bool,
}

/// Returns true if the file at `path` is a lock file, possibly not yet complete.
pub(crate) fn is_lock(path: &Path) -> bool {
    let is_file = path.symlink_metadata().is_ok_and(|there| there.is_file());
    is_file && File::open(path).and_then(|file| text(&file)).is_ok_and(|text| is_lock_text(&text))
}

fn is_lock_text(text: &str) -> bool {
    text.is_empty() || HEADING.starts_with(text) || text.lines().next() == Some(HEADING)
}

fn text(file: &File) -> io::Result<String> {
    let mut bytes = Vec::new();
    file.take(LONGEST).read_to_end(&mut bytes)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

impl Lock {
    /// Takes the lock whose file is at `path`, in an existing folder.
    ///
    /// # Errors
    /// [`FolderError`] if another process holds it, something else has its name, or the system refuses to write it.
    pub(crate) fn take(path: &Path) -> Result<Lock, FolderError> {
        let at = || FileError::at(path, "locking");
        loop {
            let file = match OpenOptions::new().read(true).write(true).create_new(true).open(path) {
                Err(cause) if cause.kind() == ErrorKind::AlreadyExists => {
                    match OpenOptions::new().read(true).write(true).open(path) {
                        // Its holder has removed it in between.
                        Err(cause)
                            if cause.kind() == ErrorKind::NotFound && path.symlink_metadata().is_err() =>
                        {
                            continue;
                        }
                        opened => opened.map_err(at())?,
                    }
                }
                created => created.map_err(at())?,
            };
            let held = match file.try_lock() {
                Ok(()) => true,
                Err(TryLockError::WouldBlock) => {
                    return Err(FolderError::Held(folder_of(path).to_owned(), holder(&file)));
                }
                // Some file systems have no locks.
                Err(TryLockError::Error(cause)) if cause.kind() == ErrorKind::Unsupported => false,
                Err(TryLockError::Error(cause)) => return Err(at()(cause).into()),
            };
            if !is_name_of(path, &file).map_err(at())? {
                if path.symlink_metadata().is_ok_and(|there| !there.is_file()) {
                    return Err(FolderError::in_the_way(path));
                }
                // Its holder has removed it, so the next holder has another file.
                continue;
            }
            if !is_lock_text(&text(&file).map_err(at())?) {
                return Err(FolderError::in_the_way(path));
            }
            write_holder(&file).map_err(at())?;
            return Ok(Lock { path: path.to_owned(), file, held });
        }
    }

    /// True if the file system excludes other writers; some have no locks.
    pub(crate) fn is_held(&self) -> bool {
        self.held
    }

    /// True if the lock file still exists.
    pub(crate) fn is_there(&self) -> bool {
        is_name_of(&self.path, &self.file).unwrap_or(false)
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // This is safe during the hold: a process that has opened the file meanwhile finds its name gone and opens another.
        if cfg!(unix) && self.held && self.is_there() {
            #[expect(clippy::let_underscore_must_use, reason = "a leftover lock file does no harm")]
            let _ = remove_if_there(&self.path);
        }
    }
}

/// Writes the holder of the lock into its file.
fn write_holder(mut file: &File) -> io::Result<()> {
    file.set_len(0)?;
    file.rewind()?;
    let (process, host) = (std::process::id(), gethostname::gethostname());
    let since = humantime::format_rfc3339_seconds(SystemTime::now());
    write!(file, "{HEADING}\nprocess {process}\nhost {}\nsince {since}\n", host.to_string_lossy())
}

/// Holder of a lock, read from its file.
fn holder(file: &File) -> String {
    #[expect(
        clippy::disallowed_methods,
        reason = "the holder of a lock is named only if its file can be read"
    )]
    let text = text(file).unwrap_or_default();
    let said = |what: &str| {
        let value = text.lines().find_map(|line| line.strip_prefix(what)?.strip_prefix(' '))?;
        Some(value.chars().flat_map(char::escape_debug).collect::<String>())
    };
    match (said("process"), said("host"), said("since")) {
        (Some(process), Some(host), Some(since)) => format!("process {process} on {host} since {since}"),
        _ => "another process".to_owned(),
    }
}
