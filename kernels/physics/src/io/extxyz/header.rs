//! Comment line of a frame: `key=value` pairs, and the columns named by `Properties`.

use super::FrameContents;
use super::error::{Mistake, XyzMistakeKind, XyzMistakeList};
use super::format::ForeignFormat;
use super::rows::XyzRowLayout;
use crate::io::numbers::number;

/// Content of a comment line.
pub(super) struct CommentHeader {
    pub(super) cell: [f64; 2],
    pub(super) origin: [f64; 2],
    pub(super) periodic: Option<[bool; 2]>,
    pub(super) time: f64,
    pub(super) step: u64,
    pub(super) seed: Option<u64>,
    pub(super) layout: XyzRowLayout,
}

/// Key and value, with the byte offset of the key.
struct HeaderEntry {
    key: String,
    value: String,
    byte: usize,
}

impl HeaderEntry {
    fn wrong(&self, key: &'static str, expected: &'static str) -> XyzMistakeKind {
        XyzMistakeKind::Value { key, found: self.value.clone(), expected }
    }

    /// Numbers in any of the brackets in use.
    fn numbers(&self, key: &'static str, expected: &'static str) -> Result<Vec<f64>, XyzMistakeKind> {
        let parsed: Option<Vec<f64>> =
            self.words().map(|word| number(word).filter(|number| number.is_finite())).collect();
        parsed.ok_or_else(|| self.wrong(key, expected))
    }

    fn words(&self) -> impl Iterator<Item = &str> {
        self.value.split(|c: char| c.is_whitespace() || ",[]{}()".contains(c)).filter(|word| !word.is_empty())
    }
}

/// Parses a comment line; reports every wrong key.
pub(super) fn parse(text: &str, line: usize, room: FrameContents) -> Result<CommentHeader, XyzMistakeList> {
    let mut mistakes = XyzMistakeList::default();
    let is_plain = room.may_lack() && !text.contains('=');
    let entries = match is_plain {
        true => vec![],
        false => entries(text).map_err(|(byte, reason)| Mistake::at(line, text, byte, reason))?,
    };
    if let Some(format) = ForeignFormat::of_comment(text).filter(|_| !is_plain) {
        return Err(Mistake::in_line(line, XyzMistakeKind::Format(format)).into());
    }
    // Locating a column takes time in proportion to the line, so it is done only for mistakes that are listed.
    let mut keep = |entry: &HeaderEntry, reason| match mistakes.has_room() {
        true => mistakes.add(Mistake::at(line, text, entry.byte, reason)),
        false => mistakes.count(),
    };
    let mut known: [Option<&HeaderEntry>; KEYS.len()] = [None; KEYS.len()];
    for entry in &entries {
        let Some(key) = KEYS.iter().position(|key| *key == entry.key) else { continue };
        match known[key] {
            None => known[key] = Some(entry),
            Some(_) => keep(entry, XyzMistakeKind::RepeatedKey(entry.key.clone())),
        }
    }
    let find = |key: &str| known.iter().copied().flatten().find(|entry| entry.key == key);

    let mut missing = Vec::new();
    let mut cell = [0.0; 2];
    match find("lattice") {
        None if room != FrameContents::Plane => cell = [f64::INFINITY; 2],
        None => missing.push(XyzMistakeKind::MissingKey { key: "Lattice", expected: LATTICE }),
        Some(entry) => match lattice(entry) {
            Ok(sides) => cell = sides,
            Err(reason) => keep(entry, reason),
        },
    }
    let mut layout = None;
    match find("properties") {
        None if room.may_lack() => layout = Some(XyzRowLayout::plain()),
        None => missing.push(XyzMistakeKind::MissingKey { key: "Properties", expected: PROPERTIES }),
        Some(entry) => match XyzRowLayout::parse(&entry.value, room) {
            Ok(found) => layout = Some(found),
            Err(reasons) => reasons.into_iter().for_each(|reason| keep(entry, reason)),
        },
    }
    let mut origin = [0.0; 2];
    if let Some(entry) = find("origin") {
        match entry.numbers("Origin", ORIGIN).as_deref() {
            Ok(&[x, y, _]) => origin = [x, y],
            _ => keep(entry, entry.wrong("Origin", ORIGIN)),
        }
    }
    let mut periodic = None;
    if let Some(entry) = find("pbc") {
        match boundaries(entry) {
            Some(axes) => periodic = Some(axes),
            None => keep(entry, entry.wrong("pbc", BOUNDARIES)),
        }
    }
    let mut time = 0.0;
    if let Some(entry) = find("time") {
        match entry.numbers("Time", "a finite number").as_deref() {
            Ok(&[number]) => time = number,
            _ => keep(entry, entry.wrong("Time", "a finite number")),
        }
    }
    let mut whole = |key, label| {
        let entry = find(key)?;
        let number = entry.value.trim().parse::<u64>();
        if number.is_err() {
            keep(entry, entry.wrong(label, "a whole number from 0"));
        }
        number.ok()
    };
    let step = whole("step", "step").unwrap_or(0);
    let seed = whole("seed", "seed");
    missing.into_iter().for_each(|reason| mistakes.add(Mistake::in_line(line, reason)));
    match layout {
        Some(layout) if mistakes.is_empty() => {
            Ok(CommentHeader { cell, origin, periodic, time, step, seed, layout })
        }
        _ => Err(mistakes),
    }
}

const KEYS: [&str; 7] = ["lattice", "properties", "origin", "pbc", "time", "step", "seed"];
const LATTICE: &str = "\"Lx 0 0 0 Ly 0 0 0 Lz\" with positive sides";
pub(super) const PROPERTIES: &str = super::PROPERTIES;
const ORIGIN: &str = "\"x y z\"";
const BOUNDARIES: &str = "\"T F F\" (or \"T F\"), T where the box is periodic along x, y, z";

/// Largest tilt of a box due to rounding, relative to its shortest side: programs compute rectangles from angles of 90°.
const ROUNDING: f64 = 1e-12;

/// Sides of a rectangular box.
fn lattice(entry: &HeaderEntry) -> Result<[f64; 2], XyzMistakeKind> {
    let numbers = entry.numbers("Lattice", LATTICE)?;
    let [x, _, _, _, y, _, _, _, depth] = numbers[..] else { return Err(entry.wrong("Lattice", LATTICE)) };
    if !(x > 0.0 && y > 0.0) {
        return Err(entry.wrong("Lattice", LATTICE));
    }
    let off_diagonal = [1, 2, 3, 5, 6, 7];
    let rounding = ROUNDING * x.min(y).min(if depth > 0.0 { depth } else { f64::INFINITY });
    match off_diagonal.into_iter().find(|&at| numbers[at].abs() > rounding) {
        None => Ok([x, y]),
        Some(at) => Err(XyzMistakeKind::Tilt { at: at + 1, value: numbers[at] }),
    }
}

fn boundaries(entry: &HeaderEntry) -> Option<[bool; 2]> {
    let axes: Option<Vec<bool>> = entry
        .words()
        .map(|word| match word.to_ascii_lowercase().as_str() {
            "t" | "true" | "1" => Some(true),
            "f" | "false" | "0" => Some(false),
            _ => None,
        })
        .collect();
    match axes?[..] {
        [x, y] | [x, y, _] => Some([x, y]),
        _ => None,
    }
}

/// Splits a comment line into entries with keys in lower case; a key without a value has an empty one.
fn entries(text: &str) -> Result<Vec<HeaderEntry>, (usize, XyzMistakeKind)> {
    let mut rest = CommentCursor { text, byte: 0 };
    let mut entries = Vec::new();
    loop {
        rest.skip_blanks();
        let byte = rest.byte;
        if rest.peek().is_none() {
            return Ok(entries);
        }
        let key = rest.word(true)?.to_lowercase();
        rest.skip_blanks();
        let value = if rest.peek() == Some('=') {
            rest.next();
            rest.skip_blanks();
            rest.word(false)?
        } else {
            String::new()
        };
        entries.push(HeaderEntry { key, value, byte });
    }
}

struct CommentCursor<'a> {
    text: &'a str,
    byte: usize,
}

impl CommentCursor<'_> {
    fn peek(&self) -> Option<char> {
        self.text[self.byte..].chars().next()
    }

    fn next(&mut self) -> Option<char> {
        let c = self.peek()?;
        self.byte += c.len_utf8();
        Some(c)
    }

    fn skip_blanks(&mut self) {
        while self.peek().is_some_and(char::is_whitespace) {
            self.next();
        }
    }

    /// Reads a word in quotes or brackets, which are removed, or up to the next blank; a key also ends at `=`.
    fn word(&mut self, key: bool) -> Result<String, (usize, XyzMistakeKind)> {
        let start = self.byte;
        let mut word = String::new();
        let closing = match self.peek() {
            Some(quote @ ('"' | '\'')) => Some((quote, quote)),
            Some('[') => Some(('[', ']')),
            Some('{') => Some(('{', '}')),
            _ => None,
        };
        let Some((open, close)) = closing else {
            while let Some(c) = self.peek().filter(|&c| !(c.is_whitespace() || key && c == '=')) {
                word.push(c);
                self.next();
            }
            return Ok(word);
        };
        self.next();
        let mut depth = 1;
        while let Some(c) = self.next() {
            match c {
                '\\' if open == close => word.extend(self.next()),
                _ if c == close => {
                    depth -= 1;
                    if depth == 0 {
                        return Ok(word);
                    }
                    word.push(c);
                }
                _ => {
                    depth += usize::from(c == open);
                    word.push(c);
                }
            }
        }
        Err((start, XyzMistakeKind::Unclosed(open)))
    }
}
