//! What a kernel text may ask of the machine.

use super::element::{Element, Storage};
use super::list::for_each_op;
use super::memory::Counter;
use super::slot::Slot;
use super::vector::Vector;

/// The method of an instruction.
macro_rules! declare {
    ($this:ident [$($about:tt)*] [$($signature:tt)*] $($form:tt)*) => {
        $($about)* $($signature)*;
    };
}

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

    for_each_op!(each_instruction declare self);

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
