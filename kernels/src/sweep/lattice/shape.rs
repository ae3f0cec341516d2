//! Which cells there are and where they stand in memory.

use crate::GROUP;
use crate::mask::{Mask, Offset};
use std::ops::Range;

/// Why a lattice cannot be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// A side without cells.
    #[error("a lattice needs at least one column and one row, not {columns}×{rows}")]
    Empty {
        /// Columns asked for.
        columns: usize,
        /// Rows asked for.
        rows: usize,
    },
    /// A periodic side so short that a pair would be met twice.
    #[error(
        "a periodic side needs at least {least} cells for a mask of half-width {half_width}, not {cells}"
    )]
    PeriodicTooShort {
        /// Cells of the side.
        cells: usize,
        /// Half-width of the mask.
        half_width: u32,
        /// Cells needed.
        least: usize,
    },
    /// More cells than an index can number.
    #[error("{columns}×{rows} cells with their halo are more than the 2^32 − 1 that an index numbers")]
    TooMany {
        /// Columns asked for.
        columns: usize,
        /// Rows asked for.
        rows: usize,
    },
}

/// Where the lattice lies in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Lower left corner (length).
    pub origin: [f64; 2],
    /// Sides of a cell (length).
    pub edge: [f64; 2],
}

/// What positions on the lattice are measured from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Coordinates {
    /// From the origin, as the source has it.
    Absolute,
    /// From the centre of the disc's cell: as precise in single precision as the cell is small, and an image is a
    /// literal copy.
    #[default]
    CellRelative,
}

/// A halo cell and the cell whose image it is, as positions in the padded lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Image {
    /// Position of the halo cell.
    pub cell: usize,
    /// Position of the cell it repeats.
    pub source: usize,
    /// How many periods the image lies to the right and up.
    pub periods: [i32; 2],
}

/// A lattice of `columns × rows` cells with a halo as wide as its mask on every side, stored row by row.
///
/// Lattice vectors are *padded*: `lead` elements, the `swept` ones (all rows, each with
/// the halo at its two ends), and `lead` elements more, so that a shift by any place of the mask stays inside.
/// Lead and swept length are multiples of `GROUP`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LatticeShape {
    columns: usize,
    rows: usize,
    half_width: usize,
    periodic: [bool; 2],
}

impl LatticeShape {
    /// A lattice for a mask, periodic along x and y as said.
    ///
    /// # Errors
    /// [`ShapeError`]: no cells, a periodic side shorter than `2h + 1` cells, or too many cells to number.
    pub fn new(columns: usize, rows: usize, mask: &Mask, periodic: [bool; 2]) -> Result<Self, ShapeError> {
        if columns == 0 || rows == 0 {
            return Err(ShapeError::Empty { columns, rows });
        }
        let half_width = mask.half_width();
        let least = 2 * half_width as usize + 1;
        for (cells, periodic) in [columns, rows].into_iter().zip(periodic) {
            if periodic && cells < least {
                return Err(ShapeError::PeriodicTooShort { cells, half_width, least });
            }
        }
        let shape = LatticeShape { columns, rows, half_width: half_width as usize, periodic };
        let wide = (columns as u128 + 2 * half_width as u128) * (rows as u128 + 4 * half_width as u128 + 2);
        if wide + 4 * GROUP as u128 >= u128::from(u32::MAX) {
            return Err(ShapeError::TooMany { columns, rows });
        }
        Ok(shape)
    }

    /// Cells along x.
    #[inline]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Cells along y.
    #[inline]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Cells that discs may live in: the source's LMAX.
    #[inline]
    pub fn cells(&self) -> usize {
        self.columns * self.rows
    }

    /// Which sides are periodic.
    #[inline]
    pub fn periodic(&self) -> [bool; 2] {
        self.periodic
    }

    /// Elements from a row to the next.
    #[inline]
    pub fn stride(&self) -> usize {
        self.columns + 2 * self.half_width
    }

    /// Elements before the first row (and again behind the last).
    #[inline]
    pub(crate) fn lead(&self) -> usize {
        (self.half_width * (self.stride() + 1)).next_multiple_of(GROUP)
    }

    /// The elements that a sweep runs over; their number is the vector length of the forces.
    #[inline]
    pub fn swept(&self) -> Range<usize> {
        let lead = self.lead();
        lead..lead + (self.rows * self.stride()).next_multiple_of(GROUP)
    }

    /// Elements of a lattice vector.
    #[inline]
    pub fn padded(&self) -> usize {
        self.swept().end + self.lead()
    }

    /// Position of a cell in a padded lattice vector; halo cells have negative columns and rows or ones too large.
    #[inline]
    pub fn position(&self, column: isize, row: isize) -> usize {
        let from_first = row * self.stride() as isize + self.half_width as isize + column;
        (self.lead() as isize + from_first) as usize
    }

    /// Column and row of the cell at a position in a padded lattice vector: what [`position`](Self::position) came from, if that
    /// was no halo cell at the end of a row.
    #[inline]
    pub fn column_and_row(&self, position: usize) -> [isize; 2] {
        let from_first = position as isize - self.position(0, 0) as isize;
        let stride = self.stride() as isize;
        [from_first.rem_euclid(stride), from_first.div_euclid(stride)]
    }

    /// How far the cell of `offset` is from the own cell.
    #[inline]
    pub fn shift(&self, offset: Offset) -> isize {
        offset.rows as isize * self.stride() as isize + offset.columns as isize
    }

    /// The halo cells that repeat a cell of the lattice, in order of their positions.
    pub fn images(&self) -> Vec<Image> {
        let halo = self.half_width as isize;
        let mut images = Vec::new();
        for row in -halo..self.rows as isize + halo {
            for column in -halo..self.columns as isize + halo {
                let periods = [
                    column.div_euclid(self.columns as isize) as i32,
                    row.div_euclid(self.rows as isize) as i32,
                ];
                let repeats = (periods[0] == 0 || self.periodic[0]) && (periods[1] == 0 || self.periodic[1]);
                if periods != [0, 0] && repeats {
                    let home = (column.rem_euclid(self.columns as isize), row.rem_euclid(self.rows as isize));
                    let source = self.position(home.0, home.1);
                    images.push(Image { cell: self.position(column, row), source, periods });
                }
            }
        }
        images
    }

    /// 1 where discs live, 0 in the halo and the padding: a padded lattice vector.
    #[inline]
    pub fn interior<T: crate::isa::Element>(&self) -> Vec<T> {
        let mut interior = vec![T::from_f64(0.0); self.padded()];
        for row in 0..self.rows as isize {
            let first = self.position(0, row);
            interior[first..first + self.columns].fill(T::from_f64(1.0));
        }
        interior
    }

    /// The x of an empty cell: finite, farther from every disc and from every other empty cell than any contact
    /// reaches. The one place where this is chosen. A padded lattice vector.
    #[inline]
    pub fn far<T: crate::isa::Element>(&self, frame: Frame) -> Vec<T> {
        let extent = (0..2)
            .map(|axis| {
                let cells = [self.columns, self.rows][axis] + 2 * self.half_width + 2;
                frame.origin[axis].abs() + 2.0 * cells as f64 * frame.edge[axis]
            })
            .fold(0.0, f64::max);
        // A power of two times a whole number: exact in either precision (to 2^24 cells in single precision, beyond
        // which neighbouring empty cells may coincide, which harms only their own, unused sums).
        let unit = (4.0 * extent).log2().ceil().exp2();
        (0..self.padded()).map(|position| T::from_f64(unit * (position + 1) as f64)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_lattices_are_refused() {
        let mask = Mask::square(2);
        assert_eq!(
            LatticeShape::new(0, 3, &mask, [false; 2]),
            Err(ShapeError::Empty { columns: 0, rows: 3 })
        );
        assert_eq!(
            LatticeShape::new(9, 4, &mask, [true; 2]),
            Err(ShapeError::PeriodicTooShort { cells: 4, half_width: 2, least: 5 })
        );
        let (columns, rows) = (1 << 17, 1 << 16);
        assert_eq!(
            LatticeShape::new(columns, rows, &mask, [false; 2]),
            Err(ShapeError::TooMany { columns, rows })
        );
        assert!(LatticeShape::new(5, 5, &mask, [true; 2]).is_ok());
        assert!(LatticeShape::new(1, 1, &mask, [false; 2]).is_ok());
    }

    /// Every cell sees at every place of the mask exactly the cell that the geometry says, images included.
    #[test]
    fn shifts_and_images_agree_with_the_geometry() {
        for periodic in [[false, false], [true, false], [false, true], [true, true]] {
            let mask = Mask::square(3);
            let shape = LatticeShape::new(7, 9, &mask, periodic).unwrap();
            let images = shape.images();
            for row in 0..9isize {
                for column in 0..7isize {
                    let own = shape.position(column, row) as isize;
                    for &offset in mask.offsets() {
                        let there = (own + shape.shift(offset)) as usize;
                        let (c, r) = (column + offset.columns as isize, row + offset.rows as isize);
                        assert_eq!(there, shape.position(c, r));
                        let inside = (0..7).contains(&c) && (0..9).contains(&r);
                        let wrapped =
                            (periodic[0] || (0..7).contains(&c)) && (periodic[1] || (0..9).contains(&r));
                        let image = images.iter().find(|image| image.cell == there);
                        assert_eq!(image.is_some(), wrapped && !inside);
                        if let Some(image) = image {
                            assert_eq!(image.source, shape.position(c.rem_euclid(7), r.rem_euclid(9)));
                            assert_eq!(image.periods, [c.div_euclid(7) as i32, r.div_euclid(9) as i32]);
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn shifts_of_the_swept_cells_stay_in_the_padded_lattice() {
        for (columns, rows, half_width) in [(1, 1, 2), (5, 3, 2), (16, 1, 3), (1, 40, 3), (33, 17, 2)] {
            let mask = Mask::square(half_width);
            let shape = LatticeShape::new(columns, rows, &mask, [false; 2]).unwrap();
            for &offset in mask.offsets() {
                let shift = shape.shift(offset);
                assert!(shape.lead() as isize + shift >= 0);
                assert!(shape.swept().end as isize + shift <= shape.padded() as isize);
            }
        }
    }

    #[test]
    fn empty_cells_are_far_from_everything_in_either_precision() {
        let mask = Mask::square(2);
        let shape = LatticeShape::new(300, 200, &mask, [true; 2]).unwrap();
        let frame = Frame { origin: [-3.0, 1e3], edge: [0.5, 0.7] };
        let far: Vec<f32> = shape.far(frame);
        let reach = 2.0 * 1e3 + 300.0;
        assert!(far.iter().all(|x| x.is_finite() && *x > 2.0 * reach));
        assert!(far.windows(2).all(|pair| pair[1] - pair[0] > reach));
        assert!(far.iter().all(|x| (x * x).is_finite()));
    }
}
