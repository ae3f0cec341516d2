//! Rows of observables on the way to averages, in little memory however long a run is.

use crate::method::{Kind, Quantity};

/// Blocks that are kept at most; then pairs of them become one.
const MOST_BLOCKS: usize = 2048;
/// Rows belong to one series if the times between them differ by no larger part.
const EVEN: f64 = 1e-3;

/// The rows of a run since they have been evenly spaced.
///
/// The first row is the start of all increments and is no value itself. The others are kept as `MOST_BLOCKS` at most: of a
/// longer run, twice as many rows are a block whenever these are full. Of a moment's or an interval's value a block has the mean over its
/// rows, of what is counted since the start the value at its end. The same rows make the same blocks in however many sessions.
#[derive(Clone, Debug)]
pub struct Rows {
    quantities: &'static [Quantity],
    time: usize,
    count: u64,
    base: Vec<f64>,
    last: Vec<f64>,
    farthest: Vec<f64>,
    /// Time between rows; none before there are two.
    spacing: Option<f64>,
    /// Rows of a block.
    length: u64,
    blocks: Vec<Vec<f64>>,
    /// Rows of the block to come, and their sums, or the last of what is counted.
    open: (u64, Vec<f64>),
}

impl Rows {
    /// Of quantities, one of which is the time.
    pub fn new(quantities: &'static [Quantity]) -> Rows {
        Rows {
            quantities,
            time: quantities.iter().position(|it| it.kind == Kind::Time).unwrap_or_default(),
            count: 0,
            base: vec![],
            last: vec![],
            farthest: vec![0.0; quantities.len()],
            spacing: None,
            length: 1,
            blocks: vec![],
            open: (0, vec![]),
        }
    }

    /// Rows so far.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// What is observed.
    pub fn quantities(&self) -> &'static [Quantity] {
        self.quantities
    }

    /// Time of the newest row (time).
    pub fn now(&self) -> f64 {
        self.last.get(self.time).copied().unwrap_or(0.0)
    }

    /// The newest row, if it is of that time.
    pub(crate) fn row_at(&self, time: f64) -> Option<&[f64]> {
        (self.count > 0 && self.now() == time).then_some(&self.last[..])
    }

    /// When the rows that count begin (time).
    pub(super) fn from(&self) -> f64 {
        self.base.get(self.time).copied().unwrap_or(0.0)
    }

    /// Time between the values of a series (time).
    pub(super) fn block_spacing(&self) -> f64 {
        self.spacing.unwrap_or(0.0) * self.length as f64
    }

    /// Adds a row, a value for each quantity. Where the time between rows changes, as by another `run.thermo_every` on resumption,
    /// those before do not count any more.
    pub fn add(&mut self, row: &[f64]) {
        self.count += 1;
        if self.base.is_empty() {
            self.base = row.to_vec();
            self.last = row.to_vec();
            return;
        }
        let gap = row[self.time] - self.now();
        let spacing = *self.spacing.get_or_insert(gap);
        if (gap - spacing).abs() > EVEN * spacing {
            self.base = std::mem::take(&mut self.last);
            (self.spacing, self.length, self.open) = (Some(gap), 1, (0, vec![]));
            self.blocks.clear();
        }
        for ((farthest, first), value) in self.farthest.iter_mut().zip(&self.base).zip(row) {
            // A difference that is not a number stays one.
            let far = (value - first).abs();
            *farthest = if far <= *farthest { *farthest } else { far + 0.0 * *farthest };
        }
        self.last = row.to_vec();
        self.enter(row);
    }

    fn enter(&mut self, row: &[f64]) {
        if self.open.0 == 0 {
            self.open.1 = row.to_vec();
        } else {
            for ((sum, &value), quantity) in self.open.1.iter_mut().zip(row).zip(self.quantities) {
                *sum = if quantity.kind.grows() { value } else { *sum + value };
            }
        }
        self.open.0 += 1;
        if self.open.0 < self.length {
            return;
        }
        let (rows, mut block) = std::mem::take(&mut self.open);
        for (value, quantity) in block.iter_mut().zip(self.quantities) {
            if !quantity.kind.grows() {
                *value /= rows as f64;
            }
        }
        self.blocks.push(block);
        if self.blocks.len() == MOST_BLOCKS {
            self.merge();
        }
    }

    /// Makes one block of each two.
    fn merge(&mut self) {
        let pairs = self.blocks.chunks_exact(2).map(|pair| {
            let values = pair[0].iter().zip(&pair[1]).zip(self.quantities);
            let merged = values.map(|((a, b), it)| if it.kind.grows() { *b } else { 0.5 * (a + b) });
            merged.collect()
        });
        self.blocks = pairs.collect();
        self.length *= 2;
    }

    /// The series of which the average of a quantity is one: values, or increments in a unit of time. The first is of the stretch that
    /// ends [`block_spacing`](Self::block_spacing) after [`from`](Self::from).
    pub(super) fn series(&self, place: usize) -> Vec<f64> {
        if !self.quantities[place].kind.grows() {
            return self.blocks.iter().map(|block| block[place]).collect();
        }
        let Some(base) = self.base.get(place) else { return vec![] };
        let duration = self.block_spacing();
        let mut before = *base;
        let rates = self.blocks.iter().map(|block| {
            let rate = (block[place] - before) / duration;
            before = block[place];
            rate
        });
        rates.collect()
    }

    /// The series of a quantity with the times at which its stretches end: (time, value).
    pub fn course(&self, place: usize) -> Vec<[f64; 2]> {
        let (from, spacing) = (self.from(), self.block_spacing());
        let values = self.series(place).into_iter().zip(1_u32..);
        values.map(|(value, number)| [from + f64::from(number) * spacing, value]).collect()
    }

    /// First value, last value, and the largest difference from the first.
    pub(super) fn kept(&self, place: usize) -> [f64; 3] {
        let at = |row: &[f64]| row.get(place).copied().unwrap_or(0.0);
        [at(&self.base), at(&self.last), self.farthest[place]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn quantity(name: &'static str, kind: Kind) -> Quantity {
        Quantity { name, unit: "", kind, doc: "" }
    }

    const QUANTITIES: &[Quantity] = &[
        quantity("time", Kind::Time),
        quantity("x", Kind::Instant),
        quantity("count", Kind::Counter),
        quantity("z", Kind::Interval),
        quantity("energy", Kind::Kept),
    ];

    /// A row of a run with a sum, and a mean over the interval before it of `sum` as well.
    fn row(time: f64, x: f64, sum: f64) -> [f64; 5] {
        [time, x, 3.0 * sum, sum, -time]
    }

    #[test]
    fn the_first_row_is_no_value_and_the_start_of_increments() {
        let mut rows = Rows::new(QUANTITIES);
        // By hand: increments 1, 3 and 2 within half a unit of time each, at x = 2.
        for (time, sum) in [(0.0, 0.0), (0.5, 1.0), (1.0, 4.0), (1.5, 6.0)] {
            rows.add(&row(time, 2.0, sum));
        }
        assert_eq!(rows.series(1), [2.0; 3]);
        assert_eq!(rows.series(2), [6.0, 18.0, 12.0]);
        assert_eq!(rows.series(3), [1.0, 4.0, 6.0]);
        assert_eq!((rows.kept(4), rows.from(), rows.now()), ([0.0, -1.5, 1.5], 0.0, 1.5));
    }

    /// Blocks of a long run against all of its rows.
    #[test]
    fn blocks_of_a_long_run_are_means_of_its_rows() {
        let mut rows = Rows::new(QUANTITIES);
        let x = |at: u32| 2.0 + f64::from(at * 7919 % 101);
        for at in 0..=10_000 {
            rows.add(&row(0.25 * f64::from(at), x(at), 5.0 * f64::from(at)));
        }
        let length = 8;
        let series = rows.series(1);
        assert_eq!((series.len(), rows.block_spacing()), (10_000 / length as usize, 2.0));
        for (block, found) in (0..).zip(&series) {
            let expected = (1..=length).map(|at| x(block * length + at)).sum::<f64>() / f64::from(length);
            assert!((found - expected).abs() < 1e-12, "{block}");
        }
        assert!(rows.series(2).iter().all(|rate| (rate - 60.0).abs() < 1e-9));
    }

    #[test]
    fn rows_before_the_spacing_changed_do_not_count() {
        let mut rows = Rows::new(QUANTITIES);
        for time in [0.0, 1.0, 2.0, 3.0, 3.5, 4.0, 4.5] {
            rows.add(&row(time, time, 0.0));
        }
        assert_eq!((rows.series(1), rows.from()), (vec![3.5, 4.0, 4.5], 3.0));
        assert_eq!(rows.count(), 7);
    }
}
