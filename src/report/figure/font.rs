//! How wide words are in the pictures' font.

use skrifa::prelude::{FontRef, LocationRef, Size};
use skrifa::{GlyphId, MetadataProvider};
use std::sync::LazyLock;

/// Height of a capital letter, in sizes of the letters.
pub const CAPITAL: f64 = 0.729;
/// How far letters reach below their line, in sizes of the letters.
pub const DESCENT: f64 = 0.24;

static FACE: LazyLock<FontRef<'static>> =
    LazyLock::new(|| FontRef::new(dejavu::sans::regular()).expect("the font in the program is whole"));
/// Units of the font in the size of its letters.
static UNITS: LazyLock<f64> =
    LazyLock::new(|| FACE.metrics(Size::unscaled(), LocationRef::default()).units_per_em.into());

/// Width of words in one line.
pub fn width(words: &str, size: f64) -> f64 {
    let units: f64 = words.chars().map(advance).sum();
    units * size / *UNITS
}

/// Width of the widest of some lines.
pub fn widest<'a>(lines: impl IntoIterator<Item = &'a String>, size: f64) -> f64 {
    lines.into_iter().map(|line| width(line, size)).fold(0.0, f64::max)
}

/// Cuts words into lines that are no wider than a width; a single word may be. A no-break space is within a word.
pub fn wrap(words: &str, size: f64, most: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    let words = words.split(|c: char| c.is_whitespace() && c != '\u{a0}').filter(|word| !word.is_empty());
    for word in words {
        match lines.last_mut() {
            Some(line) if width(&format!("{line} {word}"), size) <= most => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

fn advance(letter: char) -> f64 {
    let glyph = FACE.charmap().map(letter).unwrap_or(GlyphId::NOTDEF);
    let metrics = FACE.glyph_metrics(Size::unscaled(), LocationRef::default());
    metrics.advance_width(glyph).map_or(0.0, f64::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_font_has_the_letters_of_physics() {
        for letter in "⁰¹²³⁴⁵⁶⁷⁸⁹⁻−×·νρωπμφτ°±≤≥√∞".chars() {
            assert!(FACE.charmap().map(letter).is_some(), "{letter}");
        }
        let metrics = FACE.glyph_metrics(Size::unscaled(), LocationRef::default());
        let capital = metrics.bounds(FACE.charmap().map('H').unwrap()).unwrap().y_max;
        assert!((f64::from(capital) / *UNITS - CAPITAL).abs() < 1e-3);
    }

    #[test]
    fn lines_break_at_blanks() {
        let words = "measured on the host, chained, 24 places";
        for most in [90.0, 150.0, 300.0] {
            let lines = wrap(words, 17.0, most);
            assert_eq!(lines.join(" "), words);
            assert!(widest(&lines, 17.0) <= most, "{lines:?}");
        }
        assert_eq!(wrap("incompressible", 17.0, 10.0), ["incompressible"]);
        assert_eq!(wrap("", 17.0, 10.0), Vec::<String>::new());
    }
}
