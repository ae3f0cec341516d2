//! A bit for every cell of a padded lattice.

use crate::sweep::lattice::LatticeShape;

/// Bits by position in the padded lattice.
#[derive(Clone, Debug)]
pub(super) struct Bits(Vec<u64>);

impl Bits {
    /// No bit set.
    #[inline]
    pub(super) fn new(shape: &LatticeShape, half_width: usize) -> Self {
        // A look from the last cell reaches so far.
        let last = shape.padded() + half_width * (shape.stride() + 1) + 64;
        Bits(vec![0; last.div_ceil(64) + 2])
    }

    #[inline]
    pub(super) fn set(&mut self, position: usize, bit: bool) {
        let (word, mask) = (&mut self.0[position / 64], 1 << (position % 64));
        if bit { *word |= mask } else { *word &= !mask }
    }

    /// How many positions [`from`](Self::from) may be asked for.
    #[inline]
    pub(super) fn positions(&self) -> usize {
        (self.0.len() - 1) * 64
    }

    /// The bits from a position on, the position's own lowest.
    ///
    /// # Safety
    /// `position` is below [`positions`](Self::positions).
    #[inline(always)]
    pub(super) unsafe fn from(&self, position: usize) -> u64 {
        let (word, shift) = (position / 64, position % 64);
        // SAFETY: the position is below (words − 1)·64, by the caller's promise, so this word and the next exist.
        unsafe {
            (*self.0.get_unchecked(word) >> shift) | ((*self.0.get_unchecked(word + 1) << 1) << (63 - shift))
        }
    }
}
