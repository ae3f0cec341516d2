//! Rows of observables accumulated for averages, in bounded memory.

use crate::method::{ObservedQuantity, QuantityKind};

/// Largest number of blocks; beyond it, pairs of blocks are merged.
const MOST_BLOCKS: usize = 2048;
/// Relative difference between times of rows up to which they are evenly spaced.
const EVEN: f64 = 1e-3;

/// Rows of a run since they have been evenly spaced.
///
/// The first row is the base of all increments and not a value. The others are stored in at most `MOST_BLOCKS` blocks; whenever these are full, the
/// number of rows in a block is doubled. A block has the mean of instantaneous and interval values over its rows, and the last value of counters.
/// Blocks depend on the rows alone, not on the number of sessions.
#[derive(Clone, Debug)]
pub struct AveragedRows {
    quantities: &'static [ObservedQuantity],
    time: usize,
    count: u64,
    base: Vec<f64>,
    last: Vec<f64>,
    farthest: Vec<f64>,
    /// Time between rows; none before the second.
    spacing: Option<f64>,
    /// Number of rows in a block.
    length: u64,
    blocks: Vec<Vec<f64>>,
    /// Number of rows of the open block, and their sums, or the last value of counters.
    open: (u64, Vec<f64>),
}

impl AveragedRows {
    /// Empty rows of quantities; the time is among them.
    pub fn new(quantities: &'static [ObservedQuantity]) -> AveragedRows {
        AveragedRows {
            quantities,
            time: quantities.iter().position(|it| it.kind == QuantityKind::Time).unwrap_or_default(),
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

    /// Number of rows so far.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Observed quantities.
    pub fn quantities(&self) -> &'static [ObservedQuantity] {
        self.quantities
    }

    /// Time of the newest row (time).
    pub fn now(&self) -> f64 {
        self.last.get(self.time).copied().unwrap_or(0.0)
    }

    /// Newest row, if it has this time.
    pub(crate) fn row_at(&self, time: f64) -> Option<&[f64]> {
        (self.count > 0 && self.now() == time).then_some(&self.last[..])
    }

    /// Time of the base row (time).
    pub(super) fn from(&self) -> f64 {
        self.base.get(self.time).copied().unwrap_or(0.0)
    }

    /// Time between values of a series (time).
    pub(super) fn block_spacing(&self) -> f64 {
        self.spacing.unwrap_or(0.0) * self.length as f64
    }

    /// Adds a row, with a value for each quantity. If the time between rows changes, for instance by another `run.thermo_every` on resumption,
    /// earlier rows are discarded.
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
            // NaN stays NaN.
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

    /// Merges pairs of blocks.
    fn merge(&mut self) {
        let pairs = self.blocks.chunks_exact(2).map(|pair| {
            let values = pair[0].iter().zip(&pair[1]).zip(self.quantities);
            let merged = values.map(|((a, b), it)| if it.kind.grows() { *b } else { 0.5 * (a + b) });
            merged.collect()
        });
        self.blocks = pairs.collect();
        self.length *= 2;
    }

    /// Series that the average of a quantity is computed from: values, or rates of increments. The first value is of the interval that ends
    /// [`block_spacing`](Self::block_spacing) after [`from`](Self::from).
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

    /// Time series of a quantity: (end of the interval, value).
    pub fn time_series(&self, place: usize) -> Vec<[f64; 2]> {
        let (from, spacing) = (self.from(), self.block_spacing());
        let values = self.series(place).into_iter().zip(1_u32..);
        values.map(|(value, number)| [from + f64::from(number) * spacing, value]).collect()
    }

    /// First value, last value, and the largest difference from the first.
    pub(super) fn first_last_and_farthest(&self, place: usize) -> [f64; 3] {
        let at = |row: &[f64]| row.get(place).copied().unwrap_or(0.0);
        [at(&self.base), at(&self.last), self.farthest[place]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn quantity(name: &'static str, kind: QuantityKind) -> ObservedQuantity {
        ObservedQuantity { name, unit: "", kind, doc: "" }
    }

    const QUANTITIES: &[ObservedQuantity] = &[
        quantity("time", QuantityKind::Time),
        quantity("x", QuantityKind::Instant),
        quantity("count", QuantityKind::Counter),
        quantity("z", QuantityKind::Interval),
        quantity("energy", QuantityKind::Kept),
    ];

    /// Row of a run with a sum, and with `sum` as a mean over the interval before it.
    fn row(time: f64, x: f64, sum: f64) -> [f64; 5] {
        [time, x, 3.0 * sum, sum, -time]
    }

    #[test]
    fn first_row_is_the_base_of_increments() {
        let mut rows = AveragedRows::new(QUANTITIES);
        // Hand calculation: increments 1, 3 and 2 within half a unit of time each, at x = 2.
        for (time, sum) in [(0.0, 0.0), (0.5, 1.0), (1.0, 4.0), (1.5, 6.0)] {
            rows.add(&row(time, 2.0, sum));
        }
        assert_eq!(rows.series(1), [2.0; 3]);
        assert_eq!(rows.series(2), [6.0, 18.0, 12.0]);
        assert_eq!(rows.series(3), [1.0, 4.0, 6.0]);
        assert_eq!((rows.first_last_and_farthest(4), rows.from(), rows.now()), ([0.0, -1.5, 1.5], 0.0, 1.5));
    }

    /// Blocks of a long run are compared with all of its rows.
    #[test]
    fn blocks_are_means_of_their_rows() {
        let mut rows = AveragedRows::new(QUANTITIES);
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
    fn a_new_spacing_discards_earlier_rows() {
        let mut rows = AveragedRows::new(QUANTITIES);
        for time in [0.0, 1.0, 2.0, 3.0, 3.5, 4.0, 4.5] {
            rows.add(&row(time, time, 0.0));
        }
        assert_eq!((rows.series(1), rows.from()), (vec![3.5, 4.0, 4.5], 3.0));
        assert_eq!(rows.count(), 7);
    }
}
