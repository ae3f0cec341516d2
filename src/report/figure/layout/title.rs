//! Words in several lines, and the title above a picture.

use super::super::sheet::{Anchor, Mark, Place};
use super::super::{font, style};

/// A single line of words in ink.
pub fn words(at: Place, anchor: Anchor, size: f64, words: &str) -> Mark {
    Mark::Words { at, anchor, upwards: false, size, colour: style::INK, words: words.to_owned() }
}

/// Lines below each other; `top` is the upper edge of the first one's capitals.
pub fn block(lines: &[String], x: f64, top: f64, anchor: Anchor, size: f64) -> Vec<Mark> {
    let base = |i: usize| top + size * (font::CAPITAL + i as f64 * style::LINE_SPACING);
    lines.iter().enumerate().map(|(i, line)| words([x, base(i)], anchor, size, line)).collect()
}

/// From the upper edge of the capitals of some lines to where their last letters reach down.
pub fn block_height(lines: &[String], size: f64) -> f64 {
    match lines.len() {
        0 => 0.0,
        count => size * (font::CAPITAL + (count - 1) as f64 * style::LINE_SPACING + font::DESCENT),
    }
}

/// The title of a sheet.
pub struct Title {
    lines: Vec<String>,
    zoom: f64,
}

impl Title {
    /// A title on a sheet of a width.
    pub fn new(words: &str, width: f64, zoom: f64) -> Title {
        Title { lines: font::wrap(words, style::TITLE * zoom, width - 2.0 * style::MARGIN * zoom), zoom }
    }

    /// The width a sheet needs for it.
    pub fn width(&self) -> f64 {
        font::widest(&self.lines, style::TITLE * self.zoom) + 2.0 * style::MARGIN * self.zoom
    }

    /// Where what is below it may begin.
    pub fn bottom(&self) -> f64 {
        let height = block_height(&self.lines, style::TITLE * self.zoom);
        self.zoom * style::MARGIN * if self.lines.is_empty() { 1.0 } else { 1.8 } + height
    }

    /// The title as marks.
    pub fn marks(&self) -> Vec<Mark> {
        let margin = style::MARGIN * self.zoom;
        block(&self.lines, margin, margin, Anchor::Start, style::TITLE * self.zoom)
    }
}
