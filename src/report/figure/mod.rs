//! Figures as data: charts, heat maps and drawings, written as SVG and PNG.

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
pub(crate) mod style;
#[cfg(test)]
mod tests;
mod writer;

pub(crate) use chart::ChartBand;
pub(crate) use chart::{AxisDirection, Scale, Series};
pub use chart::{Chart, ChartAxis, SeriesPoint, Style};
pub use check::FigureError;
pub(crate) use data::{data, data_file};
pub(crate) use output::png;
pub use output::svg;
pub use picture::Figure;
pub(crate) use picture::{Drawing, HeatMap, Picture};
pub(crate) use picture::{DrawnShape, Guide, Tint};
