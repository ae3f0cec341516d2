//! What can be wrong with a figure.

use stripmine_physics::number::significant;
use stripmine_physics::reported::{Class, Reported};

/// A figure that cannot be drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("figure `{figure}`: {fault}")]
pub struct FigureError {
    /// The figure's name.
    pub figure: String,
    /// What is wrong with it.
    pub fault: Fault,
}

/// What is wrong with a figure.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Fault {
    /// A picture that was drawn before, of which nothing but its lines is known.
    #[error("it was drawn before and has no scene")]
    Drawn,
    /// A number that has no place.
    #[error("{place} is {value}, which is not finite")]
    NotFinite {
        /// Where it stands.
        place: String,
        /// The number.
        value: f64,
    },
    /// A number that a logarithmic axis cannot show.
    #[error("{place} is {}, but its axis is logarithmic", significant(*value, 6))]
    NotPositive {
        /// Where it stands.
        place: String,
        /// The number.
        value: f64,
    },
    /// A place or size far beyond the picture.
    #[error("{place} is {}, which is {} pixels on the picture", significant(*value, 6), significant(*pixels, 2))]
    TooFar {
        /// Where it stands.
        place: String,
        /// The number.
        value: f64,
        /// How long it is on the picture.
        pixels: f64,
    },
    /// Nothing to draw.
    #[error("there is nothing in it")]
    Empty,
    /// Rows of a map that differ in length.
    #[error("row {row} has {found} values, the rows before it {expected}")]
    UnevenRows {
        /// Its number, from 0.
        row: usize,
        /// How many values the others have.
        expected: usize,
        /// How many values it has.
        found: usize,
    },
    /// A map's axis without ends.
    #[error("the axis `{axis}` of a map needs limits")]
    NoLimits {
        /// The axis.
        axis: String,
    },
    /// Ends that are no interval.
    #[error("{place} goes from {} to {}, which is not upwards or too far", significant(ends[0], 6), significant(ends[1], 6))]
    NotAnInterval {
        /// Where they stand.
        place: String,
        /// The ends.
        ends: [f64; 2],
    },
    /// A picture whose size makes no sense.
    #[error("a picture of {} by {} pixels cannot be drawn", significant(*width, 6), significant(*height, 6))]
    Size {
        /// Its width.
        width: f64,
        /// Its height.
        height: f64,
    },
    /// A picture that the drawing library refuses.
    #[error("it cannot be drawn: {problem}")]
    Drawing {
        /// What the library says.
        problem: String,
    },
}

impl Fault {
    /// The fault of a figure with this name.
    pub(super) fn of(self, figure: &str) -> FigureError {
        FigureError { figure: figure.to_owned(), fault: self }
    }
}

impl Reported for FigureError {
    // A picture that cannot be drawn is a mistake of ours.
    fn class(&self) -> Class {
        Class::InputOutput
    }
}
