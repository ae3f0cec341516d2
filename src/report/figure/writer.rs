//! Compact and reproducible SVG text of a picture. Lines of one look share a path, words of one look share a group, and numbers are rounded to
//! the visible precision.
//!
//! A `<title>` names each series, band and cell. The plane between the axes describes its axes in `data-x` and `data-y`, from which a script
//! reads values.

#![expect(clippy::let_underscore_must_use, reason = "a string takes whatever is written")]

use super::picture::Figure;
use super::{font, style};
use std::collections::BTreeSet;
use std::fmt::{Display, Write};

/// Maximum distance from the corner (pixels), since some viewers use small number types.
const FARTHEST: f64 = 1e6;
/// Smallest visible bend of a line (pixels).
const SEEN: f64 = 0.05;

/// Attributes of words centred at their position, or ending there.
pub(crate) const MIDDLE: &str = " text-anchor=\"middle\"";
pub(crate) const END: &str = " text-anchor=\"end\"";

/// Unfinished picture.
pub(crate) struct Svg {
    /// Width and height (pixels).
    pub size: [f64; 2],
    definitions: BTreeSet<String>,
    body: String,
    /// Look of the open group of words, empty without one.
    lettering: String,
}

impl Svg {
    /// Begins a picture of a width with a title, with letters enlarged by `zoom`. The height is initially that of the title.
    pub(super) fn new(title: &str, width: f64, zoom: f64) -> Svg {
        let (size, margin) = (style::TITLE * zoom, style::MARGIN * zoom);
        let lines = font::wrap(title, size, width - 2.0 * margin);
        let width = width.max(font::widest(&lines, size) + 2.0 * margin);
        let height =
            margin + if lines.is_empty() { 0.0 } else { font::height(lines.len(), size) + 0.5 * margin };
        let (definitions, body, lettering) = (BTreeSet::new(), String::new(), String::new());
        let mut svg = Svg { size: [width, height], definitions, body, lettering };
        svg.block(&lines, [margin, margin], size, "");
        svg
    }

    /// Adds an element, or the start or the end of a group.
    pub(super) fn add(&mut self, element: impl Display) {
        let end = if self.lettering.is_empty() { "" } else { "</g>\n" };
        let _ = writeln!(self.body, "{end}{element}");
        self.lettering.clear();
    }

    /// Adds a path with attributes.
    pub(super) fn path(&mut self, look: &str, d: &str) {
        self.add(format_args!("<path{look} d=\"{d}\"/>"));
    }

    /// Begins a window that clips its contents.
    pub(crate) fn window(&mut self, corner: [f64; 2], size: [f64; 2]) {
        let view = [corner, size].map(|it| it.map(tenths).join(" ")).join(" ");
        self.add(format_args!("<svg{} viewBox=\"{view}\">", box_attributes(corner, size)));
    }

    /// Adds a definition, whose name is the same in every picture.
    pub(crate) fn define(&mut self, definition: String) {
        self.definitions.insert(definition);
    }

    /// Adds elements with a name, shown when the reader points at them.
    pub(crate) fn named(&mut self, name: &str, add: impl FnOnce(&mut Svg)) {
        self.add(format_args!("<g><title>{}</title>", escaped(name)));
        add(self);
        self.add("</g>");
    }

    /// Adds a line of words at a position of its base line. `look` are further attributes.
    pub(super) fn words(&mut self, at: [f64; 2], size: f64, look: &str, words: &str) {
        self.turned(at, 0, size, look, words);
    }

    /// Adds a line of words rotated about its position (degrees).
    pub(crate) fn turned(&mut self, at: [f64; 2], angle: i32, size: f64, look: &str, words: &str) {
        let look = format!(" font-size=\"{}\"{look}", tenths(size));
        if look != self.lettering {
            self.add(format_args!("<g{look}>"));
            self.lettering = look;
        }
        let [x, y] = at.map(tenths);
        let turned =
            if angle == 0 { String::new() } else { format!(" transform=\"rotate({angle} {x} {y})\"") };
        let _ = writeln!(self.body, "<text x=\"{x}\" y=\"{y}\"{turned}>{}</text>", escaped(words));
    }

    /// Adds consecutive lines; `top` is the upper edge of the first line's capitals. Returns the lower edge of the last line.
    pub(crate) fn block(&mut self, lines: &[String], [x, top]: [f64; 2], size: f64, look: &str) -> f64 {
        for (i, line) in lines.iter().enumerate() {
            let base = top + size * (font::CAPITAL + i as f64 * style::LINE_SPACING);
            self.words([x, base], size, look, line);
        }
        top + font::height(lines.len(), size)
    }

    /// Returns the SVG text of a figure.
    pub(super) fn finish(mut self, figure: &Figure) -> String {
        if !self.lettering.is_empty() {
            self.body.push_str("</g>\n");
        }
        let [width, height] = self.size.map(f64::ceil);
        let [title, caption] = [&figure.title, &figure.caption].map(|words| escaped(words));
        let (fonts, ink, paper, dark) = (style::FONTS, style::INK, style::PAPER, style::dark_rules(""));
        let mut definitions = self.definitions.into_iter().collect::<Vec<_>>().join("\n");
        if !definitions.is_empty() {
            definitions = format!("<defs>\n{definitions}\n</defs>\n");
        }
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
             role=\"img\" font-family=\"{fonts}\" fill=\"{ink}\" stroke-linejoin=\"round\">\n\
             <style>@media (prefers-color-scheme:dark){{{dark}}}</style>\n<title>{title}</title>\n<desc>{caption}</desc>\n\
             {definitions}<rect width=\"{width}\" height=\"{height}\" fill=\"{paper}\"/>\n{}</svg>\n",
            self.body
        )
    }
}

/// Returns the stroke attributes of a line.
pub(crate) fn stroke(colour: style::Colour, width: f64) -> String {
    let width = if width == 1.0 { String::new() } else { format!(" stroke-width=\"{}\"", tenths(width)) };
    format!(" stroke=\"{colour}\"{width}")
}

/// Returns the attributes of a box: left and upper edge, width and height.
pub(crate) fn box_attributes(corner: [f64; 2], size: [f64; 2]) -> String {
    let ([x, y], [width, height]) = (corner.map(tenths), size.map(tenths));
    format!(" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"")
}

/// Escapes the special characters of XML; characters that XML does not allow become blanks.
pub(crate) fn escaped(words: &str) -> String {
    let is_barred = |letter: char| letter.is_control() || ['\u{fffe}', '\u{ffff}'].contains(&letter);
    let words = words.replace(is_barred, " ").replace('&', "&amp;");
    words.replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Formats a length to a tenth of a pixel.
pub(crate) fn tenths(pixels: f64) -> String {
    hundredths((pixels * 10.0).round() as i64 * 10)
}

/// Formats a number of hundredths without unnecessary zeros.
fn hundredths(number: i64) -> String {
    let text = format!("{:.2}", number as f64 / 100.0);
    let text = text.trim_end_matches('0').trim_end_matches('.');
    match (text.strip_prefix("0."), text.strip_prefix("-0.")) {
        (Some(part), _) => format!(".{part}"),
        (_, Some(part)) => format!("-.{part}"),
        _ => text.to_owned(),
    }
}

/// Returns a path through positions to a hundredth of a pixel, from which a script of the page reads values. A single position is a line of
/// length 0, because viewers need a line to draw a marker.
pub(crate) fn path_data(places: &[[f64; 2]]) -> String {
    let whole = |pixels: f64| (pixels.clamp(-FARTHEST, FARTHEST) * 100.0).round() as i64;
    let mut path = String::new();
    let mut before = [0; 2];
    for (i, place) in places.iter().enumerate() {
        let here = place.map(whole);
        let [right, down] = [0, 1].map(|side| hundredths(here[side] - before[side]));
        // After the first position, steps are relative.
        path.push_str(["M", "l", " "][i.min(2)]);
        let between = if down.starts_with('-') { "" } else { " " };
        let _ = write!(path, "{right}{between}{down}");
        before = here;
    }
    if places.len() == 1 {
        path.push_str("l0 0");
    }
    path
}

/// Removes the positions of a line that its straight segments pass within [`SEEN`].
pub(crate) fn simplified_line(places: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let [first, .., last] = places else { return places.to_vec() };
    let [right, down] = [last[0] - first[0], last[1] - first[1]];
    let length = right.hypot(down);
    // Distance of a position from the segment between the ends, or from one end if they coincide.
    let off = |[x, y]: [f64; 2]| {
        let [x, y] = [x - first[0], y - first[1]];
        if length > 0.0 { (right * y - down * x).abs() / length } else { x.hypot(y) }
    };
    let within = &places[1..places.len() - 1];
    let farthest = (1..).zip(within).max_by(|a, b| off(*a.1).total_cmp(&off(*b.1)));
    match farthest {
        Some((at, &place)) if off(place) > SEEN || off(place).is_nan() => {
            let mut all = simplified_line(&places[..=at]);
            all.pop();
            all.extend(simplified_line(&places[at..]));
            all
        }
        _ => vec![*first, *last],
    }
}

#[cfg(test)]
mod tests {
    use super::super::svg;
    use super::super::tests::samples;
    use super::*;

    #[test]
    fn the_same_figure_gives_the_same_bytes() {
        for figure in samples::all() {
            assert_eq!(svg(&figure).unwrap(), svg(&figure.clone()).unwrap());
        }
    }

    #[test]
    fn words_are_escaped() {
        let mut figure = samples::linear();
        figure.title = "</text><script>1 & 2\u{1}".into();
        let text = svg(&figure).unwrap();
        assert!(!text.contains("<script>") && text.contains("&lt;script&gt;1 &amp; 2"));
    }

    #[test]
    fn numbers_are_short() {
        let written = [50.120000000000005, 0.0, -0.26, 500.0, 0.04].map(tenths);
        assert_eq!(written, ["50.1", "0", "-.3", "500", "0"]);
    }

    #[test]
    fn simplified_lines_keep_their_bends() {
        let straight: Vec<[f64; 2]> = (0..9).map(|i| [f64::from(i), 2.0 * f64::from(i)]).collect();
        assert_eq!(simplified_line(&straight), [[0.0, 0.0], [8.0, 16.0]]);
        let bent = [&straight[..], &[[9.0, 0.0], [10.0, -16.0]]].concat();
        assert_eq!(simplified_line(&bent), [[0.0, 0.0], [8.0, 16.0], [10.0, -16.0]]);
        assert_eq!(simplified_line(&[[1.0, 1.0], [5.0, 5.0], [1.0, 1.0]]).len(), 3);
    }

    #[test]
    fn paths_use_relative_steps() {
        assert_eq!(path_data(&[[1.0, 2.0], [1.5, 1.0], [3.004, 1.25]]), "M1 2l.5-1 1.5 .25");
        assert_eq!(path_data(&[[1.0, 2.0]]), "M1 2l0 0");
        assert!(path_data(&[[1e300, 0.0]]).starts_with("M1000000 0"));
    }
}
