//! Text of an input file, with the location of every byte.

use super::error::{InputError, InputErrors, MistakeKind, MistakeList, Spot, TextLocation};
use crate::io::regular_file;
use std::collections::BTreeSet;
use std::io;
use std::path::Path;
use toml::de::DeTable;

/// Text of an input file.
#[derive(Debug)]
pub struct InputText<'t> {
    /// Name in messages.
    pub file: &'t str,
    /// Whole text.
    pub text: &'t str,
    /// First byte of each line.
    starts: Vec<usize>,
    /// Number of characters before every [`InputText::BLOCK`]th byte.
    before: Vec<usize>,
}

impl<'t> InputText<'t> {
    /// Largest number of bytes counted to locate a byte, however long its line.
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

    /// Number of characters before a byte.
    fn characters(&self, offset: usize) -> usize {
        let text = self.text.as_bytes();
        let block = (offset / Self::BLOCK).min(self.before.len().saturating_sub(1));
        let rest = text.get(block * Self::BLOCK..offset.min(text.len())).unwrap_or_default();
        self.before.get(block).copied().unwrap_or(0) + count_characters(rest)
    }

    /// Location of a byte.
    pub fn location_of_byte(&self, offset: usize) -> TextLocation {
        let line = self.starts.partition_point(|start| *start <= offset);
        let start = self.starts[line.saturating_sub(1)];
        let column = 1 + self.characters(offset) - self.characters(start);
        TextLocation { line: line as u32, column: column as u32 }
    }

    /// Location of a byte with the name of the file.
    pub fn spot(&self, offset: usize) -> Spot {
        Spot { file: self.file.to_owned(), place: Some(self.location_of_byte(offset)) }
    }

    /// Parses the text as TOML.
    ///
    /// # Errors
    /// [`InputErrors`] with every line that is not TOML.
    pub fn table(&self) -> Result<DeTable<'t>, InputErrors> {
        let (table, syntax) = DeTable::parse_recoverable(self.text);
        // One mistake often causes several messages in a line; the first is enough.
        let (mut known, mut errors) = (BTreeSet::new(), MistakeList::default());
        for error in syntax {
            let place = error.span().map(|span| self.location_of_byte(span.start));
            if known.insert(place.map(|place| place.line)) {
                let spot = Spot { file: self.file.to_owned(), place };
                errors.push(spot.error(MistakeKind::Syntax, format!("not TOML: {}", error.message())));
            }
        }
        errors.ok_without_mistakes(self.file)?;
        Ok(table.into_inner())
    }
}

/// Number of characters: continuation bytes of UTF-8 do not count.
fn count_characters(text: &[u8]) -> usize {
    text.iter().filter(|byte| **byte & 0xC0 != 0x80).count()
}

/// Reads an input file of at most `longest` bytes as text.
///
/// # Errors
/// The system's error converted by `unreadable`, or the first line that is not UTF-8.
pub fn read_text(
    path: &Path,
    longest: u64,
    unreadable: impl FnOnce(io::Error) -> InputError,
) -> Result<String, InputErrors> {
    let bytes = regular_file::read(path, longest).map_err(unreadable)?;
    String::from_utf8(bytes).map_err(|cause| {
        let line = regular_file::line_that_is_not_text(cause.as_bytes()).unwrap_or(1);
        let place = Some(TextLocation { line: line as u32, column: 1 });
        let spot = Spot { file: path.display().to_string(), place };
        let error = spot.error(MistakeKind::Syntax, "this line is not UTF-8 text");
        error.expecting("a TOML file in UTF-8").into()
    })
}
