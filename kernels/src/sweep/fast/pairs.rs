//! Pairs of discs that finders pass to the law.

use crate::backend::Precision;

/// Elements behind the discs' own in every column that a sweep reads: two discs that never touch, which pad registers.
pub const SENTINELS: usize = 2;

/// Two discs.
pub(super) type DiscPair = [u32; 2];

/// Sequence of pairs for which the law is evaluated.
pub trait PairSequence<P> {
    /// Number of pairs.
    fn count(&self) -> usize;

    /// Two discs, and the cell offset from the reference point of the first disc's position to that of the second (length).
    ///
    /// # Panics
    /// May panic if there is no pair of that number.
    fn pair(&self, number: usize) -> (DiscPair, [P; 2]);
}

/// Two discs that may touch, and the cell offset between the reference points of their positions (length).
#[derive(Clone, Copy, Debug)]
pub(crate) struct CandidatePair<P> {
    pub(super) discs: DiscPair,
    pub(super) cell_offset: [P; 2],
}

/// A list of pairs.
#[derive(Clone, Debug, Default)]
pub struct PairBuffer<P>(pub(super) Vec<CandidatePair<P>>);

impl<P: Precision> PairBuffer<P> {
    /// Appends a pair.
    #[inline]
    pub(super) fn push(&mut self, discs: DiscPair, cell_offset: [f64; 2]) {
        self.0.push(CandidatePair { discs, cell_offset: cell_offset.map(P::from_f64) });
    }
}

impl<P: Precision> PairSequence<P> for &PairBuffer<P> {
    #[inline(always)]
    fn count(&self) -> usize {
        self.0.len()
    }
    #[inline(always)]
    fn pair(&self, number: usize) -> (DiscPair, [P; 2]) {
        let CandidatePair { discs, cell_offset } = self.0[number];
        (discs, cell_offset)
    }
}
