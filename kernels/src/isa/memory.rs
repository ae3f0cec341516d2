//! Arrays bound to a kernel's slots, and the check that makes their use sound.

use super::element::{Storage, TABLES};
use super::footprint::Footprint;
use super::slot::{Array, Slot};
use std::cell::Cell;
use std::marker::PhantomData;
use std::ops::Range;

/// Number of counters of a memory.
pub const COUNTERS: usize = 4;

/// Counter of true lanes of a predicate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LaneCounter(pub u8);

/// Reasons why a kernel cannot run on a memory. Nothing was executed, unless it was interrupted.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ProgramError {
    /// The kernel names an array that is not bound.
    #[error("array {array} ({element}) is not bound to a slice; bind it before the run")]
    Unbound {
        /// Label of the array.
        array: &'static str,
        /// Element type requested.
        element: &'static str,
    },
    /// The kernel writes an array that is bound read-only.
    #[error("array {array} is bound read-only, but the kernel writes it; bind it for writing")]
    ReadOnly {
        /// Label of the array.
        array: &'static str,
    },
    /// A slice does not cover the elements that the kernel touches.
    #[error("{array} has {length} elements, but the kernel touches elements {first} to {last}")]
    TooShort {
        /// Label of the array.
        array: &'static str,
        /// First element touched.
        first: isize,
        /// Last element touched.
        last: isize,
        /// Length of the slice.
        length: usize,
    },
    /// A strip length of zero.
    #[error("strip length 0 is too short: a strip has at least one element")]
    EmptyStrip,
    /// A law reads a field, or adds to a sum, that it does not state.
    #[error("the law uses {0} without stating it; add it to its FIELDS or SUMS")]
    Unstated(&'static str),
    /// The processor lacks the requested instruction set.
    #[error("this processor has no {0}")]
    NoSuchInstructionSet(&'static str),
    /// Interrupted on request: the output is incomplete.
    #[error("interrupted")]
    Interrupted,
}

/// A bound slice.
#[derive(Clone, Copy)]
pub(crate) struct ArrayColumn<T> {
    origin: *mut T,
    length: usize,
    writable: bool,
}

impl ArrayColumn<()> {
    const UNBOUND: ArrayColumn<()> = ArrayColumn { origin: std::ptr::null_mut(), length: 0, writable: false };
}

impl<T: Copy> ArrayColumn<T> {
    /// Reinterprets the element type.
    #[inline(always)]
    fn cast<U>(self) -> ArrayColumn<U> {
        ArrayColumn { origin: self.origin.cast(), length: self.length, writable: self.writable }
    }
}

impl<T: Storage> ArrayColumn<T> {
    /// Pointer to an element.
    ///
    /// # Safety
    /// The slice has this element, or ends before it.
    #[inline(always)]
    pub(crate) unsafe fn at(&self, position: usize) -> *mut T {
        debug_assert!(position <= self.length, "element {position} of {}", self.length);
        // SAFETY: the caller promises that the position is in the slice that the column was made from, or at its end.
        unsafe { self.origin.add(position) }
    }

    /// Element at `position`.
    ///
    /// # Panics
    /// If it does not exist; a wrong index must not become a wrong number.
    #[inline(always)]
    pub(crate) fn read(&self, position: usize) -> T {
        assert!(
            position < self.length,
            "gather from element {position}, but the array has {} elements",
            self.length
        );
        // SAFETY: the position is below the length (asserted above), and a column points to a slice of that length which the
        // memory borrows for its whole life.
        unsafe { *self.origin.add(position) }
    }

    /// Pointer to the element that an entry of an index vector numbers, counted from one. For zero the pointer must not be used.
    ///
    /// # Panics
    /// As [`ArrayColumn::read`].
    #[inline(always)]
    pub(crate) fn entry(&self, number: u32) -> *const T {
        let number = number as usize;
        assert!(
            number <= self.length,
            "gather from element {}, but the array has {} elements",
            number - 1,
            self.length
        );
        self.origin.wrapping_add(number).wrapping_sub(1)
    }

    /// Writes the element at `position`.
    ///
    /// # Panics
    /// If it does not exist, or the column is read-only.
    #[inline(always)]
    pub(crate) fn write(&self, position: usize, value: T) {
        assert!(
            self.writable && position < self.length,
            "scatter to element {position}, but the array must be writable and has {} elements",
            self.length
        );
        // SAFETY: the position is below the length (asserted above), and a column is writable only if it was made from an
        // exclusive borrow of that slice.
        unsafe { *self.origin.add(position) = value }
    }
}

/// Arrays of a kernel, bound to its slots.
///
/// Slices are borrowed for the life of the memory; mutable ones exclusively.
pub struct Memory<'a> {
    /// Columns by element type: the entries of a type's table were bound as that type.
    tables: [[ArrayColumn<()>; Array::ALL.len()]; TABLES],
    counters: [Cell<u64>; COUNTERS],
    borrow: PhantomData<&'a mut ()>,
}

impl Default for Memory<'_> {
    #[inline]
    fn default() -> Self {
        let tables = [[ArrayColumn::UNBOUND; Array::ALL.len()]; TABLES];
        Memory { tables, counters: Default::default(), borrow: PhantomData }
    }
}

impl<'a> Memory<'a> {
    /// An empty memory.
    #[inline]
    pub fn new() -> Self {
        Memory::default()
    }

    /// Binds a slice for reading.
    #[must_use]
    #[inline]
    pub fn read<T: Storage>(mut self, slot: Slot<T>, slice: &'a [T]) -> Self {
        self.bind_read(slot, slice);
        self
    }

    /// Binds a slice for reading, in place. A memory is kilobytes of columns, and [`Memory::read`] moves it at every call.
    #[inline]
    pub fn bind_read<T: Storage>(&mut self, slot: Slot<T>, slice: &'a [T]) {
        // The pointer is never written through: the column is not writable.
        let origin = slice.as_ptr().cast_mut();
        self.bind(slot, ArrayColumn { origin, length: slice.len(), writable: false });
    }

    /// Binds a slice for reading and writing.
    #[must_use]
    #[inline]
    pub fn write<T: Storage>(mut self, slot: Slot<T>, slice: &'a mut [T]) -> Self {
        self.bind_write(slot, slice);
        self
    }

    /// Binds a slice for reading and writing, in place.
    #[inline]
    pub fn bind_write<T: Storage>(&mut self, slot: Slot<T>, slice: &'a mut [T]) {
        let length = slice.len();
        self.bind(slot, ArrayColumn { origin: slice.as_mut_ptr(), length, writable: true });
    }

    #[inline]
    fn bind<T: Storage>(&mut self, slot: Slot<T>, column: ArrayColumn<T>) {
        self.tables[T::TABLE][slot.array() as usize] = column.cast();
    }

    #[inline(always)]
    pub(crate) fn column<T: Storage>(&self, slot: Slot<T>) -> ArrayColumn<T> {
        self.tables[T::TABLE][slot.array() as usize].cast()
    }

    /// Copy of the elements of an array as bytes; none if it is not bound.
    pub fn bytes(&self, array: Array, element: &str) -> Option<Vec<u8>> {
        match element {
            f64::NAME => self.copied(Slot::new(array), f64::to_ne_bytes),
            f32::NAME => self.copied(Slot::new(array), f32::to_ne_bytes),
            _ => self.copied(Slot::new(array), u32::to_ne_bytes),
        }
    }

    fn copied<T: Storage, const N: usize>(&self, slot: Slot<T>, bytes: fn(T) -> [u8; N]) -> Option<Vec<u8>> {
        let column = self.column(slot);
        let is_bound = !column.origin.is_null();
        is_bound.then(|| (0..column.length).flat_map(|at| bytes(column.read(at))).collect())
    }

    /// Current value of `counter`.
    #[inline]
    pub fn counted(&self, counter: LaneCounter) -> u64 {
        self.counters[counter.0 as usize].get()
    }

    /// Copy of the bindings with separate counters, for a part of the elements.
    ///
    /// # Safety
    /// While both are used, no element is written through one and touched through the other.
    #[inline]
    pub(crate) unsafe fn part(&self) -> Memory<'_> {
        Memory { tables: self.tables, counters: Default::default(), borrow: PhantomData }
    }

    /// Adds the counters of a part.
    #[inline]
    pub(crate) fn join(&self, counters: [u64; COUNTERS]) {
        self.counters.iter().zip(counters).for_each(|(cell, more)| cell.set(cell.get() + more));
    }

    #[inline]
    pub(crate) fn counters(&self) -> [u64; COUNTERS] {
        std::array::from_fn(|i| self.counters[i].get())
    }

    #[inline(always)]
    pub(crate) fn count(&self, counter: LaneCounter, more: u64) {
        let cell = &self.counters[counter.0 as usize];
        cell.set(cell.get() + more);
    }

    /// Checks that every element that a kernel of `footprint` touches over the elements of `range` exists.
    ///
    /// # Errors
    /// Names the first array that is unbound, too short, or written but bound read-only.
    pub fn admit(&self, footprint: &Footprint, range: &Range<usize>) -> Result<(), ProgramError> {
        for access in footprint.accesses() {
            let array = access.array.label();
            let (length, writable) = match access.element {
                f64::NAME => self.extent::<f64>(access.array),
                f32::NAME => self.extent::<f32>(access.array),
                _ => self.extent::<u32>(access.array),
            }
            .ok_or(ProgramError::Unbound { array, element: access.element })?;
            if access.writes && !writable {
                return Err(ProgramError::ReadOnly { array });
            }
            let first = range.start as isize + access.lowest;
            let last = range.end as isize - 1 + access.highest;
            if access.strided && !range.is_empty() && (first < 0 || last >= length as isize) {
                return Err(ProgramError::TooShort { array, first, last, length });
            }
        }
        Ok(())
    }

    #[inline]
    fn extent<T: Storage>(&self, array: Array) -> Option<(usize, bool)> {
        let column = self.tables[T::TABLE][array as usize];
        (!column.origin.is_null()).then_some((column.length, column.writable))
    }
}
