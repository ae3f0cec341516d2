//! Figures as scenes of the plotting library, `kuva`: it has axes, their marks and grids, and colour bars. The rest is drawn
//! here, with its primitives: curves and markers that name their series, legends that show line and marker, maps of many cells in few
//! bytes, things where they are.

mod axis;
mod chart;
mod colours;
mod drawing;
mod frame;
mod guide;
mod legend;
mod map;
mod marker;
mod series;
mod words;

use super::check::check;
use super::{Fault, Figure, FigureError, Picture};
use kuva::render::render::Scene;

/// A figure as a scene.
///
/// # Errors
/// When the figure cannot be drawn.
pub fn scene(figure: &Figure) -> Result<Scene, FigureError> {
    check(figure)?;
    match &figure.picture {
        Picture::Chart(picture) => chart::scene(&figure.title, picture),
        Picture::Map(picture) => map::scene(&figure.title, picture),
        Picture::Drawing(picture) => Ok(drawing::scene(&figure.title, picture)),
        Picture::Drawn { .. } => Err(Fault::Drawn),
    }
    .map_err(|fault| fault.of(&figure.name))
}

#[cfg(test)]
mod tests;
