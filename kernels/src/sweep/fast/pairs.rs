//! Pairs of discs: what a finder hands to the law, and pairs written out.

use crate::backend::Precision;

/// Elements behind the discs' own in every column that a sweep reads: two discs that never touch, which fill up
/// registers.
pub const SENTINELS: usize = 2;

/// Two discs.
pub(super) type Pair = [u32; 2];

/// Pairs that are at most asked for their contacts as they stand.
pub trait Pairs<P> {
    /// How many.
    fn count(&self) -> usize;

    /// Two discs, and the cell offset from where the first one's place is seen from to where the second one's is (length).
    ///
    /// # Panics
    /// May, if there is no pair of that number.
    fn pair(&self, number: usize) -> (Pair, [P; 2]);
}

/// Two discs that may touch, and the cell offset between where their places are seen from (length).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Touch<P> {
    pub(super) discs: Pair,
    pub(super) cell_offset: [P; 2],
}

/// A list of pairs.
#[derive(Clone, Debug, Default)]
pub struct Touches<P>(pub(super) Vec<Touch<P>>);

impl<P: Precision> Touches<P> {
    /// Appends a pair.
    #[inline]
    pub(super) fn push(&mut self, discs: Pair, cell_offset: [f64; 2]) {
        self.0.push(Touch { discs, cell_offset: cell_offset.map(P::from_f64) });
    }
}

impl<P: Precision> Pairs<P> for &Touches<P> {
    #[inline(always)]
    fn count(&self) -> usize {
        self.0.len()
    }
    #[inline(always)]
    fn pair(&self, number: usize) -> (Pair, [P; 2]) {
        let Touch { discs, cell_offset } = self.0[number];
        (discs, cell_offset)
    }
}
