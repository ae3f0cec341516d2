//! Vector registers stored one behind the other in memory, close together for short and long strips alike.

use crate::isa::aligned_column::{self, AlignedColumn, LINE};
use std::cell::Cell;

/// Cache lines after which addresses map to the same line of a first-level cache.
const ALIKE: usize = aligned_column::ALIKE / LINE;
/// Least distance of long registers in cache lines, modulo that period.
const APART: usize = 9;

/// Register file with entries `X`.
pub(super) struct RegisterFile<X> {
    entries: AlignedColumn<Cell<X>>,
    /// Entries from one register to the next.
    stride: usize,
}

impl<X> Default for RegisterFile<X> {
    fn default() -> Self {
        RegisterFile { entries: AlignedColumn::default(), stride: 0 }
    }
}

impl<X: Copy> RegisterFile<X> {
    /// Allocates `count` registers of at least `length` entries. Entries may have values of an earlier use.
    #[inline(always)]
    pub(super) fn provide(&mut self, count: usize, length: usize, entry: X) {
        let in_line = (LINE / size_of::<X>().max(1)).max(1);
        self.stride = in_line * lines_apart(length.div_ceil(in_line));
        let needed = count * self.stride;
        if self.entries.len() < needed {
            // The old entries need no copy; they are freed before the new ones are allocated.
            self.entries = AlignedColumn::default();
            self.entries = AlignedColumn::filled(0, Cell::new(entry), needed);
        }
    }

    /// Entries of a register.
    ///
    /// # Panics
    /// If there is no register of that number.
    #[inline(always)]
    pub(super) fn register(&self, number: u32) -> &[Cell<X>] {
        let start = self.stride * number as usize;
        &self.entries[start..start + self.stride]
    }
}

/// Cache lines from one register of `lines` lines to the next. The number is odd, so that registers spread over the whole cache.
/// For long registers it also ensures that a pass does not write to addresses that the processor confuses with those it reads.
fn lines_apart(lines: usize) -> usize {
    let mut apart = lines | 1;
    while lines >= ALIKE / 2 && !(APART..=ALIKE - APART).contains(&(apart % ALIKE)) {
        apart += 2;
    }
    apart
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn registers_are_disjoint_and_spread_over_the_cache() {
        for lines in 0..1000 {
            let apart = lines_apart(lines);
            assert!(apart >= lines && apart % 2 == 1 && apart < lines + 2 * APART + 2, "{lines}: {apart}");
            assert!(lines < 32 || (9..=55).contains(&(apart % 64)), "{lines}: {apart}");
        }
        let mut file: RegisterFile<u64> = RegisterFile::default();
        for (count, length) in [(3, 1), (2, 100), (5, 7)] {
            file.provide(count, length, 0);
            for number in 0..count {
                file.register(number as u32)[..length].iter().for_each(|entry| entry.set(number as u64));
            }
            for number in 0..count {
                let register = &file.register(number as u32)[..length];
                assert!(register.iter().all(|entry| entry.get() == number as u64), "{number}");
            }
        }
    }
}
