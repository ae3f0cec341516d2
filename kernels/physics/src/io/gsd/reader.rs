//! Reading of GSD files written by this program.

use super::error::{GsdErrorKind, GsdLocation, GsdReadError};
use super::layout::{ENTRY, GsdNumber, HEADING, Heading, IndexEntry, names_of};
use super::{
    ANGLE, CORNER, COUNT, EXACT_MASS, EXACT_POSITION, EXACT_VELOCITY, ID, OMEGA, PERIODIC, RADIUS, SIDES,
    STEP, TIME, TYPE,
};
use crate::io::extxyz::ParticleFrame;
use crate::io::regular_file;
use crate::io::species::kind_and_species;
use crate::particles::{Particle, Particles};
use std::collections::HashSet;
use std::fs::{File, Metadata};
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// Frames of a file, by number or as an iterator that ends after the first wrong one.
#[derive(Debug)]
pub struct GsdFrames {
    path: PathBuf,
    file: File,
    /// Bytes of the file on the disk: fewer than its length if it has holes.
    on_disk: u64,
    pub(super) names: Vec<String>,
    index: Vec<IndexEntry>,
    next: u64,
    failed: bool,
}

impl GsdFrames {
    /// Opens a file and reads its index.
    ///
    /// # Errors
    /// If the system refuses to read it, or it is not such a file, or it is truncated.
    pub fn open(path: impl AsRef<Path>) -> Result<GsdFrames, GsdReadError> {
        GsdFrames::open_with(path.as_ref().to_owned(), true)
    }

    /// Opens a file of any program that writes the schema `hoomd`.
    ///
    /// # Errors
    /// As for [`open`](Self::open).
    pub(crate) fn open_foreign(path: &Path) -> Result<GsdFrames, GsdReadError> {
        GsdFrames::open_with(path.to_owned(), false)
    }

    fn open_with(path: PathBuf, is_own: bool) -> Result<GsdFrames, GsdReadError> {
        let opened = regular_file::open(&path).map_err(GsdErrorKind::Io);
        let read = opened.map_err(|reason| (GsdLocation::File, reason)).and_then(|file| {
            let (names, index) = index(&file, is_own)?;
            let on_disk =
                on_disk(&file.metadata().map_err(|cause| (GsdLocation::File, GsdErrorKind::Io(cause)))?);
            Ok(GsdFrames { path: path.clone(), file, on_disk, names, index, next: 0, failed: false })
        });
        match read {
            Ok(frames) => Ok(frames),
            Err((place, reason)) => Err(GsdReadError { file: path, place, reason }),
        }
    }

    /// Number of frames.
    pub fn frame_count(&self) -> u64 {
        self.index.last().map_or(0, |entry| entry.frame + 1)
    }

    /// Reads a frame by its number, from 0; none after the last.
    ///
    /// # Errors
    /// If the system refuses to read it, or its chunks are not those that this program writes.
    pub fn frame(&mut self, number: u64) -> Result<Option<ParticleFrame>, GsdReadError> {
        if number >= self.frame_count() {
            return Ok(None);
        }
        let frame = Chunks { frames: self, number }.frame();
        frame.map(Some).map_err(|(place, reason)| GsdReadError { file: self.path.clone(), place, reason })
    }

    /// Path of the file.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    fn entry(&self, frame: u64, name: usize) -> Option<IndexEntry> {
        let key = (frame, name as u16);
        let at = self.index.binary_search_by_key(&key, |entry| (entry.frame, entry.name)).ok()?;
        Some(self.index[at])
    }
}

impl Iterator for GsdFrames {
    type Item = Result<ParticleFrame, GsdReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.failed {
            return None;
        }
        let frame = self.frame(self.next).transpose();
        self.next += 1;
        self.failed = matches!(frame, Some(Err(_)));
        frame
    }
}

pub(super) type LocatedGsdError = (GsdLocation, GsdErrorKind);

/// Longest list of names (bytes): entries number names with 16 bits, and each name has at most 63 letters.
const LONGEST_NAMES: u64 = 64 << 16;
/// Longest chunk that may be a hole of the file (bytes); of longer ones a hundredth must be on the disk.
const MOST_HOLES: u64 = 1 << 24;

#[cfg(unix)]
fn on_disk(file: &Metadata) -> u64 {
    std::os::unix::fs::MetadataExt::blocks(file) * 512
}

#[cfg(not(unix))]
fn on_disk(file: &Metadata) -> u64 {
    file.len()
}

/// Reads the names and the entries of a file.
fn index(file: &File, is_own: bool) -> Result<(Vec<String>, Vec<IndexEntry>), LocatedGsdError> {
    let system = |cause: io::Error| (GsdLocation::File, GsdErrorKind::Io(cause));
    let length = file.metadata().map_err(system)?.len();
    let mut file = BufReader::new(file);
    let inside = |what, end: Option<u64>| match end {
        Some(end) if end <= length => Ok(()),
        end => {
            Err((GsdLocation::File, GsdErrorKind::Truncated { what, end: end.unwrap_or(u64::MAX), length }))
        }
    };
    let mut bytes = [0; HEADING as usize];
    inside("the heading", Some(HEADING))?;
    file.read_exact(&mut bytes).map_err(system)?;
    let wrong = |byte, expected| (GsdLocation::Byte(byte), GsdErrorKind::Expected(expected));
    let Heading { index, names } =
        Heading::read(&bytes, is_own).map_err(|(byte, expected)| wrong(byte, expected))?;
    let [first, length_of_names] = names;
    inside("the list of names", first.checked_add(length_of_names))?;
    if length_of_names > LONGEST_NAMES {
        return Err(wrong(32, "a list of names of at most 4 MiB"));
    }
    inside("the index", index.end())?;

    let mut list = vec![0; length_of_names as usize];
    file.seek(SeekFrom::Start(first)).and_then(|_| file.read_exact(&mut list)).map_err(system)?;
    let names =
        names_of(&list).ok_or(wrong(first, "names that end with a 0 each, and the last one with two"))?;

    file.seek(SeekFrom::Start(index.at)).map_err(system)?;
    let mut entries: Vec<IndexEntry> = vec![];
    for number in 0..index.capacity {
        let mut bytes = [0; ENTRY as usize];
        file.read_exact(&mut bytes).map_err(system)?;
        let (entry, at) = (IndexEntry::of(&bytes), index.at + ENTRY * number);
        if entry.at == 0 {
            break;
        }
        if bytes[ENTRY as usize - 1] != 0 || usize::from(entry.name) >= names.len() {
            return Err(wrong(at, "an entry of the index for a chunk with a name"));
        }
        let follows = match entries.last() {
            None => entry.frame == 0 || !is_own,
            Some(last) => {
                let is_next = if is_own { entry.frame == last.frame + 1 } else { entry.frame > last.frame };
                entry.frame == last.frame && entry.name > last.name || is_next
            }
        };
        if !follows {
            return Err(wrong(at, "entries of the index in the order of frames and names"));
        }
        let Some(end) = entry.end() else { return Err(wrong(at, "a chunk of numbers of a known type")) };
        if end > length {
            return Err((
                GsdLocation::Byte(at),
                GsdErrorKind::Truncated { what: "the chunk of this entry", end, length },
            ));
        }
        entries.push(entry);
    }
    Ok((names, entries))
}

/// Access to the chunks of a frame.
pub(super) struct Chunks<'f> {
    pub(super) frames: &'f mut GsdFrames,
    pub(super) number: u64,
}

impl Chunks<'_> {
    pub(super) fn wrong(&self, chunk: &'static str, reason: GsdErrorKind) -> LocatedGsdError {
        (GsdLocation::Chunk { frame: self.number, chunk }, reason)
    }

    /// Rows and columns of a chunk of the frame or, if it lacks the chunk, of the first frame.
    pub(super) fn shape(&self, chunk: &str) -> Option<[usize; 2]> {
        let name = self.frames.names.iter().position(|name| name == chunk)?;
        let entry = self.frames.entry(self.number, name).or_else(|| self.frames.entry(0, name))?;
        Some([entry.rows as usize, entry.columns as usize])
    }

    /// Reads rows of a number of columns from the frame or, if it lacks the chunk, from the first frame; none if both lack it.
    pub(super) fn rows<E: GsdNumber>(
        &mut self,
        chunk: &'static str,
        rows: usize,
        columns: usize,
    ) -> Result<Option<Vec<E>>, LocatedGsdError> {
        let Some(name) = self.frames.names.iter().position(|name| name == chunk) else { return Ok(None) };
        let found = self.frames.entry(self.number, name);
        // The first frame may have another number of particles.
        let of_first = || self.frames.entry(0, name).filter(|first| first.rows == rows as u64);
        let Some(entry) = found.or_else(of_first) else { return Ok(None) };
        if (entry.rows, entry.columns, entry.code) != (rows as u64, columns as u32, E::CODE) {
            let said = |rows, columns, code| format!("{rows} × {columns} numbers of type {code}");
            let reason = GsdErrorKind::Shape {
                found: said(entry.rows, u64::from(entry.columns), entry.code),
                expected: said(rows as u64, columns as u64, E::CODE),
            };
            return Err(self.wrong(chunk, reason));
        }
        let length = rows * columns * size_of::<E>();
        let mut bytes = Vec::new();
        if length as u64 > MOST_HOLES.max(self.frames.on_disk.saturating_mul(100)) {
            return Err(
                self.wrong(chunk, GsdErrorKind::Hole { length: length as u64, on_disk: self.frames.on_disk })
            );
        }
        bytes
            .try_reserve_exact(length)
            .map_err(|_| self.wrong(chunk, GsdErrorKind::Memory { length: length as u64 }))?;
        bytes.resize(length, 0);
        let file = &mut self.frames.file;
        let read = file.seek(SeekFrom::Start(entry.at)).and_then(|_| file.read_exact(&mut bytes));
        read.map_err(|cause| self.wrong(chunk, GsdErrorKind::Io(cause)))?;
        Ok(Some(bytes.chunks_exact(size_of::<E>()).map(E::of).collect()))
    }

    fn required_rows<E: GsdNumber>(
        &mut self,
        chunk: &'static str,
        rows: usize,
        columns: usize,
    ) -> Result<Vec<E>, LocatedGsdError> {
        self.rows(chunk, rows, columns)?.ok_or_else(|| self.wrong(chunk, GsdErrorKind::Missing))
    }

    pub(super) fn one<E: GsdNumber>(&mut self, chunk: &'static str) -> Result<E, LocatedGsdError> {
        Ok(self.required_rows(chunk, 1, 1)?[0])
    }

    /// Reads finite numbers, greater than 0 if required.
    fn numbers(
        &mut self,
        chunk: &'static str,
        (rows, columns): (usize, usize),
        is_positive: bool,
    ) -> Result<Vec<f64>, LocatedGsdError> {
        let numbers = self.required_rows::<f64>(chunk, rows, columns)?;
        let fits = |number: f64| number.is_finite() && (number > 0.0 || !is_positive);
        let Some(at) = numbers.iter().position(|&number| !fits(number)) else { return Ok(numbers) };
        let expected = if is_positive { "a finite number greater than 0" } else { "a finite number" };
        let reason = GsdErrorKind::Number { row: at / columns, found: numbers[at].to_string(), expected };
        Err(self.wrong(chunk, reason))
    }

    /// Sides of the box; infinite without a box.
    fn sides(&mut self) -> Result<[f64; 2], LocatedGsdError> {
        let sides = self.required_rows::<f64>(SIDES, 2, 1)?;
        let Some(row) = sides.iter().position(|side| side.is_nan() || *side <= 0.0) else {
            return Ok([sides[0], sides[1]]);
        };
        let (found, expected) = (sides[row].to_string(), "a number greater than 0");
        Err(self.wrong(SIDES, GsdErrorKind::Number { row, found, expected }))
    }

    fn frame(mut self) -> Result<ParticleFrame, LocatedGsdError> {
        let count = self.one::<u32>(COUNT)? as usize;
        let (sides, corner) = (self.sides()?, self.numbers(CORNER, (2, 1), false)?);
        let periodic = self.required_rows::<u8>(PERIODIC, 2, 1)?;
        let axes = if sides.iter().all(|side| side.is_finite()) { 2 } else { 3 };
        let kinds = self.required_rows::<u32>(TYPE, count, 1)?;
        let ids = self.required_rows::<u32>(ID, count, 1)?;
        let [radius, mass] =
            [self.numbers(RADIUS, (count, 1), true)?, self.numbers(EXACT_MASS, (count, 1), true)?];
        let position = self.numbers(EXACT_POSITION, (count, axes), false)?;
        let velocity = self.numbers(EXACT_VELOCITY, (count, axes), false)?;
        let [angle, omega] =
            [self.numbers(ANGLE, (count, 1), false)?, self.numbers(OMEGA, (count, 1), false)?];
        if let Some(row) = kinds.iter().position(|&kind| kind > 1 + u32::from(u8::MAX)) {
            let (found, expected) =
                (kinds[row].to_string(), "1 (a wall disc), or a species of grains: 0, or 2 to 256");
            return Err(self.wrong(TYPE, GsdErrorKind::Number { row, found, expected }));
        }
        let mut seen = HashSet::with_capacity(count);
        if let Some(row) = ids.iter().position(|id| !seen.insert(*id)) {
            return Err(self.wrong(ID, GsdErrorKind::RepeatedId { row, id: ids[row] }));
        }
        let vector = |of: &[f64], number: usize| {
            std::array::from_fn(|axis| if axis < axes { of[axes * number + axis] } else { 0.0 })
        };
        let particle = |number: usize| Particle {
            id: ids[number],
            kind: kind_and_species(kinds[number]).0,
            species: kind_and_species(kinds[number]).1,
            position: vector(&position, number),
            velocity: vector(&velocity, number),
            angle: angle[number],
            omega: omega[number],
            radius: radius[number],
            mass: mass[number],
        };
        Ok(ParticleFrame {
            particles: Particles::new((0..count).map(particle).collect()),
            cell: sides,
            origin: [corner[0], corner[1]],
            periodic: Some([periodic[0] != 0, periodic[1] != 0]),
            time: self.numbers(TIME, (1, 1), false)?[0],
            step: self.one(STEP)?,
            seed: None,
            has_raised_ids: false,
        })
    }
}
