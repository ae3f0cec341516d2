//! Discs sorted by cells, in compact columns, with their images across periodic sides: everything within reach of a disc is stored in a few spans.

use super::discs::SampledDiscs;
use super::setting::StructureSetting;
use std::ops::Range;

/// Smallest number of discs in the rows of one task.
const AT_A_TIME: usize = 512;
/// Number of positions read at once; as many are stored behind the last disc.
pub(super) const AT_ONCE: usize = 8;
/// Largest number of cells along an axis.
const MOST_CELLS: f64 = 4096.0;
/// Largest number of periods of the box searched for images; discs that reach farther are larger than their box.
const MOST_PERIODS: f64 = 16.0;

/// Discs sorted into rows of cells. Images across periodic sides are stored too, so that searches need no wrapping.
#[derive(Clone, Debug, Default)]
pub(super) struct SampleCells {
    /// Start of the first cell of the box, and cells per length, along each axis.
    origin: [f64; 2],
    by_length: [f64; 2],
    /// Cells of the box along each axis, and cells of images before and after them.
    count: [usize; 2],
    margin: [usize; 2],
    /// Cell of each disc in the box, then the number of discs in each cell and the start of each cell in `order`.
    cell_of: Vec<u32>,
    box_starts: Vec<u32>,
    order: Vec<u32>,
    /// Start of each cell, images included, and the end.
    starts: Vec<u32>,
    /// Positions (length) in the order of cells, and the number of each disc.
    pub(super) x: Vec<f64>,
    pub(super) y: Vec<f64>,
    pub(super) number: Vec<u32>,
    /// Rows of the box for each task.
    pub(super) parts: Vec<Range<usize>>,
}

impl SampleCells {
    /// Sorts the discs for searches within `reach` (length).
    pub(super) fn sort(&mut self, setting: &StructureSetting, discs: &SampledDiscs, reach: f64) {
        let domain = setting.domain;
        let sides = domain.lengths();
        // Cells contain about one disc.
        let edge = (sides[0] * sides[1] / discs.x.len() as f64).sqrt().max(setting.diameter);
        for (axis, side) in sides.into_iter().enumerate() {
            // The comparison gives one cell if an overflow yields NaN.
            let count = if side / edge >= 1.0 { (side / edge).floor().min(MOST_CELLS) } else { 1.0 };
            self.origin[axis] = domain.origin[axis];
            self.by_length[axis] = count / side;
            self.count[axis] = count as usize;
            self.margin[axis] = match domain.is_periodic(axis) {
                true => (reach * self.by_length[axis]).ceil().min(MOST_PERIODS * count) as usize + 1,
                false => 0,
            };
        }
        self.sort_into_box(discs);
        self.store_with_images(discs, sides);
        self.split_into_tasks();
    }

    /// Sorts the discs of each cell of the box by their numbers.
    fn sort_into_box(&mut self, discs: &SampledDiscs) {
        let [columns, rows] = self.count;
        let (origin, by_length) = (self.origin, self.by_length);
        let along = |axis: usize, at: f64| {
            let cell = (at - origin[axis]) * by_length[axis];
            (cell as usize).min(if axis == 0 { columns - 1 } else { rows - 1 })
        };
        self.cell_of.clear();
        let cells = discs.x.iter().zip(&discs.y).map(|(&x, &y)| (along(1, y) * columns + along(0, x)) as u32);
        self.cell_of.extend(cells);
        self.box_starts.clear();
        self.box_starts.resize(columns * rows + 1, 0);
        self.cell_of.iter().for_each(|&cell| self.box_starts[cell as usize + 1] += 1);
        let mut sum = 0;
        for start in &mut self.box_starts {
            sum += *start;
            *start = sum;
        }
        self.order.resize(discs.x.len(), 0);
        // Each start moves to the end of its cell, where the next one starts.
        for (&cell, number) in self.cell_of.iter().zip(0..) {
            let place = &mut self.box_starts[cell as usize];
            self.order[*place as usize] = number;
            *place += 1;
        }
        self.box_starts.rotate_right(1);
        self.box_starts[0] = 0;
    }

    /// Stores cells with their images, row by row.
    fn store_with_images(&mut self, discs: &SampledDiscs, sides: [f64; 2]) {
        let image = |axis: usize, at: usize| {
            let (count, at) = (self.count[axis] as i64, at as i64 - self.margin[axis] as i64);
            (at.rem_euclid(count) as usize, at.div_euclid(count) as f64 * sides[axis])
        };
        let [columns, rows] = self.all();
        self.starts.clear();
        self.x.clear();
        self.y.clear();
        self.number.clear();
        for (from_row, above) in (0..rows).map(|row| image(1, row)) {
            for (from_column, right) in (0..columns).map(|column| image(0, column)) {
                self.starts.push(self.number.len() as u32);
                let cell = from_row * self.count[0] + from_column;
                let members = self.box_starts[cell] as usize..self.box_starts[cell + 1] as usize;
                for &number in &self.order[members] {
                    self.x.push(discs.x[number as usize] + right);
                    self.y.push(discs.y[number as usize] + above);
                    self.number.push(number);
                }
            }
        }
        self.starts.push(self.number.len() as u32);
        // Distances are computed in batches; the last batch of a span reads beyond its end.
        let room = [f64::INFINITY; AT_ONCE];
        self.x.extend(room);
        self.y.extend(room);
    }

    /// Splits the rows of the box into tasks by their discs, independent of the number of threads.
    fn split_into_tasks(&mut self) {
        self.parts.clear();
        let (mut begin, mut discs) = (0, 0);
        for row in 0..self.count[1] {
            discs += self.own(row).len();
            if discs >= AT_A_TIME || row + 1 == self.count[1] {
                self.parts.push(begin..row + 1);
                (begin, discs) = (row + 1, 0);
            }
        }
    }

    /// Number of cells along each axis with the images.
    #[inline(always)]
    fn all(&self) -> [usize; 2] {
        [0, 1].map(|axis| self.count[axis] + 2 * self.margin[axis])
    }

    #[inline(always)]
    fn start(&self, row: usize, column: usize) -> usize {
        self.starts[row * self.all()[0] + column] as usize
    }

    /// Discs of the box in one of its rows.
    #[inline(always)]
    pub(super) fn own(&self, row: usize) -> Range<usize> {
        let (row, first) = (row + self.margin[1], self.margin[0]);
        self.start(row, first)..self.start(row, first + self.count[0])
    }

    /// Span of discs that may be within reach of a position in a row of the box. The span is in the row `up` above it (below, if negative), and
    /// `half` is its half-width there ([`SampleCells::halves`]). Empty if there is no such row.
    #[inline(always)]
    pub(super) fn span(&self, row: usize, up: i64, x: f64, half: f64) -> Range<usize> {
        let [columns, rows] = self.all();
        let row = (row + self.margin[1]) as i64 + up;
        if !(0..rows as i64).contains(&row) {
            return 0..0;
        }
        let column = |at: f64| {
            let cell = (at - self.origin[0]) * self.by_length[0] + self.margin[0] as f64;
            let last = (columns - 1) as f64;
            let cell = if cell > 0.0 { cell } else { 0.0 };
            // An axis has few cells, so the index fits 32 bits.
            (if cell < last { cell } else { last }) as i32 as usize
        };
        let (row, first, last) = (row as usize, column(x - half), column(x + half));
        self.start(row, first)..self.start(row, last + 1)
    }

    /// Half-widths of the spans within `reach` along a row, for the row of a disc and each one above it (length).
    pub(super) fn halves(&self, reach: f64) -> impl Iterator<Item = f64> + use<'_> {
        // Smallest distance of a row.
        let away = |up: i64| (up as f64 - 1.0).max(0.0) / self.by_length[1];
        let rows = (reach * self.by_length[1]).ceil().min(self.all()[1] as f64) as i64;
        (0..=rows).map(move |up| (reach * reach - away(up) * away(up)).max(0.0).sqrt())
    }
}
