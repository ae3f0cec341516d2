//! Where everything of a picture lies on its sheet.

mod band;
mod chart;
mod clip;
mod colour_bar;
mod curve;
mod drawing;
mod edge;
mod frame;
mod legend;
mod map;
mod marker;
mod ruler;
mod ticks;
mod title;

pub use ruler::data_ends as ends;

use super::check::check;
use super::sheet::Sheet;
use super::{Figure, FigureError, Picture};

/// Lays a figure out.
pub fn sheet(figure: &Figure) -> Result<Sheet, FigureError> {
    check(figure)?;
    match &figure.picture {
        Picture::Chart(picture) => chart::lay_out(&figure.title, picture),
        Picture::Map(picture) => map::lay_out(&figure.title, picture),
        Picture::Drawing(picture) => drawing::lay_out(&figure.title, picture),
    }
    .map_err(|fault| fault.of(&figure.name))
}

#[cfg(test)]
mod tests;
