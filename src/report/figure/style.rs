//! The house style: one look for every picture. Series differ by hue, marker and dash at once, so that they stay
//! apart for every kind of colour vision and in grey print.

use std::fmt;

/// A colour: red, green, blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Colour(pub u8, pub u8, pub u8);

impl Colour {
    /// How light it looks, from 0 (black) to 255 (white).
    pub fn lightness(self) -> f64 {
        0.299 * f64::from(self.0) + 0.587 * f64::from(self.1) + 0.114 * f64::from(self.2)
    }
}

impl fmt::Display for Colour {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{:02x}{:02x}{:02x}", self.0, self.1, self.2)
    }
}

/// The paper.
pub const PAPER: Colour = Colour(255, 255, 255);
/// Axes, words and outlines.
pub const INK: Colour = Colour(26, 26, 26);
/// Lines of the grid.
pub const GRID: Colour = Colour(226, 226, 226);
/// Hatching.
pub const HATCHING: Colour = Colour(120, 120, 120);
/// Light grounds, one upon another.
pub const GROUNDS: [Colour; 2] = [Colour(236, 242, 247), Colour(212, 227, 239)];
/// What does not move.
pub const STILL: Colour = Colour(208, 208, 208);

/// The last of the palette.
const BLACK: Colour = Colour(0, 0, 0);

/// What stands on dark paper for colours that were chosen for white.
const DARK: [(Colour, Colour); 8] = [
    (PAPER, Colour(24, 24, 26)),
    (INK, Colour(228, 228, 226)),
    (BLACK, Colour(255, 255, 255)),
    (GRID, Colour(61, 61, 63)),
    (HATCHING, Colour(154, 154, 154)),
    (GROUNDS[0], Colour(32, 38, 44)),
    (GROUNDS[1], Colour(42, 58, 71)),
    (STILL, Colour(84, 84, 86)),
];

/// Rules of a style sheet for dark paper: below elements that `within` selects, or everywhere if it is empty.
pub fn dark_rules(within: &str) -> String {
    let rule = |attribute: &str, (light, dark): &(Colour, Colour)| {
        format!("{within}[{attribute}=\"{light}\"]{{{attribute}:{dark}}}")
    };
    DARK.iter().flat_map(|pair| ["fill", "stroke"].map(|attribute| rule(attribute, pair))).collect()
}

/// Okabe and Ito's colours for every kind of colour vision, those that show best on white first. Their yellow is
/// left out: on white it cannot be seen.
const HUES: [Colour; 7] = [
    Colour(0, 114, 178),
    Colour(213, 94, 0),
    Colour(0, 158, 115),
    Colour(204, 121, 167),
    Colour(230, 159, 0),
    Colour(86, 180, 233),
    BLACK,
];

/// A colour of the palette; beyond its end it begins again.
pub fn hue(index: usize) -> Colour {
    HUES[index % HUES.len()]
}

/// The shape of a marker.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marker {
    /// A circle.
    Disc,
    /// A square.
    Square,
    /// A triangle that points up.
    Triangle,
    /// A square on its corner.
    Diamond,
    /// A diagonal cross.
    Cross,
    /// A triangle that points down.
    Wedge,
    /// An upright cross.
    Plus,
    /// A star with five points.
    Star,
}

/// The marker that goes with a hue. There are more markers than hues, so that beyond the palette's end series still
/// differ.
pub fn marker(hue: usize) -> Marker {
    use Marker::*;
    [Disc, Square, Triangle, Diamond, Cross, Wedge, Plus, Star][hue % 8]
}

/// The dashes of a line that goes with a hue: long ones, the first unbroken.
pub fn line_dash(hue: usize) -> &'static [f64] {
    const LINES: [&[f64]; 5] =
        [&[], &[20.0, 4.0], &[20.0, 4.0, 3.0, 4.0], &[20.0, 4.0, 3.0, 4.0, 3.0, 4.0], &[34.0, 4.0]];
    LINES[hue % LINES.len()]
}

/// The dashes of a dashed line that goes with a hue: short ones.
pub fn short_dash(hue: usize) -> &'static [f64] {
    const DASHES: [&[f64]; 5] =
        [&[8.0, 5.0], &[9.0, 4.0, 2.5, 4.0], &[4.0, 3.5], &[9.0, 4.0, 2.5, 4.0, 2.5, 4.0], &[13.0, 5.0]];
    DASHES[hue % DASHES.len()]
}

/// How many shades there are of one map of colours. Levels from 0 on are those of magnitudes, the next as many those of signed
/// quantities.
pub const SHADES: u8 = 128;

/// Whether shades between these ends show a sign: then 0 is in the middle, and has a colour of its own.
pub fn is_signed([low, high]: [f64; 2]) -> bool {
    low < 0.0 && low == -high
}

/// The levels of a map of colours.
pub fn levels(signed: bool) -> std::ops::RangeInclusive<u8> {
    if signed { SHADES..=2 * (SHADES - 1) + 1 } else { 0..=SHADES - 1 }
}

/// The colour of a level: of a magnitude from dark to bright, of a signed quantity from blue over grey to orange.
pub fn shade(level: u8) -> Colour {
    if level < SHADES { magnitude(level) } else { signed(level - SHADES) }
}

/// Blue for less than 0, orange for more, grey for 0, which is to be seen on white.
fn signed(level: u8) -> Colour {
    between(level, &[[0, 56, 130], [62, 148, 214], [196, 196, 196], [235, 150, 66], [150, 56, 0]])
}

/// Viridis, whose equal steps look equal, in colour and in grey.
fn magnitude(level: u8) -> Colour {
    const STOPS: [[u8; 3]; 17] = [
        [68, 1, 84],
        [72, 24, 106],
        [71, 45, 123],
        [66, 64, 134],
        [59, 82, 139],
        [51, 99, 141],
        [44, 114, 142],
        [38, 130, 142],
        [33, 145, 140],
        [31, 160, 136],
        [40, 174, 128],
        [63, 188, 115],
        [94, 201, 98],
        [132, 212, 75],
        [173, 220, 48],
        [216, 226, 25],
        [253, 231, 37],
    ];
    between(level, &STOPS)
}

fn between(level: u8, stops: &[[u8; 3]]) -> Colour {
    let place = f64::from(level.min(SHADES - 1)) / f64::from(SHADES - 1) * (stops.len() - 1) as f64;
    let below = (place as usize).min(stops.len() - 2);
    let part = place - below as f64;
    let [red, green, blue] = std::array::from_fn(|i| {
        let [low, high] = [stops[below][i], stops[below + 1][i]].map(f64::from);
        (low + part * (high - low)).round() as u8
    });
    Colour(red, green, blue)
}

/// The level of a place between the lowest (0) and the highest (1).
pub fn level(place: f64, signed: bool) -> u8 {
    levels(signed).start() + (place.clamp(0.0, 1.0) * f64::from(SHADES - 1)).round() as u8
}

/// Width of a picture with axes (pixels); it grows when a name in its legend needs more.
pub const WIDTH: f64 = 900.0;
/// Height between the axes' ends (pixels); it grows when the legend needs more.
pub const PLOT_HEIGHT: f64 = 430.0;
/// The least width between the axes' ends (pixels).
pub const PLOT_WIDTH: f64 = 460.0;
/// Blank paper about everything (pixels).
pub const MARGIN: f64 = 16.0;
/// Size of a title's letters (pixels).
pub const TITLE: f64 = 22.0;
/// Size of the letters of an axis' heading (pixels).
pub const HEADING: f64 = 19.0;
/// Size of the letters of numbers and legends (pixels).
pub const LABEL: f64 = 17.0;
/// From one line of words to the next, in sizes of their letters.
pub const LINE_SPACING: f64 = 1.25;
/// Width of a curve (pixels).
pub const CURVE: f64 = 2.4;
/// Width of an axis (pixels).
pub const AXIS: f64 = 1.3;
/// Radius of a marker (pixels).
pub const MARKER: f64 = 5.5;
/// Dots of a PNG to a pixel.
pub const DOTS: f64 = 2.0;

/// Families a viewer of an SVG may take the letters from. Places are reckoned with the first, which is the widest.
pub const FONTS: &str = "DejaVu Sans, Verdana, Arial, Helvetica, sans-serif";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbouring_series_differ_in_everything() {
        for i in 0..HUES.len() {
            for j in 0..i {
                assert_ne!(hue(i), hue(j));
                assert_ne!(marker(i), marker(j));
            }
            assert_ne!(line_dash(i), line_dash(i + 1));
            assert_ne!(short_dash(i), short_dash(i + 1));
            assert!(hue(i).lightness() < 180.0, "{i} cannot be seen on white");
        }
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
    fn signs_are_told_apart_and_zero_is_grey() {
        let [low, middle, high] = [0.0, 0.5, 1.0].map(|place| shade(level(place, true)));
        assert!(low.2 > low.0 + 60 && high.0 > high.2 + 60);
        assert!(middle.0.abs_diff(middle.2) < 12 && middle.lightness() < 215.0, "{middle}");
        assert!(is_signed([-2.0, 2.0]) && !is_signed([-1.0, 2.0]) && !is_signed([0.0, 0.0]));
        assert_eq!(level(1.0, true), *levels(true).end());
    }
}
