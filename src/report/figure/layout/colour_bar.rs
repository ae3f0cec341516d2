//! What the shades of a picture mean.

use super::super::sheet::{Area, Mark, Paint};
use super::super::{Axis, style};
use super::edge::{Edge, Side};

/// From the picture to the bar.
pub const GAP: f64 = 24.0;
/// How thick the bar is.
pub const THICKNESS: f64 = 22.0;

/// A bar with all shades and an axis along it.
pub struct ColourBar {
    area: Area,
    edge: Edge,
    lying: bool,
    signed: bool,
    zoom: f64,
}

impl ColourBar {
    /// A bar from the bottom (lowest) to the top of an area, marked at its right; or, lying, from its left to its
    /// right, marked below. `ends` are those of the axis' ruler.
    pub fn new(axis: &Axis, ends: [f64; 2], area: Area, lying: bool, zoom: f64) -> ColourBar {
        let edge = if lying {
            Edge::new(Side::Bottom, axis, ends, [area.left, area.right()], zoom)
        } else {
            Edge::new(Side::Right, axis, ends, [area.bottom(), area.top], zoom)
        };
        ColourBar { area, edge, lying, signed: style::is_signed(ends), zoom }
    }

    /// How far the axis reaches out from the bar.
    pub fn depth(&self) -> f64 {
        self.edge.depth()
    }

    /// The bar as marks.
    pub fn marks(&self) -> Vec<Mark> {
        let Area { left, top, width, height } = self.area;
        let lying = self.lying;
        let mut levels: Vec<u8> = style::levels(self.signed).collect();
        if !lying {
            levels.reverse();
        }
        let columns = if lying { levels.len() } else { 1 };
        let outline = Paint::stroke(style::INK, style::AXIS * self.zoom);
        let mut marks = vec![
            Mark::Cells { area: Area { left, top, width, height }, columns, levels },
            Mark::Lines { pieces: vec![self.area.corners()], closed: true, paint: outline },
        ];
        marks.extend(self.edge.marks(if lying { self.area.bottom() } else { self.area.right() }));
        marks
    }
}
