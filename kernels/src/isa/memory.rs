//! The arrays behind a program's slots, and the check that makes their use sound.

use super::element::Storage;
use super::footprint::Footprint;
use super::slot::{Array, Slot};
use std::cell::Cell;
use std::marker::PhantomData;

/// How many counters a memory has.
pub const COUNTERS: usize = 4;

/// A counter that predicates are counted into.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counter(pub u8);

/// Why a program cannot run on a memory. Nothing was executed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ProgramError {
    /// The program names an array that is not bound.
    #[error("the program uses {array} ({element}), which is bound to no slice")]
    Unbound {
        /// Label of the array.
        array: &'static str,
        /// Element type asked for.
        element: &'static str,
    },
    /// The program writes an array that was bound for reading.
    #[error("the program writes {array}, which is bound for reading only")]
    ReadOnly {
        /// Label of the array.
        array: &'static str,
    },
    /// A slice does not cover what the program touches.
    #[error(
        "{array} must hold {before} elements before and {after} from its first element on, \
         but has {have_before} and {have_after}"
    )]
    TooShort {
        /// Label of the array.
        array: &'static str,
        /// Elements needed before the first.
        before: usize,
        /// Elements needed from the first on.
        after: usize,
        /// Elements there before the first.
        have_before: usize,
        /// Elements there from the first on.
        have_after: usize,
    },
    /// A vector length of zero was asked for.
    #[error("a strip must hold at least one element; 0 was asked for")]
    EmptyStrip,
    /// The program's order of summation is defined for one strip length only.
    #[error("this program sums in groups of {group}; strips of {asked} would change its order of summation")]
    FixedGroup {
        /// The group length the program is defined for.
        group: usize,
        /// The strip length asked for.
        asked: usize,
    },
    /// The vector length is not a multiple of the program's group.
    #[error("this program sums in groups of {group}, of which the vector length {length} is no multiple")]
    PartialGroup {
        /// The group length the program is defined for.
        group: usize,
        /// The vector length asked for.
        length: usize,
    },
    /// No strip of that many registers is compiled.
    #[error("strips of {asked} registers are not compiled; these are: {compiled:?}")]
    NoSuchBlock {
        /// Registers asked for.
        asked: usize,
        /// The lengths that programs are compiled for.
        compiled: &'static [usize],
    },
    /// The processor lacks the instruction set asked for.
    #[error("this processor has no {0}")]
    NoSuchInstructionSet(&'static str),
}

/// One slice as the machine sees it: a pointer to the element that strip position 0 meets.
#[derive(Clone, Copy)]
pub struct Column<T> {
    origin: *mut T,
    before: usize,
    after: usize,
    writable: bool,
}

impl<T: Storage> Column<T> {
    const UNBOUND: Column<T> = Column { origin: std::ptr::null_mut(), before: 0, after: 0, writable: false };

    /// Elements from the first on.
    #[inline(always)]
    pub(crate) fn len(&self) -> usize {
        self.after
    }

    /// Pointer to the element `position` places from the first.
    ///
    /// # Safety
    /// `position` lies in `-before ..= after`.
    #[inline(always)]
    pub(crate) unsafe fn at(&self, position: isize) -> *mut T {
        debug_assert!(position >= -(self.before as isize) && position <= self.after as isize);
        // SAFETY: the caller keeps the position within the slice the column was made from.
        unsafe { self.origin.offset(position) }
    }

    /// The element at `position` from the first.
    ///
    /// # Panics
    /// If there is none; an index vector with a wrong entry must not become a wrong number.
    #[inline(always)]
    pub(crate) fn read(&self, position: usize) -> T {
        assert!(position < self.after, "gather from element {position} of {}", self.after);
        // SAFETY: just checked; bound columns point to live slices.
        unsafe { *self.origin.add(position) }
    }

    /// Writes the element at `position` from the first.
    ///
    /// # Panics
    /// If there is none, or the column is read-only.
    #[inline(always)]
    pub(crate) fn write(&self, position: usize, value: T) {
        assert!(self.writable && position < self.after, "scatter to element {position} of {}", self.after);
        // SAFETY: just checked; writable columns come from exclusive borrows.
        unsafe { *self.origin.add(position) = value }
    }
}

/// The columns of one element type.
pub struct Columns<T>([Column<T>; Array::ALL.len()]);

impl<T: Storage> Default for Columns<T> {
    fn default() -> Self {
        Columns([Column::UNBOUND; Array::ALL.len()])
    }
}

/// The arrays a program runs on, bound to its slots.
///
/// Slices are borrowed for as long as the memory lives; a mutable one exclusively.
#[derive(Default)]
pub struct Memory<'a> {
    pub(crate) f64s: Columns<f64>,
    pub(crate) f32s: Columns<f32>,
    pub(crate) u32s: Columns<u32>,
    counters: [Cell<u64>; COUNTERS],
    borrow: PhantomData<&'a mut ()>,
}

impl<'a> Memory<'a> {
    /// An empty memory.
    pub fn new() -> Self {
        Memory::default()
    }

    /// Binds a slice for reading; strip position 0 meets `slice[lead]`.
    ///
    /// # Panics
    /// If `lead` lies beyond the slice.
    #[must_use]
    pub fn read<T: Storage>(mut self, slot: Slot<T>, slice: &'a [T], lead: usize) -> Self {
        assert!(lead <= slice.len(), "{}: lead {lead} of {}", slot.array().label(), slice.len());
        T::columns_mut(&mut self).0[slot.array() as usize] = Column {
            // SAFETY: `lead` lies within the slice; the column is never written through.
            origin: unsafe { slice.as_ptr().add(lead) }.cast_mut(),
            before: lead,
            after: slice.len() - lead,
            writable: false,
        };
        self
    }

    /// Binds a slice for reading and writing; strip position 0 meets `slice[lead]`.
    ///
    /// # Panics
    /// If `lead` lies beyond the slice.
    #[must_use]
    pub fn write<T: Storage>(mut self, slot: Slot<T>, slice: &'a mut [T], lead: usize) -> Self {
        assert!(lead <= slice.len(), "{}: lead {lead} of {}", slot.array().label(), slice.len());
        let after = slice.len() - lead;
        T::columns_mut(&mut self).0[slot.array() as usize] = Column {
            // SAFETY: `lead` lies within the slice.
            origin: unsafe { slice.as_mut_ptr().add(lead) },
            before: lead,
            after,
            writable: true,
        };
        self
    }

    #[inline(always)]
    pub(crate) fn column<T: Storage>(&self, slot: Slot<T>) -> &Column<T> {
        &T::columns(self).0[slot.array() as usize]
    }

    /// What was counted into `counter` so far.
    pub fn counted(&self, counter: Counter) -> u64 {
        self.counters[counter.0 as usize].get()
    }

    #[inline(always)]
    pub(crate) fn count(&self, counter: Counter, more: u64) {
        let cell = &self.counters[counter.0 as usize];
        cell.set(cell.get() + more);
    }

    /// Whether every element that a program of `footprint` touches over `n` strip positions exists.
    ///
    /// # Errors
    /// Names the first array that is unbound, too short, or not writable though written.
    pub fn admit(&self, footprint: &Footprint, n: usize) -> Result<(), ProgramError> {
        for access in footprint.accesses() {
            let (before, after, writable) = match access.element {
                f64::NAME => self.extent::<f64>(access.array),
                f32::NAME => self.extent::<f32>(access.array),
                _ => self.extent::<u32>(access.array),
            }
            .ok_or(ProgramError::Unbound { array: access.array.label(), element: access.element })?;
            if access.writes && !writable {
                return Err(ProgramError::ReadOnly { array: access.array.label() });
            }
            let need_before = access.lowest.min(0).unsigned_abs();
            let need_after = if access.strided { n + access.highest.max(0) as usize } else { 0 };
            if need_before > before || need_after > after {
                return Err(ProgramError::TooShort {
                    array: access.array.label(),
                    before: need_before,
                    after: need_after,
                    have_before: before,
                    have_after: after,
                });
            }
        }
        Ok(())
    }

    fn extent<T: Storage>(&self, array: Array) -> Option<(usize, usize, bool)> {
        let column = &T::columns(self).0[array as usize];
        (!column.origin.is_null()).then_some((column.before, column.after, column.writable))
    }
}
