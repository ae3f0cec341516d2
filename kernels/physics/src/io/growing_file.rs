//! File that grows during a run, with a checksum, so that a resumed run can append to it or report why it cannot.

use super::FileError;
use super::replace::is_name_of;
use crate::quoted;
use crc32fast::Hasher;
use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Length and checksum of a file at a moment: they allow truncation to that moment and reveal changes before it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FileMark {
    /// Number of bytes.
    pub bytes: u64,
    /// CRC-32 of these bytes.
    pub checksum: u32,
}

/// File that only this process appends to.
#[derive(Debug)]
pub struct GrowingFile {
    path: PathBuf,
    out: BufWriter<ChecksummedFile>,
}

/// Reason why a file cannot be resumed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GrowingFileError {
    /// The system refuses to read or write it.
    #[error(transparent)]
    File(#[from] FileError),
    /// The file is missing.
    #[error(
        "{} is missing: {expected} bytes of it were written up to the checkpoint; restore it, or start again with \
         --overwrite",
        quoted::path(file)
    )]
    Missing {
        /// Path of the file.
        file: PathBuf,
        /// Bytes at the checkpoint.
        expected: u64,
    },
    /// The file is shorter than it was.
    #[error(
        "{} has {found} bytes, but {expected} were written up to the checkpoint; restore it, or start \
         again with --overwrite",
        quoted::path(file)
    )]
    Short {
        /// Path of the file.
        file: PathBuf,
        /// Bytes of the file.
        found: u64,
        /// Bytes at the checkpoint.
        expected: u64,
    },
    /// The file has other bytes than were written.
    #[error(
        "{} has changed: the {bytes} bytes written up to the checkpoint have the checksum {found:08x}, not \
         {expected:08x}; restore it, or start again with --overwrite",
        quoted::path(file)
    )]
    Changed {
        /// Path of the file.
        file: PathBuf,
        /// Bytes at the checkpoint.
        bytes: u64,
        /// Present checksum.
        found: u32,
        /// Checksum at the checkpoint.
        expected: u32,
    },
    /// The file has other columns than this run writes.
    #[error("{}:1: the columns are `{found}`; this run writes `{expected}`", quoted::path(file))]
    Columns {
        /// Path of the file.
        file: PathBuf,
        /// Heading of the file.
        found: String,
        /// Heading of this run.
        expected: String,
    },
    /// The path is a link, or no file at all.
    #[error("{} is a link, or not a file; expected the file itself", quoted::path(.0))]
    NoFile(PathBuf),
}

impl GrowingFileError {
    /// True if the content is at fault, not the system.
    pub fn is_damage(&self) -> bool {
        !matches!(self, GrowingFileError::File(_))
    }
}

impl GrowingFile {
    /// Creates an empty file.
    ///
    /// # Errors
    /// If the path exists, or the system refuses to write it.
    pub fn create(path: impl Into<PathBuf>) -> Result<Self, FileError> {
        let path = path.into();
        let file = create_new_file(&path)?;
        Ok(GrowingFile { path, out: BufWriter::new(ChecksummedFile::from(file)) })
    }

    /// Resumes a file at a mark; [`cut`](Self::cut) removes everything after it.
    ///
    /// # Errors
    /// If the bytes before the mark have changed, the file is a link, or the system refuses to read or write it.
    pub fn resume(path: impl Into<PathBuf>, mark: FileMark) -> Result<Self, GrowingFileError> {
        let path = path.into();
        let mut summed = ChecksummedFile::from(reopen_at_mark(&path, mark)?);
        summed.read_up_to(mark.bytes).map_err(FileError::at(&path, "reading"))?;
        let found = summed.mark().checksum;
        if found != mark.checksum {
            let FileMark { bytes, checksum: expected } = mark;
            return Err(GrowingFileError::Changed { file: path, bytes, found, expected });
        }
        Ok(GrowingFile { path, out: BufWriter::new(summed) })
    }

    /// Truncates a resumed file at its mark; to be called once it is certain that the run resumes.
    ///
    /// # Errors
    /// If the system refuses to truncate it.
    pub fn cut(&mut self) -> Result<(), FileError> {
        let end = self.out.get_ref().bytes;
        let file = &mut self.out.get_mut().file;
        file.set_len(end)
            .and_then(|()| file.seek(SeekFrom::Start(end)).map(drop))
            .map_err(FileError::at(&self.path, "cutting"))
    }

    /// Path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Reads the first bytes, at most `most`.
    ///
    /// # Errors
    /// If the system refuses to read it.
    pub(crate) fn first_bytes(&mut self, most: usize) -> Result<Vec<u8>, FileError> {
        let summed = self.out.get_mut();
        let (end, file) = (summed.bytes, &mut summed.file);
        let mut bytes = Vec::new();
        file.rewind()
            .and_then(|()| file.take(most as u64).read_to_end(&mut bytes))
            .and_then(|_| file.seek(SeekFrom::Start(end)))
            .map_err(FileError::at(&self.path, "reading"))?;
        Ok(bytes)
    }

    /// Reads the first line without its end, with invalid UTF-8 replaced.
    ///
    /// # Errors
    /// If the system refuses to read it.
    pub fn first_line(&mut self) -> Result<String, FileError> {
        const LONGEST: usize = 10_000;
        let bytes = self.first_bytes(LONGEST)?;
        let line = bytes.split(|&byte| byte == b'\n').next().unwrap_or_default();
        Ok(String::from_utf8_lossy(line).into_owned())
    }

    /// Syncs the file to the disk and returns its mark; to be called before a checkpoint.
    ///
    /// # Errors
    /// If the system refuses to write it, or the file has been removed, replaced or changed meanwhile.
    pub fn sync(&mut self) -> Result<FileMark, FileError> {
        self.out.flush().map_err(FileError::at(&self.path, "writing"))?;
        let summed = self.out.get_ref();
        sync_and_check(&self.path, &summed.file, summed.bytes)?;
        Ok(summed.mark())
    }
}

/// Creates an empty file where none exists.
pub(super) fn create_new_file(path: &Path) -> Result<File, FileError> {
    let created = OpenOptions::new().read(true).write(true).create_new(true).open(path);
    created.map_err(FileError::at(path, "creating"))
}

/// Opens the file at `path`. It must be an ordinary file, not a link, and at least as long as at a mark.
pub(super) fn reopen_at_mark(path: &Path, mark: FileMark) -> Result<File, GrowingFileError> {
    let expected = mark.bytes;
    let file = match OpenOptions::new().read(true).write(true).open(path) {
        Err(cause) if cause.kind() == ErrorKind::NotFound => {
            return Err(GrowingFileError::Missing { file: path.to_owned(), expected });
        }
        opened => opened.map_err(FileError::at(path, "opening"))?,
    };
    let at = || FileError::at(path, "reading");
    if !is_name_of(path, &file).map_err(at())? {
        return Err(GrowingFileError::NoFile(path.to_owned()));
    }
    match file.metadata().map_err(at())?.len() {
        found if found < expected => Err(GrowingFileError::Short { file: path.to_owned(), found, expected }),
        _ => Ok(file),
    }
}

/// Syncs a file to the disk and checks that it has `written` bytes and is still the one at `path`.
pub(super) fn sync_and_check(path: &Path, file: &File, written: u64) -> Result<(), FileError> {
    let at = || FileError::at(path, "writing");
    file.sync_data().map_err(at())?;
    if !is_name_of(path, file).map_err(at())? {
        let cause = io::Error::new(ErrorKind::NotFound, "it was removed or replaced while the run wrote it");
        return Err(at()(cause));
    }
    check_length_written(file, written).map_err(at())
}

/// Checks that nothing else has changed the length of a file: further writing would leave a hole or part of another's bytes.
pub(super) fn check_length_written(file: &File, written: u64) -> io::Result<()> {
    let found = file.metadata()?.len();
    if found == written {
        return Ok(());
    }
    let cause = format!("it has {found} bytes, but {written} were written: another program changed it");
    Err(io::Error::other(cause))
}

impl Write for GrowingFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.out.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// File with the checksum of the bytes written to it.
#[derive(Debug)]
struct ChecksummedFile {
    file: File,
    bytes: u64,
    checksum: Hasher,
}

impl From<File> for ChecksummedFile {
    fn from(file: File) -> ChecksummedFile {
        ChecksummedFile { file, bytes: 0, checksum: Hasher::new() }
    }
}

impl ChecksummedFile {
    fn mark(&self) -> FileMark {
        FileMark { bytes: self.bytes, checksum: self.checksum.clone().finalize() }
    }

    fn read_up_to(&mut self, end: u64) -> io::Result<()> {
        let mut block = vec![0; 1 << 16];
        while self.bytes < end {
            let wanted = block.len().min(usize::try_from(end - self.bytes).unwrap_or(usize::MAX));
            self.file.read_exact(&mut block[..wanted])?;
            self.checksum.update(&block[..wanted]);
            self.bytes += wanted as u64;
        }
        Ok(())
    }
}

impl Write for ChecksummedFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        check_length_written(&self.file, self.bytes)?;
        let written = self.file.write(bytes)?;
        self.checksum.update(&bytes[..written]);
        self.bytes += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}
