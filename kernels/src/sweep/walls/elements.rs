//! Pieces of walls as seen from the cells that they can touch.

use super::pieces::{PieceShape, WallPiece, direction};
use crate::sweep::fast::CellGrid;

/// Numbers of an element.
pub const ELEMENT_NUMBERS: usize = 15;

/// Geometry of an element, relative to the centre of a cell (length).
///
/// For a disc at u from `point`, the vector from the closest point is u − (u·`along`) `along`. The element counts if u·`gates[k]` <
/// `limits[k]` for both k.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElementShape {
    /// A point of the piece: its end, where that is near, or the point nearest to the centre.
    pub point: [f64; 2],
    /// Unit vector along a segment; zero for a corner.
    pub along: [f64; 2],
    /// Unit vectors of the gates.
    pub gates: [[f64; 2]; 2],
    /// Limits of the gates (length).
    pub limits: [f64; 2],
}

/// Surface of a wall: its velocity, and its coefficients in the law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallSurface {
    /// Velocity (length/time).
    pub velocity: [f64; 2],
    /// Normal damping (1/time).
    pub normal_damping: f64,
    /// Tangential damping (1/time).
    pub shear_damping: f64,
    /// Coulomb friction coefficient.
    pub friction: f64,
}

/// Element of a wall in a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellElement {
    /// Column and row of the cell.
    pub cell: [usize; 2],
    /// Number of the wall.
    pub wall: u32,
    /// Geometry.
    pub shape: ElementShape,
}

/// Overlap of two gates at one end, relative to the reach: rounding must not open a gap between them.
const SLIVER: f64 = 1e-12;

impl ElementShape {
    /// A piece as seen from a point; none if it is farther than `near` (length).
    pub fn seen(piece: &WallPiece, from: [f64; 2], near: f64) -> Option<ElementShape> {
        let relative = |[x, y]: [f64; 2]| [x - from[0], y - from[1]];
        let is_near = |[x, y]: [f64; 2]| x * x + y * y <= near * near;
        // No disc near the point is as far as this.
        let beyond = 4.0 * near;
        match piece.shape {
            PieceShape::Corner { at, away } => {
                let point = relative(at);
                is_near(point).then_some(ElementShape {
                    point,
                    along: [0.0; 2],
                    gates: away,
                    limits: [0.0; 2],
                })
            }
            PieceShape::Inside { ends, owns } => {
                let along = direction(ends);
                let [a, b] = ends.map(relative);
                let length = (b[0] - a[0]) * along[0] + (b[1] - a[1]) * along[1];
                let to_nearest = (-(a[0] * along[0] + a[1] * along[1])).clamp(0.0, length);
                let nearest = [0, 1].map(|axis| a[axis] + to_nearest * along[axis]);
                if !is_near(nearest) {
                    return None;
                }
                let back = along.map(|x| -x);
                let end = |owned: bool| if owned { SLIVER * near } else { 0.0 };
                // An end that is near is the point itself, so that all segments that meet there agree on which disc is beyond it.
                let (point, gates, limits) = match [is_near(a), is_near(b)] {
                    [true, true] => {
                        let far = if owns[1] { length * (1.0 + 1e-6) } else { length };
                        (a, [back, along], [end(owns[0]), far])
                    }
                    [true, false] => (a, [back, along], [end(owns[0]), beyond]),
                    [false, true] => (b, [along, back], [end(owns[1]), beyond]),
                    [false, false] => (nearest, [back, along], [beyond; 2]),
                };
                Some(ElementShape { point, along, gates, limits })
            }
        }
    }

    /// All numbers of an element, in the order of [`WALL_ARRAYS`](super::WALL_ARRAYS); `centre` is added to its point (length).
    pub fn numbers(&self, surface: &WallSurface, centre: [f64; 2]) -> [f64; ELEMENT_NUMBERS] {
        let ElementShape { point, along, gates: [g, h], limits } = *self;
        let WallSurface { velocity, normal_damping, shear_damping, friction } = *surface;
        let [x, y] = [0, 1].map(|axis| centre[axis] + point[axis]);
        [
            x,
            y,
            along[0],
            along[1],
            g[0],
            g[1],
            h[0],
            h[1],
            limits[0],
            limits[1],
            velocity[0],
            velocity[1],
            normal_damping,
            shear_damping,
            friction,
        ]
    }
}

/// Elements of all pieces in the cells from which a disc can touch them, in the order of the cells' rows and columns, then of the
/// pieces. `reach` is the largest distance (length) at which a disc acts, and `margin` how far it may be outside its cell (length).
pub fn elements(grid: &CellGrid, pieces: &[WallPiece], reach: f64, margin: f64) -> Vec<CellElement> {
    let CellGrid { frame, counts, periodic } = *grid;
    let [half_x, half_y] = frame.edge.map(|edge| 0.5 * edge);
    let near = (reach + margin + (half_x * half_x + half_y * half_y).sqrt()) * (1.0 + 1e-9);
    let centre = |cell: [usize; 2]| {
        [0, 1].map(|axis| frame.origin[axis] + (cell[axis] as f64 + 0.5) * frame.edge[axis])
    };
    // Cells along an axis whose centres may be between two coordinates (length).
    let cells = |axis: usize, [low, high]: [f64; 2]| {
        let at = |x: f64| (x - frame.origin[axis]) / frame.edge[axis] - 0.5;
        let last = counts[axis] as f64 - 1.0;
        let (first, end) = (at(low).floor().max(0.0), at(high).ceil().min(last));
        if first <= end { first as usize..end as usize + 1 } else { 0..0 }
    };
    let mut found = vec![];
    for piece in pieces {
        let [low, high] = piece.bounds();
        let shifts = [0, 1].map(|axis| {
            let period = counts[axis] as f64 * frame.edge[axis];
            if !periodic[axis] {
                return vec![0.0];
            }
            let first = ((frame.origin[axis] - near - high[axis]) / period).ceil() as i64;
            let last = ((frame.origin[axis] + period + near - low[axis]) / period).floor() as i64;
            (first..=last).map(|count| count as f64 * period).collect::<Vec<f64>>()
        });
        for (x, y) in shifts[0].iter().flat_map(|&x| shifts[1].iter().map(move |&y| (x, y))) {
            let image = piece.moved([x, y]);
            let [low, high] = image.bounds();
            for row in cells(1, [low[1] - near, high[1] + near]) {
                let height = centre([0, row])[1];
                for column in cells(0, along_row(&image, [height - near, height + near], near)) {
                    let cell = [column, row];
                    if let Some(shape) = ElementShape::seen(&image, centre(cell), near) {
                        found.push(CellElement { cell, wall: piece.wall, shape });
                    }
                }
            }
        }
    }
    found.sort_by_key(|element| [element.cell[1], element.cell[0]]);
    found
}

/// Range along x of the part of a piece between two heights, widened by `near` (length).
fn along_row(piece: &WallPiece, [low, high]: [f64; 2], near: f64) -> [f64; 2] {
    let [[left, _], [right, _]] = piece.bounds();
    let PieceShape::Inside { ends: [a, b], .. } = piece.shape else { return [left - near, right + near] };
    let slope = (b[0] - a[0]) / (b[1] - a[1]);
    if !slope.is_finite() {
        return [left - near, right + near];
    }
    let at = |y: f64| (a[0] + slope * (y - a[1])).clamp(left, right);
    let (first, last) = (at(low), at(high));
    [first.min(last) - near, first.max(last) + near]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::lattice::LatticeFrame;
    use crate::sweep::walls::pieces;

    /// Compared with all cells and all images: every cell within reach of a piece has its element, once.
    #[test]
    fn elements_are_those_of_all_cells() {
        let frame = LatticeFrame { origin: [-1.0, 2.0], edge: [0.7, 0.9] };
        let segments = [
            [[-1.0, 2.0], [13.0, 2.0]],
            [[3.0, 4.0], [8.5, 17.0]],
            [[6.0, 19.0], [6.0, 3.0]],
            [[7.0, 9.0], [7.1, 9.0]],
        ];
        for periodic in [[true, false], [false, true], [true, true], [false, false]] {
            let grid = CellGrid { frame, counts: [20, 18], periodic };
            let sides = [20.0 * 0.7, 18.0 * 0.9];
            let periods = [0, 1].map(|axis| periodic[axis].then_some(sides[axis]));
            let all = pieces(&segments, periods, 1e-9, |_, _| true);
            let found = elements(&grid, &all, 0.5, 0.01);
            let near = 0.51 + 0.5 * (0.49f64 + 0.81).sqrt();
            let mut count = 0;
            for (row, column) in (0..18).flat_map(|row| (0..20).map(move |column| (row, column))) {
                let centre = [-1.0 + (column as f64 + 0.5) * 0.7, 2.0 + (row as f64 + 0.5) * 0.9];
                let images = |axis: usize| if periodic[axis] { vec![-1.0, 0.0, 1.0] } else { vec![0.0] };
                for piece in &all {
                    for (i, j) in
                        images(0).into_iter().flat_map(|i| images(1).into_iter().map(move |j| (i, j)))
                    {
                        let image = piece.moved([i * sides[0], j * sides[1]]);
                        if let Some(shape) = ElementShape::seen(&image, centre, near) {
                            count += 1;
                            let has = |it: &&CellElement| {
                                it.cell == [column, row]
                                    && it.wall == piece.wall
                                    && (0..2).all(|k| (it.shape.point[k] - shape.point[k]).abs() < 1e-9)
                                    && (0..2).all(|k| (it.shape.limits[k] - shape.limits[k]).abs() < 1e-7)
                            };
                            assert!(found.iter().any(|it| has(&it)), "{piece:?} in {column} {row}");
                        }
                    }
                }
            }
            assert_eq!(found.len(), count, "{periodic:?}");
            assert!(found.is_sorted_by_key(|it| [it.cell[1], it.cell[0]]));
        }
    }
}
