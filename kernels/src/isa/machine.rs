//! Interface between a kernel and the machine that runs it.

use super::element::{Element, Storage};
use super::list::for_each_op;
use super::memory::LaneCounter;
use super::slot::Slot;
use super::vector::Vector;

/// Declares the method of an instruction.
macro_rules! declare {
    ($this:ident [$($about:tt)*] [$($signature:tt)*] $($form:tt)*) => {
        $($about)* $($signature)*;
    };
}

/// Machine that a kernel runs on: registers, memory at the own element and at shifts, index vectors.
///
/// One kernel runs on every machine: one that computes with SIMD registers, one that only counts, one that records. An *index
/// vector* contains element numbers from 1, as in BP93; 0 is none.
pub trait Machine: Copy {
    /// Number type of a lane.
    type Lane: Element;
    /// Vector of numbers.
    type V: Vector<Predicate = Self::P>;
    /// Vector of truth values.
    type P: super::vector::Predicate;
    /// Index vector.
    type I: Copy;

    /// Broadcasts a number to every lane: a scalar operand, which costs no operation.
    fn uniform(self, value: f64) -> Self::V;

    for_each_op!(each_instruction declare self);

    /// True if the predicate is false in every lane and the machine takes early exits; a machine without early exits returns
    /// `false`.
    fn none(self, predicate: Self::P) -> bool;

    /// Names the following operations, for the ledger and the listing.
    fn section(self, name: &'static str);
}

/// A kernel: straight-line vector code for the elements of one strip.
///
/// # Safety
/// For equal values of `self`, every call of `body` must name the same slots at the same shifts, or a subset where
/// [`Machine::none`] allows an early exit. The footprint is traced once, and later runs are checked against it.
pub unsafe trait Kernel {
    /// Number type of the kernel's registers.
    type Lane: Element;

    /// Executes the kernel on `machine`.
    fn body<M: Machine<Lane = Self::Lane>>(&self, machine: M);
}

/// True if two storage types are the same.
#[inline]
pub(crate) const fn is_same_storage<A: Storage, B: Storage>() -> bool {
    A::TABLE == B::TABLE
}
