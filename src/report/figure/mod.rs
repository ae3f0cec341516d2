//! Pictures of finished data, before it is known where they will be seen.

mod chart;
mod check;
mod data;
mod draw;
mod drawing;
mod error;
mod font;
mod look;
mod map;
mod picture;
mod png;
#[cfg(test)]
mod samples;
pub mod style;
mod svg;
mod xml;

pub use chart::{Along, Axis, Band, Chart, Point, Scale, Series, Style};
pub use data::{data, data_file};
pub use drawing::{Drawing, Guide, Shape, Tint};
pub use error::{Fault, FigureError};
pub use map::Map;
pub use picture::{Figure, Picture};
pub use png::png;
pub use svg::svg;
