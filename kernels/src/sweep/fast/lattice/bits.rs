//! Bit set with one bit per cell of a padded lattice.

use crate::sweep::lattice::LatticeShape;

/// Bits by position in the padded lattice.
#[derive(Clone, Debug)]
pub(super) struct CellBits(Vec<u64>);

impl CellBits {
    /// No bit set.
    #[inline]
    pub(super) fn new(shape: &LatticeShape, half_width: usize) -> Self {
        // Reads from the last cell reach this far.
        let last = shape.padded() + half_width * (shape.stride() + 1) + 64;
        CellBits(vec![0; last.div_ceil(64) + 2])
    }

    #[inline]
    pub(super) fn set(&mut self, position: usize, bit: bool) {
        let (word, mask) = (&mut self.0[position / 64], 1 << (position % 64));
        if bit { *word |= mask } else { *word &= !mask }
    }

    /// Number of positions from which [`bits_from`](Self::bits_from) may read.
    #[inline]
    pub(super) fn positions(&self) -> usize {
        (self.0.len() - 1) * 64
    }

    /// 64 bits from a position on; the bit of the position itself is the lowest.
    ///
    /// # Safety
    /// `position` is below [`positions`](Self::positions).
    #[inline(always)]
    pub(super) unsafe fn bits_from(&self, position: usize) -> u64 {
        let (word, shift) = (position / 64, position % 64);
        // SAFETY: the position is below (words − 1)·64, by the caller's promise, so this word and the next exist.
        unsafe {
            (*self.0.get_unchecked(word) >> shift) | ((*self.0.get_unchecked(word + 1) << 1) << (63 - shift))
        }
    }
}
