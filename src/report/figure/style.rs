//! Style of all pictures. Series differ in hue, marker and dash, so that they are distinguishable with any colour vision and in grey print.

use super::chart::{Series, Style};
use std::fmt;

/// Colour as `0xrrggbb`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Colour(pub u32);

impl Colour {
    /// Returns the shares of red, green and blue.
    pub(crate) fn channels(self) -> [u8; 3] {
        let [_, channels @ ..] = self.0.to_be_bytes();
        channels
    }

    /// Returns the perceived lightness, from 0 (black) to 255 (white).
    pub(crate) fn lightness(self) -> f64 {
        let [red, green, blue] = self.channels().map(f64::from);
        0.299 * red + 0.587 * green + 0.114 * blue
    }
}

impl fmt::Display for Colour {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{:06x}", self.0)
    }
}

/// Background.
pub(crate) const PAPER: Colour = Colour(0xffffff);
/// Axes, words and outlines.
pub(crate) const INK: Colour = Colour(0x1a1a1a);
/// Lines of the grid.
pub(crate) const GRID: Colour = Colour(0xe2e2e2);
/// Lines that mark a value on an axis.
pub(crate) const MARK: Colour = Colour(0x787878);
/// Overlapping light areas.
pub(crate) const GROUNDS: [Colour; 2] = [Colour(0xecf2f7), Colour(0xd4e3ef)];
/// Fixed parts.
pub(crate) const STILL: Colour = Colour(0xd0d0d0);

/// Pairs of a colour on a white background and its replacement on a dark background.
const DARK: [(Colour, Colour); 8] = [
    (PAPER, Colour(0x18181a)),
    (INK, Colour(0xe4e4e2)),
    (Colour(0x000000), Colour(0xffffff)),
    (GRID, Colour(0x3d3d3f)),
    (MARK, Colour(0x9a9a9a)),
    (GROUNDS[0], Colour(0x20262c)),
    (GROUNDS[1], Colour(0x2a3a47)),
    (STILL, Colour(0x545456)),
];

/// Returns style rules for a dark background, below the elements selected by `within`, or everywhere if it is empty.
pub(crate) fn dark_rules(within: &str) -> String {
    let rule = |attribute: &str, (light, dark): &(Colour, Colour)| {
        format!("{within}[{attribute}=\"{light}\"]{{{attribute}:{dark}}}")
    };
    DARK.iter().flat_map(|pair| ["fill", "stroke"].map(|attribute| rule(attribute, pair))).collect()
}

/// Returns the colour of words on a coloured area. If the area has no replacement on a dark background, neither has the colour.
pub(super) fn ink_on(ground: Colour) -> Colour {
    match ground {
        PAPER | STILL => INK,
        _ if ground.lightness() < 130.0 => Colour(0xfffffe),
        _ => Colour(0x1a1a1b),
    }
}

/// Okabe and Ito's colours for any colour vision, those with the best contrast to white first. Their yellow is omitted, because it is
/// invisible on white.
const HUES: [u32; 7] = [0x0072b2, 0xd55e00, 0x009e73, 0xcc79a7, 0xe69f00, 0x56b4e9, 0x000000];

/// Returns a colour of the palette, which repeats after its end.
pub(crate) fn hue(index: usize) -> Colour {
    Colour(HUES[index % HUES.len()])
}

/// Marker outlines of equal visual size about the origin: disc, square, triangle, diamond, cross, wedge, plus, star. There are more markers
/// than hues, so that series beyond the end of the palette still differ.
pub(super) const MARKERS: [&str; 8] = [
    "M-4.5 0a4.5 4.5 0 1 0 9 0a4.5 4.5 0 1 0 -9 0z",
    "M-4-4h8v8h-8z",
    "M0-5.4l5.1 8.8h-10.2z",
    "M0-5.6l5.6 5.6-5.6 5.6-5.6-5.6z",
    "M-2.6-5.3l2.6 2.7 2.6-2.7 2.7 2.7-2.7 2.6 2.7 2.6-2.7 2.7-2.6-2.7-2.6 2.7-2.7-2.7 2.7-2.6-2.7-2.6z",
    "M0 5.4l-5.1-8.8h10.2z",
    "M-1.9-5.6h3.8v3.7h3.7v3.8h-3.7v3.7h-3.8v-3.7h-3.7v-3.8h3.7z",
    "M0-6.3l1.6 4.1 4.4 .3-3.4 2.8 1.1 4.2-3.7-2.4-3.7 2.4 1.1-4.2-3.4-2.8 4.4-.3z",
];

/// Dash patterns of lines, the first solid, and of dashed lines.
const LONG_DASHES: [&str; 5] = ["", "15 3", "15 3 2.5 3", "15 3 2.5 3 2.5 3", "24 3"];
const SHORT_DASHES: [&str; 5] = ["6 4", "7 3 2 3", "3 2.5", "7 3 2 3 2 3", "10 4"];

/// Look of a series: colour, index of its marker, dashes and gaps of its line (pixels, empty for a solid line), and true for hollow
/// markers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SeriesLook {
    pub(crate) style: Style,
    pub(crate) colour: Colour,
    pub(crate) marker: usize,
    pub(crate) dash: &'static str,
    pub(crate) is_hollow: bool,
}

/// Returns true if points of a style are not joined by a line.
pub(super) fn is_scattered(style: Style) -> bool {
    matches!(style, Style::Points | Style::Marks)
}

/// Returns true if points of a style have markers.
pub(super) fn has_markers(style: Style) -> bool {
    is_scattered(style) || style == Style::Joined
}

/// Returns a distinct look for each series: lines of one hue differ in their dashes; markers of one hue are first filled, then hollow, then
/// of another shape.
pub(super) fn looks(all: &[&Series]) -> Vec<SeriesLook> {
    let look = |(i, series): (usize, &&Series)| {
        let is_alike = |other: &&&Series| {
            other.style == series.style || has_markers(other.style) && has_markers(series.style)
        };
        let twins = all[..i].iter().filter(|other| other.hue == series.hue).filter(|it| is_alike(it)).count();
        let is_same = |other: &&&Series| other.style == series.style && hue(other.hue) == hue(series.hue);
        let before = all[..i].iter().filter(is_same).count();
        let dash = match series.style {
            Style::Line => LONG_DASHES[(series.hue + twins) % 5],
            Style::Dashed => SHORT_DASHES[(series.hue + twins) % 5],
            Style::Joined => LONG_DASHES[before % 5],
            Style::Ribbon => SHORT_DASHES[before % 5],
            Style::Points | Style::Marks => "",
        };
        let marker = (series.hue + twins / 2) % MARKERS.len();
        SeriesLook { style: series.style, colour: hue(series.hue), marker, dash, is_hollow: twins % 2 == 1 }
    };
    all.iter().enumerate().map(look).collect()
}

/// Number of shades of a scale. The first levels are for magnitudes, the next for signed quantities.
pub(crate) const SHADES: u8 = 128;

/// Returns true if shades between these ends show a sign: 0 is in the middle and has a distinct colour.
pub(crate) fn is_signed([low, high]: [f64; 2]) -> bool {
    low < 0.0 && low == -high
}

/// Returns the levels of a scale.
pub(crate) fn levels(signed: bool) -> std::ops::RangeInclusive<u8> {
    if signed { SHADES..=2 * (SHADES - 1) + 1 } else { 0..=SHADES - 1 }
}

/// Viridis, which is perceptually uniform in colour and in grey.
const MAGNITUDE: [u32; 17] = [
    0x440154, 0x48186a, 0x472d7b, 0x424086, 0x3b528b, 0x33638d, 0x2c728e, 0x26828e, 0x21918c, 0x1fa088,
    0x28ae80, 0x3fbc73, 0x5ec962, 0x84d44b, 0xaddc30, 0xd8e219, 0xfde725,
];
/// Blue below 0, orange above; 0 is a grey that is visible on white.
const SIGNED: [u32; 5] = [0x003882, 0x3e94d6, 0xc4c4c4, 0xeb9642, 0x963800];

/// Returns the colour of a level: from dark to bright for magnitudes, from blue over grey to orange for signed quantities.
pub(crate) fn shade(level: u8) -> Colour {
    let (level, stops) = if level < SHADES { (level, &MAGNITUDE[..]) } else { (level - SHADES, &SIGNED[..]) };
    let place = f64::from(level.min(SHADES - 1)) / f64::from(SHADES - 1) * (stops.len() - 1) as f64;
    let below = (place as usize).min(stops.len() - 2);
    let [low, high] = [stops[below], stops[below + 1]].map(|stop| Colour(stop).channels().map(f64::from));
    let part = place - below as f64;
    let channel = |i: usize| (low[i] + part * (high[i] - low[i])).round() as u32;
    Colour(channel(0) << 16 | channel(1) << 8 | channel(2))
}

/// Returns the level of a fraction between the lowest (0) and the highest value (1).
pub(crate) fn level(part: f64, signed: bool) -> u8 {
    levels(signed).start() + (part.clamp(0.0, 1.0) * f64::from(SHADES - 1)).round() as u8
}

/// Width of a picture with axes, and height of a plane (pixels): letters are legible on a screen of 420 pixels.
pub(super) const WIDTH: f64 = 560.0;
pub(super) const PLOT_HEIGHT: f64 = 320.0;
/// Width of a drawing above which its letters and lines scale with it (pixels).
pub(super) const ZOOMED: f64 = 720.0;
/// Blank margin (pixels).
pub(super) const MARGIN: f64 = 14.0;
/// Font sizes of titles and of all other words (pixels), and line spacing in units of the font size.
pub(super) const TITLE: f64 = 18.0;
pub(super) const LABEL: f64 = 15.0;
pub(super) const LINE_SPACING: f64 = 1.25;
/// Line widths of curves, and of axes and outlines (pixels).
pub(super) const CURVE: f64 = 2.0;
pub(super) const LINE: f64 = 1.2;
/// Font families for viewers of an SVG. Widths are those of the first, which is the widest.
pub(super) const FONTS: &str = "DejaVu Sans, Verdana, Arial, Helvetica, sans-serif";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbouring_series_differ_in_everything() {
        for i in 0..HUES.len() {
            for j in 0..i {
                assert_ne!(hue(i), hue(j));
            }
            assert!(!MARKERS[..i].contains(&MARKERS[i]));
            assert_ne!(LONG_DASHES[i % 5], LONG_DASHES[(i + 1) % 5]);
            assert_ne!(SHORT_DASHES[i % 5], SHORT_DASHES[(i + 1) % 5]);
            assert!(hue(i).lightness() < 180.0, "{i} cannot be seen on white");
        }
    }

    fn looks_of(series: impl IntoIterator<Item = (Style, usize)>) -> Vec<SeriesLook> {
        let none: [(f64, f64); 0] = [];
        let all: Vec<Series> =
            series.into_iter().map(|(style, hue)| Series::new("", style, hue, none)).collect();
        looks(&all.iter().collect::<Vec<_>>())
    }

    #[test]
    fn no_two_lines_have_one_colour_and_dash() {
        for style in [Style::Line, Style::Dashed, Style::Joined, Style::Ribbon] {
            let looks = looks_of((0..14).map(|hue| (style, hue)));
            for (i, look) in looks.iter().enumerate() {
                let same =
                    looks[..i].iter().any(|other| (other.colour, other.dash) == (look.colour, look.dash));
                assert!(!same, "{style:?}, series {i}");
            }
        }
    }

    #[test]
    fn series_of_one_hue_differ() {
        let all = [Style::Joined, Style::Points, Style::Points, Style::Line, Style::Line, Style::Dashed];
        let looks = looks_of(all.map(|style| (style, 3)));
        for (i, look) in looks.iter().enumerate() {
            assert!(looks[..i].iter().all(|other| other != look), "{look:?}");
        }
        assert_eq!((looks[1].marker, looks[1].is_hollow), (looks[0].marker, true));
    }

    #[test]
    fn shades_grow_lighter() {
        for i in 1..SHADES {
            assert!(shade(i).lightness() > shade(i - 1).lightness(), "{i}");
        }
        let levels = [-1.0, 0.0, 1.0, 7.0].map(|place| level(place, false));
        assert_eq!(levels, [0, 0, SHADES - 1, SHADES - 1]);
    }

    #[test]
    fn signs_are_distinguishable_and_zero_is_grey() {
        let [low, middle, high] = [0.0, 0.5, 1.0].map(|place| shade(level(place, true)));
        let ([low_red, _, low_blue], [high_red, _, high_blue]) = (low.channels(), high.channels());
        assert!(low_blue > low_red + 60 && high_red > high_blue + 60);
        let [red, _, blue] = middle.channels();
        assert!(red.abs_diff(blue) < 12 && middle.lightness() < 215.0, "{middle}");
        assert!(is_signed([-2.0, 2.0]) && !is_signed([-1.0, 2.0]) && !is_signed([0.0, 0.0]));
        assert_eq!(level(1.0, true), *levels(true).end());
    }
}
