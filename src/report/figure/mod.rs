//! Pictures of finished data, before it is known where they will be seen.

use serde::{Deserialize, Serialize};

mod chart;
mod check;
mod drawing;
mod error;
mod font;
mod layout;
pub mod look;
mod map;
mod png;
#[cfg(test)]
mod samples;
mod sheet;
pub mod style;
mod svg;

pub use chart::{Axis, Band, Chart, Point, Scale, Series, Style};
pub use drawing::{Drawing, Shape, Tint};
pub use error::{Fault, FigureError};
pub use layout::ends;
pub use map::Map;
pub use png::png;
pub use svg::svg;

/// A picture with a name for files.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figure {
    /// A name for files, in lower case.
    pub name: String,
    /// What it shows, in one line.
    pub title: String,
    /// What a reader must know besides.
    pub caption: String,
    /// What is drawn.
    pub picture: Picture,
}

/// What is drawn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Picture {
    /// Curves and points over two axes.
    Chart(Chart),
    /// A number for each place of a grid, as a colour.
    Map(Map),
    /// Things where they are.
    Drawing(Drawing),
}
