//! Declared arrays of a user's kernel, and their slices.

use super::OwnKernelError;
use crate::isa::{Array, Element, Footprint, Memory, Slot};
use std::marker::PhantomData;
use std::ops::Range;

/// An array of a kernel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeclaredArray {
    /// Its name.
    pub name: String,
    /// Lowest shift at which it is loaded, at most 0.
    pub lowest: isize,
    /// Highest shift, at least 0.
    pub highest: isize,
    /// True if the kernel stores to it.
    pub is_written: bool,
}

/// Ties slots to the kernel that declared them: no two kernels have the same `'k`.
pub(super) type Owner<'k> = PhantomData<fn(&'k ()) -> &'k ()>;

/// Arrays of a kernel under declaration.
#[derive(Debug, Default)]
pub struct Declarations<'k> {
    arrays: Vec<DeclaredArray>,
    mistake: Option<OwnKernelError>,
    owner: Owner<'k>,
}

/// Slot of an array that is loaded at the own element.
#[derive(Clone, Copy, Debug)]
pub struct ReadSlot<'k> {
    pub(super) array: Array,
    owner: Owner<'k>,
}

/// Slot of an array that is loaded at a shift.
#[derive(Clone, Copy, Debug)]
pub struct ShiftedSlot<'k> {
    pub(super) array: Array,
    pub(super) shift: isize,
    owner: Owner<'k>,
}

/// Slot of an array that is stored, and loaded at the own element.
#[derive(Clone, Copy, Debug)]
pub struct WriteSlot<'k>(pub(super) ReadSlot<'k>);

impl<'k> From<WriteSlot<'k>> for ReadSlot<'k> {
    #[inline(always)]
    fn from(slot: WriteSlot<'k>) -> ReadSlot<'k> {
        slot.0
    }
}

impl<'k> Declarations<'k> {
    /// Declares an array that is loaded at the own element.
    pub fn read(&mut self, name: &str) -> ReadSlot<'k> {
        ReadSlot { array: self.declare(name, 0, false), owner: PhantomData }
    }

    /// Declares an array that is loaded at some shifts: the distances in elements from the own one.
    pub fn read_shifted<const N: usize>(&mut self, name: &str, shifts: [isize; N]) -> [ShiftedSlot<'k>; N] {
        shifts.map(|shift| ShiftedSlot { array: self.declare(name, shift, false), shift, owner: PhantomData })
    }

    /// Declares an array that is stored; it may also be loaded, at the own element.
    pub fn write(&mut self, name: &str) -> WriteSlot<'k> {
        WriteSlot(ReadSlot { array: self.declare(name, 0, true), owner: PhantomData })
    }

    fn declare(&mut self, name: &str, shift: isize, is_written: bool) -> Array {
        let at = self.arrays.iter().position(|array| array.name == name).unwrap_or_else(|| {
            let array = DeclaredArray { name: name.to_owned(), lowest: 0, highest: 0, is_written: false };
            self.arrays.push(array);
            self.arrays.len() - 1
        });
        let array = &mut self.arrays[at];
        if is_written && array.is_written {
            self.mistake.get_or_insert(OwnKernelError::DeclaredTwice(name.to_owned()));
        }
        array.is_written |= is_written;
        (array.lowest, array.highest) = (array.lowest.min(shift), array.highest.max(shift));
        if array.is_written && (array.lowest, array.highest) != (0, 0) {
            self.mistake.get_or_insert(OwnKernelError::WrittenAndShifted(name.to_owned()));
        }
        // Beyond the limit the declaration is refused as a whole.
        Array::own(at).unwrap_or(Array::Own0)
    }

    /// The arrays.
    pub(super) fn finished(self) -> Result<Vec<DeclaredArray>, OwnKernelError> {
        let (count, most) = (self.arrays.len(), Array::OWN);
        match self.mistake {
            _ if count > most => Err(OwnKernelError::TooManyArrays(count, most)),
            Some(mistake) => Err(mistake),
            None => Ok(self.arrays),
        }
    }
}

/// Everything that a kernel with some arrays may access.
pub(super) fn footprint(arrays: &[DeclaredArray], element: &'static str) -> Footprint {
    let mut footprint = Footprint::default();
    for (number, array) in arrays.iter().enumerate() {
        let Some(own) = Array::own(number) else { continue };
        for shift in [array.lowest, array.highest] {
            footprint.record(own, element, Some(shift), array.is_written);
        }
    }
    footprint
}

/// Slices of the arrays of a kernel, bound by name.
pub struct OwnMemory<'a, L> {
    memory: Memory<'a>,
    arrays: &'a [DeclaredArray],
    lengths: Vec<Option<usize>>,
    element: PhantomData<L>,
}

impl<'a, L: Element> OwnMemory<'a, L> {
    pub(super) fn new(arrays: &'a [DeclaredArray]) -> OwnMemory<'a, L> {
        let lengths = vec![None; arrays.len()];
        OwnMemory { memory: Memory::new(), arrays, lengths, element: PhantomData }
    }

    /// Binds an array for reading.
    ///
    /// # Errors
    /// If the kernel has no such array, or writes it.
    pub fn read(mut self, name: &str, values: &'a [L]) -> Result<Self, OwnKernelError> {
        let slot = self.slot(name, values.len())?;
        if self.arrays.iter().any(|array| array.name == name && array.is_written) {
            return Err(OwnKernelError::ReadOnly(name.to_owned()));
        }
        self.memory.bind_read(slot, values);
        Ok(self)
    }

    /// Binds an array for reading and writing.
    ///
    /// # Errors
    /// If the kernel has no such array.
    pub fn write(mut self, name: &str, values: &'a mut [L]) -> Result<Self, OwnKernelError> {
        let slot = self.slot(name, values.len())?;
        self.memory.bind_write(slot, values);
        Ok(self)
    }

    fn slot(&mut self, name: &str, length: usize) -> Result<Slot<L>, OwnKernelError> {
        let at = self.arrays.iter().position(|array| array.name == name);
        let found = at.and_then(|at| Some((at, Array::own(at)?)));
        let (at, array) = found.ok_or_else(|| OwnKernelError::UnknownArray {
            name: name.to_owned(),
            known: self.arrays.iter().map(|array| array.name.clone()).collect(),
        })?;
        self.lengths[at] = Some(length);
        Ok(Slot::new(array))
    }

    /// The memory, with all arrays bound, of one length, and long enough for a range of elements.
    pub(super) fn checked(&self, range: &Range<usize>) -> Result<&Memory<'a>, OwnKernelError> {
        let mut first: Option<(&DeclaredArray, usize)> = None;
        for (array, length) in self.arrays.iter().zip(&self.lengths) {
            let length = length.ok_or_else(|| OwnKernelError::Unbound(array.name.clone()))?;
            let (other, expected) = *first.get_or_insert((array, length));
            if length != expected {
                let (name, other) = (array.name.clone(), other.name.clone());
                return Err(OwnKernelError::Length { name, length, other, expected });
            }
            let (low, high) = (range.start as isize + array.lowest, range.end as isize - 1 + array.highest);
            if !range.is_empty() && (low < 0 || high >= length as isize) {
                let (name, last) = (array.name.clone(), length.saturating_sub(1));
                return Err(OwnKernelError::Range { name, last, first: low, end: high });
            }
        }
        Ok(&self.memory)
    }

    /// Arrays as bound, for emitted code.
    pub fn bound(&self) -> &Memory<'a> {
        &self.memory
    }
}
