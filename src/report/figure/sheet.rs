//! A sheet of paper: marks in pixels from its upper left corner, before it is known who paints them.

use super::style::Colour;

/// A place on the sheet.
pub type Place = [f64; 2];

/// A sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
    /// From back to front.
    pub marks: Vec<Mark>,
}

/// A box along the sheet's edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// Its left edge.
    pub left: f64,
    /// Its upper edge.
    pub top: f64,
    /// Its width.
    pub width: f64,
    /// Its height.
    pub height: f64,
}

impl Area {
    /// Its right edge.
    pub fn right(&self) -> f64 {
        self.left + self.width
    }

    /// Its lower edge.
    pub fn bottom(&self) -> f64 {
        self.top + self.height
    }

    /// Its outline.
    pub fn corners(&self) -> Vec<Place> {
        let (left, top, right, bottom) = (self.left, self.top, self.right(), self.bottom());
        vec![[left, top], [right, top], [right, bottom], [left, bottom]]
    }

    /// The same with a rim.
    pub fn grown(&self, rim: f64) -> Area {
        Area {
            left: self.left - rim,
            top: self.top - rim,
            width: self.width + 2.0 * rim,
            height: self.height + 2.0 * rim,
        }
    }

    /// Whether a place is in it, or on its edge.
    pub fn contains(&self, [x, y]: Place) -> bool {
        (self.left..=self.right()).contains(&x) && (self.top..=self.bottom()).contains(&y)
    }
}

/// What is painted.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// Straight lines from place to place.
    Lines {
        /// Each a line without a gap.
        pieces: Vec<Vec<Place>>,
        /// Whether the last place of each is joined to its first.
        closed: bool,
        /// How they are painted.
        paint: Paint,
    },
    /// A disc.
    Disc {
        /// Its centre.
        centre: Place,
        /// Its radius.
        radius: f64,
        /// How it is painted.
        paint: Paint,
    },
    /// Words in one line.
    Words {
        /// Where, on the line they stand on.
        at: Place,
        /// What of them is there.
        anchor: Anchor,
        /// Whether they run upwards.
        upwards: bool,
        /// Size of the letters.
        size: f64,
        /// Their colour.
        colour: Colour,
        /// The words.
        words: String,
    },
    /// A grid of shades without seams.
    Cells {
        /// The grid's outline.
        area: Area,
        /// How many columns it has.
        columns: usize,
        /// Levels of [`super::style::shade`], row by row from the top.
        levels: Vec<u8>,
    },
    /// Marks seen through a window: what is outside of it is cut off.
    Window {
        /// The window.
        area: Area,
        /// The marks.
        marks: Vec<Mark>,
    },
}

/// Filling and outline.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Paint {
    /// The filling.
    pub fill: Option<Colour>,
    /// The outline.
    pub stroke: Option<Stroke>,
}

impl Paint {
    /// A filling alone.
    pub fn fill(colour: Colour) -> Paint {
        Paint { fill: Some(colour), stroke: None }
    }

    /// An unbroken line alone.
    pub fn stroke(colour: Colour, width: f64) -> Paint {
        Paint { fill: None, stroke: Some(Stroke { colour, width, dash: &[] }) }
    }
}

/// A line's look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Its colour.
    pub colour: Colour,
    /// Its width.
    pub width: f64,
    /// Lengths of dashes and gaps by turns; none for an unbroken line.
    pub dash: &'static [f64],
}

/// What of some words is at their place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Their beginning.
    Start,
    /// Their middle.
    Middle,
    /// Their end.
    End,
}

impl Anchor {
    /// How much of the words' width lies before their place.
    pub fn part_before(self) -> f64 {
        match self {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5,
            Anchor::End => 1.0,
        }
    }
}
