//! Pairs of discs that finders pass to the law.

use crate::backend::Precision;

/// Elements behind the discs' own in every column that a sweep reads: two discs that never touch, which pad registers.
pub const SENTINELS: usize = 2;

/// Two discs.
pub(super) type Pair = [u32; 2];

/// Sequence of pairs for which the law is evaluated.
pub trait Pairs<P> {
    /// Number of pairs.
    fn count(&self) -> usize;

    /// Two discs, and the cell offset from the reference point of the first disc's position to that of the second (length).
    ///
    /// # Panics
    /// May panic if there is no pair of that number.
    fn pair(&self, number: usize) -> (Pair, [P; 2]);
}

/// Two discs that may touch, and the cell offset between the reference points of their positions (length).
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
