//! Lines of words, and the title above a picture.

use super::super::{font, style};
use kuva::render::render::{Primitive, TextAnchor};

/// A line of words in ink.
pub fn line(at: [f64; 2], anchor: TextAnchor, size: f64, words: &str) -> Primitive {
    let [x, y] = at;
    let (content, size) = (words.to_owned(), size.round() as u32);
    Primitive::Text { x, y, content, size, anchor, rotate: None, bold: false, color: None }
}

/// Lines below each other; `top` is the upper edge of the first one's capitals.
pub fn block(lines: &[String], [x, top]: [f64; 2], size: f64) -> impl Iterator<Item = Primitive> {
    let base = move |i: usize| top + size * (font::CAPITAL + i as f64 * style::LINE_SPACING);
    lines.iter().enumerate().map(move |(i, words)| line([x, base(i)], TextAnchor::Start, size, words))
}

/// From the upper edge of the capitals of some lines to where their last letters reach down.
pub fn block_height(lines: &[String], size: f64) -> f64 {
    match lines.len() {
        0 => 0.0,
        count => size * (font::CAPITAL + (count - 1) as f64 * style::LINE_SPACING + font::DESCENT),
    }
}

/// The title of a picture.
pub struct Title {
    lines: Vec<String>,
    zoom: f64,
}

impl Title {
    /// A title on a picture of a width, its letters enlarged.
    pub fn new(words: &str, width: f64, zoom: f64) -> Title {
        Title { lines: font::wrap(words, style::TITLE * zoom, width - 2.0 * style::MARGIN * zoom), zoom }
    }

    /// The width a picture needs for it.
    pub fn width(&self) -> f64 {
        font::widest(&self.lines, style::TITLE * self.zoom) + 2.0 * style::MARGIN * self.zoom
    }

    /// Where what is below it may begin.
    pub fn bottom(&self) -> f64 {
        let height = block_height(&self.lines, style::TITLE * self.zoom);
        self.zoom * style::MARGIN * if self.lines.is_empty() { 1.0 } else { 1.8 } + height
    }

    /// Its lines.
    pub fn primitives(&self) -> impl Iterator<Item = Primitive> {
        let margin = style::MARGIN * self.zoom;
        block(&self.lines, [margin, margin], style::TITLE * self.zoom)
    }
}
