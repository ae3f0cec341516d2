//! The box of a picture with axes.

use super::super::sheet::{Area, Mark, Paint, Place};
use super::super::{Axis, style};
use super::edge::{Edge, Side};

/// An axis and its ends, in what its ruler measures in.
pub struct Span<'a> {
    /// The axis.
    pub axis: &'a Axis,
    /// Its ends.
    pub ends: [f64; 2],
}

/// A box with two marked edges.
pub struct Frame {
    /// The box.
    pub plot: Area,
    across: Edge,
    up: Edge,
}

impl Frame {
    /// A box below `top`, on a sheet of the usual width that keeps some of it free on the right.
    pub fn new(x: &Span<'_>, y: &Span<'_>, top: f64, height: f64, right: f64) -> Frame {
        let up = Edge::new(Side::Left, y.axis, y.ends, [top + height, top], 1.0);
        let left = style::MARGIN + up.depth();
        let width = (style::WIDTH - left - right).max(style::PLOT_WIDTH);
        let across = Edge::new(Side::Bottom, x.axis, x.ends, [left, left + width], 1.0);
        Frame { plot: Area { left, top, width, height }, across, up }
    }

    /// The height a sheet needs.
    pub fn sheet_height(&self) -> f64 {
        self.plot.bottom() + self.across.depth() + style::MARGIN
    }

    /// Where a point lies.
    pub fn place(&self, x: f64, y: f64) -> Place {
        [self.across.ruler().place(x), self.up.ruler().place(y)]
    }

    /// The lines of the grid.
    pub fn grid(&self) -> Mark {
        let Area { left, top, .. } = self.plot;
        let upright = self.across.numbered().map(|x| vec![[x, top], [x, self.plot.bottom()]]);
        let level = self.up.numbered().map(|y| vec![[left, y], [self.plot.right(), y]]);
        let pieces = upright.chain(level).collect();
        Mark::Lines { pieces, closed: false, paint: Paint::stroke(style::GRID, 1.0) }
    }

    /// The box and what is written along it.
    pub fn edges(&self) -> Vec<Mark> {
        let outline = Mark::Lines {
            pieces: vec![self.plot.corners()],
            closed: true,
            paint: Paint::stroke(style::INK, style::AXIS),
        };
        let mut marks = vec![outline];
        marks.extend(self.across.marks(self.plot.bottom()));
        marks.extend(self.up.marks(self.plot.left));
        marks
    }
}
