//! Reading of frames in sequence.

use super::error::{Mistake, XyzMistakeKind, XyzMistakeList, XyzReadError};
use super::format::ForeignFormat;
use super::{FrameColumns, FrameContents, ParticleFrame, header};
use crate::io::plane::move_into_plane;
use crate::io::regular_file;
use crate::particles::{MOST_PARTICLES, Particles};
use std::collections::HashMap;
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

/// Longest line (bytes); other programs may write hundreds of columns.
const LONGEST_LINE: usize = 1 << 20;

/// Selection of a frame in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum FrameChoice {
    /// First frame; the text after it is only checked for another frame's count.
    First,
    /// Last frame; earlier ones are skipped without parsing.
    #[default]
    Last,
}

/// Reads one frame of a file.
///
/// # Errors
/// All mistakes of the frame, with their lines, or the first line at which frames cannot be separated.
pub fn read(path: impl AsRef<Path>, which: FrameChoice) -> Result<ParticleFrame, XyzReadError> {
    let mut frames = XyzFrames::open(path)?;
    match which {
        FrameChoice::First => {
            let frame = frames.parsed_next().map_err(|mistakes| mistakes.of_file(&frames.name))?;
            frames
                .raw
                .check_boundary()
                .map_err(|mistake| XyzMistakeList::from(mistake).of_file(&frames.name))?;
            frame
        }
        FrameChoice::Last => frames.last_frame().map_err(|mistakes| mistakes.of_file(&frames.name))?,
    }
    .ok_or_else(|| XyzMistakeList::from(Mistake::in_line(1, XyzMistakeKind::Empty)).of_file(&frames.name))
}

/// Iterator over the frames of a text; ends after the first wrong one.
pub struct XyzFrames<R> {
    name: String,
    raw: RawFrames<R>,
    room: FrameContents,
    failed: bool,
}

impl XyzFrames<BufReader<File>> {
    /// Opens a file.
    ///
    /// # Errors
    /// If the system refuses to read it.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, XyzReadError> {
        let name = path.as_ref().display().to_string();
        match regular_file::open(path.as_ref()) {
            Ok(file) => Ok(XyzFrames::new(BufReader::new(file), name)),
            Err(cause) => Err(XyzMistakeList::from(Mistake::reading(cause)).of_file(&name)),
        }
    }
}

impl<R: BufRead> XyzFrames<R> {
    /// Reads frames from a reader; `name` is used in errors.
    pub fn new(reader: R, name: impl Into<String>) -> Self {
        XyzFrames {
            name: name.into(),
            raw: RawFrames::new(reader),
            room: FrameContents::Plane,
            failed: false,
        }
    }

    /// Accepts everything that runs write: bodies in space and frames without a box.
    pub fn in_space(self) -> Self {
        XyzFrames { room: FrameContents::Space, ..self }
    }

    fn parsed_next(&mut self) -> Result<Option<ParticleFrame>, XyzMistakeList> {
        Ok(self.raw.next_frame()?.map(|raw| parse(&raw, self.room)).transpose()?.map(|parsed| parsed.frame))
    }

    fn last_frame(&mut self) -> Result<Option<ParticleFrame>, XyzMistakeList> {
        Ok(self.frame(None)?.ok().map(|parsed| parsed.frame))
    }

    /// Last frame, or the one with a number; beyond the last, the number of frames.
    fn frame(&mut self, number: Option<u64>) -> Result<Result<ParsedFrame, u64>, XyzMistakeList> {
        let (mut wanted, mut count) = (None, 0);
        while let Some(raw) = self.raw.next_frame()? {
            if number.is_none_or(|number| number == count) {
                wanted = Some(raw);
            }
            count += 1;
        }
        wanted.map(|raw| parse(&raw, self.room)).transpose().map(|parsed| parsed.ok_or(count))
    }
}

impl<R: BufRead> Iterator for XyzFrames<R> {
    type Item = Result<ParticleFrame, XyzReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.failed {
            return None;
        }
        let frame = self.parsed_next().map_err(|mistakes| mistakes.of_file(&self.name));
        self.failed = frame.is_err();
        frame.transpose()
    }
}

/// Frame whose text is not parsed yet.
pub(super) struct RawFrame {
    /// Line of the count, from 1.
    line: usize,
    count: usize,
    /// Text of the comment line and the rows.
    text: Vec<u8>,
}

impl RawFrame {
    /// Parses the comment line.
    pub(super) fn header(&self, room: FrameContents) -> Result<header::CommentHeader, XyzMistakeList> {
        let comment = self.text.split(|&byte| byte == b'\n').next().unwrap_or_default();
        header::parse(utf8(comment, self.line + 1)?, self.line + 1, room)
    }
}

/// Splitter of a text into frames.
pub(super) struct RawFrames<R> {
    reader: R,
    /// Number of lines read.
    line: usize,
    /// Line of the previous frame's count.
    previous: Option<usize>,
    /// Number of frames read.
    frames: usize,
    /// Count line read in advance.
    ahead: Option<Vec<u8>>,
}

impl<R: BufRead> RawFrames<R> {
    pub(super) fn new(reader: R) -> Self {
        RawFrames { reader, line: 0, previous: None, frames: 0, ahead: None }
    }

    /// Reads the next frame, none after the last; skips blank lines between frames.
    pub(super) fn next_frame(&mut self) -> Result<Option<RawFrame>, Mistake> {
        let Some(count) = self.count()? else { return Ok(None) };
        let line = self.line;
        let mut text = Vec::new();
        for row in 0..=count {
            if self.append_line(&mut text)? == 0 {
                let found = row.saturating_sub(1);
                let reason = XyzMistakeKind::Truncated { found, promised: count, line, frames: self.frames };
                return Err(Mistake::in_line(self.line, reason));
            }
        }
        self.previous = Some(line);
        self.frames += 1;
        Ok(Some(RawFrame { line, count, text }))
    }

    /// Checks that a frame starts here or the text ends.
    fn check_boundary(&mut self) -> Result<(), Mistake> {
        let mut line = Vec::new();
        self.count_line(&mut line)?;
        self.parse_count(&line)?;
        self.ahead = Some(line);
        Ok(())
    }

    /// Skips the byte order mark that some editors write, and rejects known other formats.
    fn begin(&mut self) -> Result<(), Mistake> {
        const MARK: &[u8] = b"\xef\xbb\xbf";
        let first = self.reader.fill_buf().map_err(Mistake::reading)?;
        if let Some(format) = ForeignFormat::of(first) {
            return Err(Mistake { line: None, column: None, reason: XyzMistakeKind::Format(format) });
        }
        if first.starts_with(MARK) {
            self.reader.consume(MARK.len());
        }
        Ok(())
    }

    fn count(&mut self) -> Result<Option<usize>, Mistake> {
        if self.line == 0 {
            self.begin()?;
        }
        let mut line = self.ahead.take().unwrap_or_default();
        if line.is_empty() {
            self.count_line(&mut line)?;
        }
        self.parse_count(&line)
    }

    /// Reads the next line that is not blank; leaves it empty at the end.
    fn count_line(&mut self, line: &mut Vec<u8>) -> Result<(), Mistake> {
        while line.trim_ascii().is_empty() {
            line.clear();
            if self.append_line(line)? == 0 {
                return Ok(());
            }
        }
        Ok(())
    }

    fn parse_count(&self, line: &[u8]) -> Result<Option<usize>, Mistake> {
        if line.is_empty() {
            return Ok(None);
        }
        let text = utf8(line, self.line)?.trim();
        match text.parse() {
            Ok(found) if found > MOST_PARTICLES => {
                Err(Mistake::in_line(self.line, XyzMistakeKind::TooMany { found }))
            }
            Ok(count) => Ok(Some(count)),
            Err(_) => {
                let found = text.chars().take(60).collect();
                Err(Mistake::in_line(self.line, XyzMistakeKind::Count { found, previous: self.previous }))
            }
        }
    }

    fn append_line(&mut self, text: &mut Vec<u8>) -> Result<usize, Mistake> {
        let mut line = self.reader.by_ref().take(LONGEST_LINE as u64 + 1);
        let bytes = line.read_until(b'\n', text).map_err(Mistake::reading)?;
        self.line += usize::from(bytes > 0);
        if bytes > LONGEST_LINE {
            return Err(Mistake::in_line(self.line, XyzMistakeKind::LongLine { most: LONGEST_LINE }));
        }
        Ok(bytes)
    }
}

fn utf8(bytes: &[u8], line: usize) -> Result<&str, Mistake> {
    std::str::from_utf8(bytes).map_err(|error| {
        let before = String::from_utf8_lossy(&bytes[..error.valid_up_to()]).chars().count();
        Mistake { line: Some(line), column: Some(before + 1), reason: XyzMistakeKind::NotText }
    })
}

/// Frame with the quantities that its rows have.
pub(crate) struct ParsedFrame {
    /// Frame; numbers that its rows lack are 0, and momenta without masses stand for velocities.
    pub(crate) frame: ParticleFrame,
    /// Quantities of the rows.
    pub(crate) columns: FrameColumns,
    /// Line that names the columns.
    pub(crate) line: usize,
}

/// Reads the last frame of a start file, or the one with a number from 0; none beyond the last, with the number of frames.
///
/// # Errors
/// As for [`read`].
pub(crate) fn read_start(
    path: &Path,
    number: Option<u64>,
    is_planar: bool,
) -> Result<Result<ParsedFrame, u64>, XyzReadError> {
    let mut frames = XyzFrames::open(path)?;
    frames.room = FrameContents::Start { is_planar };
    let name = frames.name.clone();
    frames.frame(number).map_err(|mistakes| mistakes.of_file(&name))
}

fn parse(raw: &RawFrame, room: FrameContents) -> Result<ParsedFrame, XyzMistakeList> {
    let header = raw.header(room)?;
    let mut mistakes = XyzMistakeList::default();
    let mut discs = Vec::new();
    let mut lines_of_ids = HashMap::new();
    let (mut fields, mut names) = (Vec::new(), Vec::new());
    let rows = || (raw.line + 2..).zip(raw.text.split(|&byte| byte == b'\n').skip(1).take(raw.count));
    for (line, row) in rows() {
        match utf8(row, line).and_then(|row| header.layout.disc(row, (line, room), (&mut fields, &mut names)))
        {
            Err(mistake) => mistakes.add(mistake),
            Ok(mut disc) => {
                if !header.layout.has_ids() {
                    disc.id = (line - raw.line - 1) as u32;
                }
                let first = *lines_of_ids.entry(disc.id).or_insert(line);
                if first != line {
                    mistakes
                        .add(Mistake::in_line(line, XyzMistakeKind::RepeatedId { id: disc.id, line: first }));
                }
                discs.push(disc);
            }
        }
    }
    let is_plane = match room {
        FrameContents::Plane => discs.iter().all(|disc| disc.position[2] == 0.0),
        FrameContents::Start { is_planar: true } => move_into_plane(&mut discs),
        FrameContents::Space | FrameContents::Start { .. } => true,
    };
    if !is_plane {
        for (line, row) in rows() {
            let row = utf8(row, line).ok();
            mistakes.extend(row.and_then(|row| header.layout.out_of_plane(row, line)));
        }
    }
    // Other programs number from 0.
    let has_raised_ids = lines_of_ids.contains_key(&0);
    if has_raised_ids {
        if let Some(&line) = lines_of_ids.get(&u32::MAX) {
            mistakes.add(Mistake::in_line(line, XyzMistakeKind::LastId));
        }
        discs.iter_mut().for_each(|disc| disc.id = disc.id.saturating_add(1));
    }
    if !mistakes.is_empty() {
        return Err(mistakes);
    }
    let header::CommentHeader { cell, origin, periodic, time, step, seed, layout } = header;
    Ok(ParsedFrame {
        frame: ParticleFrame {
            particles: Particles::new(discs),
            cell,
            origin,
            periodic,
            time,
            step,
            seed,
            has_raised_ids,
        },
        columns: layout.quantities(),
        line: raw.line + 1,
    })
}
