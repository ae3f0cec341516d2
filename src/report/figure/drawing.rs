//! Things where they are: discs, cells, words.

use serde::{Deserialize, Serialize};

/// A drawing in its own coordinates: x to the right, y upwards.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Drawing {
    /// Lower left and upper right corner of what is shown.
    pub window: [[f64; 2]; 2],
    /// Width of the picture (pixels); its height follows from the window.
    pub width: f64,
    /// What is drawn, from back to front. Not kept with a section: the picture is, and nothing more is known of it.
    #[serde(skip)]
    pub shapes: Vec<Shape>,
    /// What the shades mean: lowest and highest value and the quantity with its unit; none where shade means nothing.
    pub shades: Option<(f64, f64, String)>,
    /// What stands below it of places: a bar of a round length, and gravity; none where the coordinates mean nothing.
    #[serde(default)]
    pub guide: Option<Guide>,
}

/// How long things are, and which way they fall.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Guide {
    /// The unit of the drawing's coordinates.
    pub unit: String,
    /// Which way gravity pulls, in the drawing's coordinates; none without it.
    pub gravity: Option<[f64; 2]>,
}

/// Something drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A disc.
    Disc {
        /// Its centre.
        centre: [f64; 2],
        /// Its radius.
        radius: f64,
        /// Its filling.
        tint: Tint,
    },
    /// A box along the axes.
    Rectangle {
        /// Lower left and upper right corner.
        corners: [[f64; 2]; 2],
        /// Its filling.
        tint: Tint,
        /// Whether its outline is drawn.
        outlined: bool,
    },
    /// A straight line.
    Line {
        /// Its ends.
        ends: [[f64; 2]; 2],
    },
    /// Words, centred on a point.
    Text {
        /// Where.
        centre: [f64; 2],
        /// Height of a capital letter, in the drawing's coordinates.
        height: f64,
        /// The words.
        words: String,
    },
}

/// A filling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tint {
    /// None.
    Clear,
    /// A light grey: what does not move.
    Still,
    /// A colour of the palette.
    Hue(usize),
    /// A place between the lowest (0) and the highest shade (1).
    Shade(f64),
}
