//! One writer a folder: a lock that the system gives back with the process that held it, however that ended.

use super::replace::{folder_of, is_name_of, remove_if_there};
use super::{FileError, FolderError};
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind, Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// The first line of a lock file.
const HEADING: &str = "stripmine lock 1";
/// More than a lock file holds (bytes).
const LONGEST: u64 = 1000;

/// The right to write into a folder, until it is dropped.
#[derive(Debug)]
pub(crate) struct Lock {
    path: PathBuf,
    file: File,
    held: bool,
}

/// Whether the file at `path` is a lock file, or became one no further than its creation.
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
    /// Takes the lock whose file is at `path`, in a folder that is there.
    ///
    /// # Errors
    /// [`FolderError`] if another process has it, something else is called so, or the system does not let it be written.
    pub(crate) fn take(path: &Path) -> Result<Lock, FolderError> {
        let at = || FileError::at(path, "locking");
        loop {
            let file = match OpenOptions::new().read(true).write(true).create_new(true).open(path) {
                Err(cause) if cause.kind() == ErrorKind::AlreadyExists => {
                    match OpenOptions::new().read(true).write(true).open(path) {
                        // Removed by its holder in between.
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
                // A file system without locks.
                Err(TryLockError::Error(cause)) if cause.kind() == ErrorKind::Unsupported => false,
                Err(TryLockError::Error(cause)) => return Err(at()(cause).into()),
            };
            if !is_name_of(path, &file).map_err(at())? {
                if path.symlink_metadata().is_ok_and(|there| !there.is_file()) {
                    return Err(FolderError::in_the_way(path));
                }
                // Removed by the one who held it: the next one has another file.
                continue;
            }
            if !is_lock_text(&text(&file).map_err(at())?) {
                return Err(FolderError::in_the_way(path));
            }
            sign(&file).map_err(at())?;
            return Ok(Lock { path: path.to_owned(), file, held });
        }
    }

    /// Whether the file system keeps others out; some know no locks.
    pub(crate) fn is_held(&self) -> bool {
        self.held
    }

    /// Whether the lock file is still there.
    pub(crate) fn is_there(&self) -> bool {
        is_name_of(&self.path, &self.file).unwrap_or(false)
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // Safe while it is held: a process that has opened it meanwhile finds that the name is gone and opens another.
        if cfg!(unix) && self.held && self.is_there() {
            #[expect(clippy::let_underscore_must_use, reason = "a file that cannot be removed does no harm")]
            let _ = remove_if_there(&self.path);
        }
    }
}

/// Writes who holds the lock into its file.
fn sign(mut file: &File) -> io::Result<()> {
    file.set_len(0)?;
    file.rewind()?;
    let (process, host) = (std::process::id(), gethostname::gethostname());
    let since = humantime::format_rfc3339_seconds(SystemTime::now());
    write!(file, "{HEADING}\nprocess {process}\nhost {}\nsince {since}\n", host.to_string_lossy())
}

/// Who holds a lock, by its file.
fn holder(file: &File) -> String {
    #[expect(clippy::disallowed_methods, reason = "who holds a lock is told where it can be read")]
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
