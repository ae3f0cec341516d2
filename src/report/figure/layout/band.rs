//! Hatched parts of a chart.

use super::super::sheet::{Area, Mark, Paint};
use super::super::style;
use super::super::{Along, Band};
use super::clip;

/// Distance of the hatching's lines.
const HATCHING: f64 = 9.0;
/// A hatched part of the plane.
pub fn band(area: &Area) -> [Mark; 2] {
    let lines = clip::hatching(area, HATCHING);
    let sides = [area.left, area.right()].map(|x| vec![[x, area.top], [x, area.bottom()]]);
    [(lines, 1.0), (sides.into(), 1.4)].map(|(pieces, width)| Mark::Lines {
        pieces,
        closed: false,
        paint: Paint::stroke(style::HATCHING, width),
    })
}

/// A light ground across the plane, behind the grid; of several the first is the lightest, so that the widest comes first.
pub fn ground(area: &Area, bands: &[Band], number: usize) -> Mark {
    let before = bands[..number].iter().filter(|band| band.along == Along::Y).count();
    let colour = style::GROUNDS[before.min(style::GROUNDS.len() - 1)];
    Mark::Lines { pieces: vec![area.corners()], closed: true, paint: Paint::fill(colour) }
}
