//! File layer of GSD: chunks by frame and name, appended to a growing file, and the index that locates them.
//!
//! The layout depends on the frames alone, so that a resumed run writes the same bytes as one that was never stopped. Heading and index always
//! describe complete frames, whenever the process is killed. A moved index is written before the heading that refers to it, and a frame before its
//! entries.

use super::layout::{ENTRY, GsdNumber, HEADING, Heading, Index, IndexEntry, aligned, list_of};
use crate::io::FileError;
use crate::io::growing_file::{
    FileMark, GrowingFileError, check_length_written, create_new_file, reopen_at_mark, sync_and_check,
};
use crc32fast::Hasher;
use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Number of entries in the first index.
const FIRST_CAPACITY: u64 = 1024;
/// Size of the write buffer (bytes).
const BUFFER: usize = 1 << 18;

/// GSD file that only this process appends to.
#[derive(Debug)]
pub(crate) struct GsdFile {
    path: PathBuf,
    out: BufWriter<File>,
    names: Vec<String>,
    frames: u64,
    index: Index,
    /// Number of used entries of the index.
    used: u64,
    /// Length of the file (bytes).
    end: u64,
    /// Checksum of all chunks and then their entries, frame by frame.
    checksum: Hasher,
    /// Entries of the current frame, as bytes, and one of its chunks.
    entries: Vec<u8>,
    chunk: Vec<u8>,
}

impl GsdFile {
    /// Creates a file without frames; `names` are the names of its chunks.
    ///
    /// # Errors
    /// If the path exists, or the system refuses to write it.
    pub(super) fn create(path: impl Into<PathBuf>, names: Vec<String>) -> Result<Self, FileError> {
        let path = path.into();
        let created = create_new_file(&path)?;
        let mut file = GsdFile::empty(path, created, names);
        let begun = file.begin();
        begun.map_err(FileError::at(&file.path, "writing"))?;
        Ok(file)
    }

    /// Resumes a file at a mark; [`cut`](Self::cut) removes everything after it.
    ///
    /// # Errors
    /// If the bytes before the mark have changed, the file is a link, or the system refuses to read or write it.
    pub(super) fn resume(
        path: impl Into<PathBuf>,
        names: Vec<String>,
        mark: FileMark,
    ) -> Result<Self, GrowingFileError> {
        let path = path.into();
        let opened = reopen_at_mark(&path, mark)?;
        let mut file = GsdFile::empty(path, opened, names);
        let is_whole = file.read_up_to(mark.bytes).map_err(FileError::at(&file.path, "reading"))?;
        let found = file.checksum.clone().finalize();
        if !is_whole || found != mark.checksum {
            let FileMark { bytes, checksum: expected } = mark;
            return Err(GrowingFileError::Changed { file: file.path, bytes, found, expected });
        }
        Ok(file)
    }

    /// State of a file before the first frame.
    fn empty(path: PathBuf, file: File, names: Vec<String>) -> GsdFile {
        let index = Index { at: HEADING + list_of(&names).len() as u64, capacity: FIRST_CAPACITY };
        GsdFile {
            path,
            out: BufWriter::with_capacity(BUFFER, file),
            names,
            frames: 0,
            end: index.at + ENTRY * index.capacity,
            index,
            used: 0,
            checksum: Hasher::new(),
            entries: vec![],
            chunk: vec![],
        }
    }

    /// Heading for the present state.
    fn heading(&self) -> [u8; HEADING as usize] {
        let names = [HEADING, list_of(&self.names).len() as u64];
        Heading { index: self.index, names }.bytes()
    }

    fn begin(&mut self) -> io::Result<()> {
        let (heading, names) = (self.heading(), list_of(&self.names));
        self.overwrite(0, &[&heading[..], &names].concat())?;
        self.out.get_ref().set_len(self.end)?;
        self.out.seek(SeekFrom::Start(self.end)).map(drop)
    }

    /// Reads the frames up to a length, each at its expected location. Returns true if all of them and the index are there.
    fn read_up_to(&mut self, length: u64) -> io::Result<bool> {
        /// Bytes of the heading that locate the index.
        const MOVES: std::ops::Range<usize> = 8..24;
        let (first, list) = (self.heading(), list_of(&self.names));
        let mut heading = [0; HEADING as usize];
        let mut names = vec![0; list.len()];
        let file = self.out.get_mut();
        file.rewind()?;
        file.read_exact(&mut heading)?;
        file.read_exact(&mut names)?;
        let said = Heading::read(&heading, true).ok();
        heading[MOVES].copy_from_slice(&first[MOVES]);
        if heading != first || names != list {
            return Ok(false);
        }
        while self.end < length {
            if self.is_index_full() && !self.read_next_index(length)? {
                return Ok(false);
            }
            if !self.read_frame(length)? {
                return Ok(false);
            }
        }
        // The index may have moved since the mark.
        let has_moved = |to: Index| to.at >= length && to.capacity > self.index.capacity;
        let is_found = said.is_some_and(|said| said.index == self.index || has_moved(said.index));
        Ok(is_found && self.end == length)
    }

    /// Reads the next index, which follows the frames before it. Its first entries must equal those of the previous index, which must have no more.
    /// With the entries of the frames, the whole index is then checked.
    fn read_next_index(&mut self, length: u64) -> io::Result<bool> {
        let (before, next) = (self.index, self.next_index());
        self.end = next.at + ENTRY * next.capacity;
        if self.end > length {
            return Ok(false);
        }
        let used = (ENTRY * self.used) as usize;
        let entries = self.read_at(before.at, (ENTRY * before.capacity) as usize)?;
        let copied = self.read_at(next.at, used)?;
        self.index = next;
        Ok(entries[..used] == copied && entries[used..].iter().all(|&byte| byte == 0))
    }

    fn read_at(&mut self, at: u64, length: usize) -> io::Result<Vec<u8>> {
        let mut bytes = vec![0; length];
        let file = self.out.get_mut();
        file.seek(SeekFrom::Start(at))?;
        file.read_exact(&mut bytes)?;
        Ok(bytes)
    }

    /// Adds a frame to the checksum; returns true if it is complete.
    fn read_frame(&mut self, length: u64) -> io::Result<bool> {
        let (frame, first) = (self.frames, self.index.at + ENTRY * self.used);
        let mut entries = self.read_at(first, ENTRY as usize * self.names.len())?;
        let of_the_frame = |bytes: &&[u8]| {
            let entry = IndexEntry::of(bytes);
            entry.at != 0 && entry.frame == frame
        };
        let count = entries.chunks_exact(ENTRY as usize).take_while(of_the_frame).count();
        entries.truncate(count * ENTRY as usize);
        let last = entries.chunks_exact(ENTRY as usize).next_back().map(IndexEntry::of);
        let end = last.and_then(IndexEntry::end).map_or(0, aligned);
        if end <= self.end || end > length {
            return Ok(false);
        }
        let file = self.out.get_mut();
        file.seek(SeekFrom::Start(self.end))?;
        let mut block = vec![0; BUFFER];
        while self.end < end {
            let wanted = block.len().min(usize::try_from(end - self.end).unwrap_or(usize::MAX));
            file.read_exact(&mut block[..wanted])?;
            self.checksum.update(&block[..wanted]);
            self.end += wanted as u64;
        }
        self.checksum.update(&entries);
        self.used += count as u64;
        self.frames += 1;
        Ok(true)
    }

    /// Truncates a resumed file at its mark; to be called once it is certain that the run resumes.
    ///
    /// # Errors
    /// If the system refuses to truncate it.
    pub(super) fn cut(&mut self) -> Result<(), FileError> {
        self.cut_here().map_err(FileError::at(&self.path, "cutting"))
    }

    /// The heading is written first, since the index of the mark still exists. The file is valid after each write.
    fn cut_here(&mut self) -> io::Result<()> {
        let (heading, Index { at, capacity }) = (self.heading(), self.index);
        self.overwrite(0, &heading)?;
        let unused = vec![0; (ENTRY * (capacity - self.used)) as usize];
        self.overwrite(at + ENTRY * self.used, &unused)?;
        self.out.get_ref().set_len(self.end)?;
        self.out.seek(SeekFrom::Start(self.end)).map(drop)
    }

    /// Overwrites bytes, or appends at the end.
    fn overwrite(&mut self, at: u64, bytes: &[u8]) -> io::Result<()> {
        let file = self.out.get_mut();
        file.seek(SeekFrom::Start(at))?;
        file.write_all(bytes)
    }

    /// Path of the file.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// True if the index may lack space for a frame.
    fn is_index_full(&self) -> bool {
        self.index.capacity - self.used < self.names.len() as u64
    }

    fn next_index(&self) -> Index {
        Index { at: self.end, capacity: 2 * self.index.capacity }
    }

    /// Appends an index of twice the size.
    fn grow_index(&mut self) -> io::Result<()> {
        let (from, to) = (self.index, self.next_index());
        let entries = self.read_at(from.at, (ENTRY * self.used) as usize)?;
        self.end = to.at + ENTRY * to.capacity;
        self.overwrite(to.at, &entries)?;
        self.out.get_ref().set_len(self.end)?;
        self.index = to;
        let heading = self.heading();
        self.overwrite(0, &heading)
    }

    /// Starts the next frame.
    ///
    /// # Errors
    /// Errors of the file; also if another program has changed its length.
    pub(super) fn begin_frame(&mut self) -> io::Result<()> {
        check_length_written(self.out.get_ref(), self.end)?;
        if self.is_index_full() {
            self.grow_index()?;
        }
        self.entries.clear();
        self.out.seek(SeekFrom::Start(self.end)).map(drop)
    }

    /// Adds a chunk to the frame: rows of `COLUMNS` numbers. Chunks must be added in the order of the names.
    ///
    /// # Errors
    /// Errors of the file.
    pub(super) fn add<E: GsdNumber, const COLUMNS: usize>(
        &mut self,
        name: &str,
        rows: impl IntoIterator<Item = [E; COLUMNS], IntoIter: ExactSizeIterator>,
    ) -> io::Result<()> {
        let name = self.names.iter().position(|it| it == name);
        let name = name.ok_or_else(|| io::Error::other("a chunk without a name"))?;
        let (rows, of_a_row) = (rows.into_iter(), COLUMNS * size_of::<E>());
        let entry = IndexEntry {
            frame: self.frames,
            rows: rows.len() as u64,
            at: self.end,
            columns: COLUMNS as u32,
            name: name as u16,
            code: E::CODE,
        };
        self.chunk.clear();
        self.chunk.resize(aligned((rows.len() * of_a_row) as u64) as usize, 0);
        for (bytes, row) in self.chunk.chunks_exact_mut(of_a_row).zip(rows) {
            for (bytes, number) in bytes.chunks_exact_mut(size_of::<E>()).zip(row) {
                number.put(bytes);
            }
        }
        self.entries.extend(entry.bytes());
        self.checksum.update(&self.chunk);
        self.end += self.chunk.len() as u64;
        self.out.write_all(&self.chunk)
    }

    /// Ends the frame and adds it to the index.
    ///
    /// # Errors
    /// Errors of the file.
    pub(super) fn end_frame(&mut self) -> io::Result<()> {
        self.out.flush()?;
        let entries = std::mem::take(&mut self.entries);
        self.checksum.update(&entries);
        self.overwrite(self.index.at + ENTRY * self.used, &entries)?;
        self.used += entries.len() as u64 / ENTRY;
        self.frames += 1;
        self.entries = entries;
        Ok(())
    }

    /// Syncs the file to the disk and returns its mark; to be called before a checkpoint.
    ///
    /// # Errors
    /// If the system refuses to write it, or the file has been removed, replaced or changed meanwhile.
    pub(super) fn sync(&mut self) -> Result<FileMark, FileError> {
        sync_and_check(&self.path, self.out.get_ref(), self.end)?;
        Ok(FileMark { bytes: self.end, checksum: self.checksum.clone().finalize() })
    }
}
