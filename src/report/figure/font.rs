//! Widths of words in the font of the pictures, DejaVu Sans.

use super::style;

/// Height of a capital letter, in units of the font size.
pub(crate) const CAPITAL: f64 = 0.729;
/// Depth of letters below the base line, in units of the font size.
pub(crate) const DESCENT: f64 = 0.24;

/// Letters by width in hundredths of the font size, rounded up to the next class. Any other letter counts as [`WIDEST`].
const WIDTHS: [(u32, &str); 10] = [
    (32, "'ijlíîïIJ ,.·′ \u{a0}"),
    (40, "/:;\\|-ftι()[]!¹²³⁰⁴⁵⁶⁷⁸⁹₀₁₂₃₄₅₆₇₈₉⟨⟩⌊⌋⌈⌉″"),
    (53, "r\"*_°–‖`sz⁻∫∂"),
    (56, "?cçLΓξνζέε"),
    (62, "FkvxyTYPoγλχκςπτδθöóòôø“”"),
    (64, "aàáâäåeèéêëSEßhnuùúûüñbdgpqµμρσηβ0123456789$√{}"),
    (70, "KAVXZBRCΔΛΑΒΕΣφψα∇ÄÅÇ"),
    (79, "UNHDGOQΩΝΠΘΦΨ&ÖÜ∝"),
    (87, "Mw+<=>#^~±×−≤≥←→∞ω"),
    (100, "%mW@—…½¼⅖æÆ©®"),
];
const WIDEST: u32 = 110;

/// Returns an upper bound of the width of words in one line.
pub(crate) fn width(words: &str, size: f64) -> f64 {
    let letter = |letter: char| WIDTHS.iter().find(|it| it.1.contains(letter)).map_or(WIDEST, |it| it.0);
    f64::from(words.chars().map(letter).sum::<u32>()) * size / 100.0
}

/// Returns the width of the widest of some lines.
pub(crate) fn widest<'a>(lines: impl IntoIterator<Item = &'a String>, size: f64) -> f64 {
    lines.into_iter().map(|line| width(line, size)).fold(0.0, f64::max)
}

/// Returns the height of a number of lines, from the capitals of the first line to the descenders of the last.
pub(crate) fn height(lines: usize, size: f64) -> f64 {
    let lines = lines as f64;
    if lines == 0.0 { 0.0 } else { size * (CAPITAL + (lines - 1.0) * style::LINE_SPACING + DESCENT) }
}

/// Wraps words into lines of at most a width; a single word may be wider. A no-break space does not separate words.
pub(crate) fn wrap(words: &str, size: f64, most: f64) -> Vec<String> {
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

#[cfg(test)]
mod tests {
    use super::super::output::tree;
    use super::*;
    use resvg::usvg::Node;

    #[test]
    fn widths_are_close_upper_bounds() {
        let letters =
            WIDTHS.iter().flat_map(|(_, letters)| letters.chars()).chain(['ŋ', 'Œ', 'j', '数', '✓']);
        for letter in letters {
            // Trailing blanks have no width in a picture.
            let text = format!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" font-family=\"DejaVu Sans\" font-size=\"1000\">\
                 <text>|{}|</text></svg>",
                super::super::writer::escaped(&letter.to_string())
            );
            let tree = tree(&text).unwrap();
            let [Node::Text(text)] = tree.root().children() else { panic!("{letter}") };
            let true_width = f64::from(text.bounding_box().width()) / 1000.0 - 2.0 * 0.337;
            let reckoned = width(&letter.to_string(), 1.0);
            assert!(reckoned >= true_width - 0.002, "{letter}: {reckoned} instead of {true_width}");
            let is_known = WIDTHS.iter().any(|(_, letters)| letters.contains(letter));
            assert!(
                !is_known || reckoned < true_width + 0.12,
                "{letter}: {reckoned} instead of {true_width}"
            );
        }
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
