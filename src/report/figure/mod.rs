//! Figures: charts, heat maps and drawings as data, written as SVG and PNG.

mod axis;
mod chart;
mod check;
mod data;
mod drawing;
mod font;
mod map;
mod output;
mod picture;
mod plane;
mod plot;
mod series;
pub mod style;
#[cfg(test)]
mod tests;
mod writer;

pub(crate) use chart::{Along, Scale, Series};
pub use chart::{Axis, Band, Chart, Point, Style};
pub use check::FigureError;
pub use data::{data, data_file};
pub use output::{png, svg};
pub use picture::{Drawing, Figure, Map, Picture};
pub(crate) use picture::{Guide, Shape, Tint};
