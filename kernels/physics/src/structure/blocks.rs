//! Sums over blocks of time: the number of blocks is bounded, however long a run is.

/// Largest number of blocks; beyond it, pairs of blocks are merged.
pub(super) const MOST: usize = 32;

/// Sums of a function's values over samples, in blocks of equally many samples.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Blocks {
    width: usize,
    /// Samples of a block.
    length: u64,
    /// Sums and then weights of the values, for each block.
    rows: Vec<Vec<f64>>,
}

impl Blocks {
    /// Empty blocks of a function with `width` values, at least one.
    pub(crate) fn new(width: usize) -> Blocks {
        Blocks { width: width.max(1), length: 1, rows: vec![] }
    }

    /// Restores blocks from [`Blocks::length`] and [`Blocks::column`]; none if they do not fit a function of `width` values.
    pub(crate) fn restored(width: usize, length: u64, column: &[f64]) -> Option<Blocks> {
        let width = width.max(1);
        let fits = length.is_power_of_two() && column.len().is_multiple_of(2 * width);
        let rows: Vec<Vec<f64>> = column.chunks(2 * width).map(<[f64]>::to_vec).collect();
        (fits && rows.len() <= MOST).then_some(Blocks { width, length, rows })
    }

    /// Samples of a block.
    pub(crate) fn length(&self) -> u64 {
        self.length
    }

    /// All sums in one column.
    pub(crate) fn column(&self) -> Vec<f64> {
        self.rows.concat()
    }

    /// Adds a weighted value of a sample; samples are numbered from 0.
    pub(crate) fn add(&mut self, look: u64, place: usize, value: f64, weight: f64) {
        while look / self.length >= MOST as u64 {
            self.length *= 2;
            let pairs = self.rows.chunks(2);
            let sum = |pair: &[Vec<f64>]| match pair {
                [a, b] => a.iter().zip(b).map(|(a, b)| a + b).collect(),
                _ => pair.concat(),
            };
            self.rows = pairs.map(sum).collect();
        }
        let block = (look / self.length) as usize;
        if self.rows.len() <= block {
            self.rows.resize(block + 1, vec![0.0; 2 * self.width]);
        }
        self.rows[block][place] += weight * value;
        self.rows[block][self.width + place] += weight;
    }

    /// Means of the complete blocks of the second half of `looks` samples, without the `last` blocks at the end, each with its weights. The first
    /// half is treated as the transient. A mean without weight is NaN.
    pub(crate) fn second_half(&self, looks: u64, last: usize) -> Vec<Block> {
        let whole = ((looks / self.length) as usize).min(self.rows.len()).saturating_sub(last);
        let mean = |row: &Vec<f64>| {
            let (sums, weights) = row.split_at(self.width);
            Block {
                means: sums.iter().zip(weights).map(|(sum, weight)| sum / weight).collect(),
                weights: weights.to_vec(),
            }
        };
        self.rows[whole.div_ceil(2)..whole].iter().map(mean).collect()
    }
}

/// Means of a function over a block of samples.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Block {
    pub means: Vec<f64>,
    /// Weights of the means.
    pub(crate) weights: Vec<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each block is the mean of its own samples, and there are 8 to 16 of them for any number of samples.
    #[test]
    fn blocks_are_means_of_their_samples() {
        for looks in [1_u64, 2, 31, 32, 33, 100, 1000] {
            let mut blocks = Blocks::new(2);
            for look in 0..looks {
                blocks.add(look, 0, look as f64, 1.0);
                blocks.add(look, 1, 1.0, if look % 2 == 0 { 3.0 } else { 0.5 });
            }
            let half = blocks.second_half(looks, 0);
            let whole = looks / blocks.length();
            assert!(whole <= 32 && (looks < 32 || half.len() >= 8), "{looks}: {}", half.len());
            let first = whole.div_ceil(2);
            for (block, at) in half.iter().zip(first..) {
                let middle = (at as f64 + 0.5) * blocks.length() as f64 - 0.5;
                assert_eq!(block.means[..], [middle, 1.0], "{looks}");
            }
            let again = Blocks::restored(2, blocks.length(), &blocks.column());
            assert_eq!(again.as_ref(), Some(&blocks));
        }
        assert_eq!(Blocks::restored(2, 3, &[]), None);
        assert_eq!(Blocks::restored(2, 1, &[0.0]), None);
    }
}
