//! The text of an input file, with the place of every byte.

use super::error::{InputError, InputErrors, Mistakes, Place, Reason, Spot};
use crate::io::regular_file;
use std::collections::BTreeSet;
use std::io;
use std::path::Path;
use toml::de::DeTable;

/// The text of an input file.
#[derive(Debug)]
pub struct InputText<'t> {
    /// Name that messages give it.
    pub file: &'t str,
    /// The whole text.
    pub text: &'t str,
    /// Bytes at which lines begin.
    starts: Vec<usize>,
    /// Characters before every [`InputText::BLOCK`]th byte.
    before: Vec<usize>,
}

impl<'t> InputText<'t> {
    /// A place is counted from this far at most, however long its line.
    const BLOCK: usize = 1024;

    /// Indexes a text.
    pub fn new(file: &'t str, text: &'t str) -> Self {
        let bytes = text.as_bytes();
        let breaks = bytes.iter().enumerate().filter(|(_, byte)| **byte == b'\n').map(|(at, _)| at + 1);
        let starts = std::iter::once(0).chain(breaks).collect();
        let mut characters = 0;
        let before = bytes.chunks(Self::BLOCK).map(|block| {
            let before = characters;
            characters += count_characters(block);
            before
        });
        InputText { file, text, starts, before: before.collect() }
    }

    /// Characters before a byte.
    fn characters(&self, offset: usize) -> usize {
        let text = self.text.as_bytes();
        let block = (offset / Self::BLOCK).min(self.before.len().saturating_sub(1));
        let rest = text.get(block * Self::BLOCK..offset.min(text.len())).unwrap_or_default();
        self.before.get(block).copied().unwrap_or(0) + count_characters(rest)
    }

    /// The place of a byte.
    pub fn place(&self, offset: usize) -> Place {
        let line = self.starts.partition_point(|start| *start <= offset);
        let start = self.starts[line.saturating_sub(1)];
        let column = 1 + self.characters(offset) - self.characters(start);
        Place { line: line as u32, column: column as u32 }
    }

    /// The same with the name of the file.
    pub fn spot(&self, offset: usize) -> Spot {
        Spot { file: self.file.to_owned(), place: Some(self.place(offset)) }
    }

    /// Its tables and values as TOML.
    ///
    /// # Errors
    /// [`InputErrors`]: every line that is not TOML.
    pub fn table(&self) -> Result<DeTable<'t>, InputErrors> {
        let (table, syntax) = DeTable::parse_recoverable(self.text);
        // One mistake often makes several messages; what else a broken text says is not to be trusted.
        let (mut known, mut errors) = (BTreeSet::new(), Mistakes::default());
        for error in syntax {
            let place = error.span().map(|span| self.place(span.start));
            if known.insert(place.map(|place| place.line)) {
                let spot = Spot { file: self.file.to_owned(), place };
                errors.push(spot.error(Reason::Syntax, format!("not TOML: {}", error.message())));
            }
        }
        errors.none_of(self.file)?;
        Ok(table.into_inner())
    }
}

/// Characters, not bytes: continuation bytes of UTF-8 do not count.
fn count_characters(text: &[u8]) -> usize {
    text.iter().filter(|byte| **byte & 0xC0 != 0x80).count()
}

/// Reads an input file of at most `longest` bytes as text.
///
/// # Errors
/// The error that `unreadable` makes of the system's, or the first line that is not UTF-8.
pub fn read_text(
    path: &Path,
    longest: u64,
    unreadable: impl FnOnce(io::Error) -> InputError,
) -> Result<String, InputErrors> {
    let bytes = regular_file::read(path, longest).map_err(unreadable)?;
    String::from_utf8(bytes).map_err(|cause| {
        let line = regular_file::line_that_is_not_text(cause.as_bytes()).unwrap_or(1);
        let place = Some(Place { line: line as u32, column: 1 });
        let spot = Spot { file: path.display().to_string(), place };
        let error = spot.error(Reason::Syntax, "this line is not UTF-8 text");
        error.expecting("a TOML file in UTF-8").into()
    })
}
