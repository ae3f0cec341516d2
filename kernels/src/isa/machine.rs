//! What a kernel text may ask of the machine.

use super::element::{Element, Storage};
use super::memory::Counter;
use super::slot::Slot;
use super::vector::Vector;

/// The machine that a text runs on: registers, memory at the own place and at shifts, index vectors.
///
/// One text runs on every machine: one that computes with SIMD registers, one that only counts, one that records.
/// An *index vector* holds element numbers from 1, as in the source; 0 is none.
pub trait Machine: Copy {
    /// The number a lane holds.
    type Lane: Element;
    /// A vector of numbers.
    type V: Vector<Predicate = Self::P>;
    /// A vector of truth values.
    type P: super::vector::Predicate;
    /// An index vector.
    type I: Copy;

    /// The same number in every lane: a scalar operand, which costs no operation.
    fn uniform(self, value: f64) -> Self::V;

    /// Loads at the own place.
    fn load<T: Element>(self, slot: Slot<T>) -> Self::V;
    /// Loads `shift` elements from the own place.
    fn load_shifted<T: Element>(self, slot: Slot<T>, shift: isize) -> Self::V;
    /// Stores at the own place.
    fn store<T: Element>(self, slot: Slot<T>, value: Self::V);

    /// The element numbers, from 1.
    fn numbers(self) -> Self::V;
    /// Numbers to an index vector; what is no element number (negative, not a number) becomes 0, none.
    fn to_index(self, numbers: Self::V) -> Self::I;
    /// An index vector to numbers.
    fn index_numbers(self, index: Self::I) -> Self::V;
    /// Loads an index vector at the own place.
    fn load_index(self, slot: Slot<u32>) -> Self::I;
    /// Stores an index vector at the own place.
    fn store_index(self, slot: Slot<u32>, value: Self::I);

    /// Loads the elements that `index` numbers; `elsewhere` where it numbers none.
    ///
    /// # Panics
    /// If a number lies beyond the array.
    fn gather<T: Element>(self, slot: Slot<T>, index: Self::I, elsewhere: Self::V) -> Self::V;
    /// Loads the entries of an index vector that `index` numbers; none where it numbers none.
    ///
    /// # Panics
    /// If a number lies beyond the array.
    fn gather_index(self, slot: Slot<u32>, index: Self::I) -> Self::I;
    /// Stores `value` at the elements that `index` numbers, in element order: of two at one place the later stays.
    ///
    /// # Panics
    /// If a number lies beyond the array.
    fn scatter_index(self, slot: Slot<u32>, index: Self::I, value: Self::I);
    /// The same for numbers.
    ///
    /// # Panics
    /// If a number lies beyond the array.
    fn scatter<T: Element>(self, slot: Slot<T>, index: Self::I, value: Self::V);

    /// Adds how many lanes hold to `counter`.
    fn count(self, counter: Counter, predicate: Self::P);
    /// Whether no lane holds, where the machine takes early ways out; a machine that does not says `false`.
    fn none(self, predicate: Self::P) -> bool;

    /// Names what the following operations do, for the ledger and the listing.
    fn section(self, name: &'static str);
}

/// A kernel text: straight-line vector code for the elements of one strip.
///
/// # Safety
/// Whenever `body` is called on equal values of `self`, it must name the same slots at the same shifts (or a subset,
/// where [`Machine::none`] lets it leave early): the footprint traced once is what later runs are checked against.
pub unsafe trait Text {
    /// The number the text's registers hold.
    type Lane: Element;

    /// The text.
    fn body<M: Machine<Lane = Self::Lane>>(&self, machine: M);
}

/// Whether two storage types are the same.
#[inline]
pub(crate) const fn same<A: Storage, B: Storage>() -> bool {
    A::TABLE == B::TABLE
}
