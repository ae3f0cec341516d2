//! Pairs of discs that finders pass to the law.

use crate::backend::{Precision, QUAD};

/// Records behind those of the discs: two discs that never touch, which pad registers.
pub const SENTINELS: usize = 2;

/// Two discs.
pub(super) type DiscPair = [u32; 2];

/// Vector from the reference point of the first disc's position to that of the second (length), and two zeros.
pub type CellOffset<P> = [P; QUAD];

/// The cell offset along x and y (length).
#[inline]
pub(super) fn cell_offset<P: Precision>([x, y]: [f64; 2]) -> CellOffset<P> {
    [P::from_f64(x), P::from_f64(y), P::default(), P::default()]
}

/// Sequence of pairs for which the law is evaluated.
pub trait PairSequence<P> {
    /// Number of pairs.
    fn count(&self) -> usize;

    /// Two discs, and the number of their cell offset.
    ///
    /// # Panics
    /// May panic if there is no pair of that number.
    fn pair(&self, number: usize) -> (DiscPair, u32);

    /// Cell offsets by their number.
    fn cell_offsets(&self) -> &[CellOffset<P>];
}

/// Two discs that may touch, and the number of their cell offset.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CandidatePair {
    pub(super) discs: DiscPair,
    pub(super) cell_offset: u32,
}

/// A list of pairs.
#[derive(Clone, Debug, Default)]
pub struct PairBuffer<P> {
    pub(super) pairs: Vec<CandidatePair>,
    pub(super) cell_offsets: Vec<CellOffset<P>>,
}

impl<P: Precision> PairBuffer<P> {
    /// Appends a pair with a cell offset of its own.
    #[inline]
    pub(super) fn push(&mut self, discs: DiscPair, along: [f64; 2]) {
        self.pairs.push(CandidatePair { discs, cell_offset: self.cell_offsets.len() as u32 });
        self.cell_offsets.push(cell_offset(along));
    }
}

impl<P: Precision> PairSequence<P> for &PairBuffer<P> {
    #[inline(always)]
    fn count(&self) -> usize {
        self.pairs.len()
    }
    #[inline(always)]
    fn pair(&self, number: usize) -> (DiscPair, u32) {
        let CandidatePair { discs, cell_offset } = self.pairs[number];
        (discs, cell_offset)
    }
    #[inline(always)]
    fn cell_offsets(&self) -> &[CellOffset<P>] {
        &self.cell_offsets
    }
}
