//! Machine of a user's body: it accesses declared arrays only.

use super::arrays::{Owner, ReadSlot, ShiftedSlot, WriteSlot};
use crate::isa::{Machine, Slot};
use std::marker::PhantomData;

/// Machine that the body of a user's kernel runs on. It takes slots of the kernel `'k`.
pub struct OwnMachine<'k, M> {
    machine: M,
    owner: Owner<'k>,
}

impl<M: Copy> Clone for OwnMachine<'_, M> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}
impl<M: Copy> Copy for OwnMachine<'_, M> {}

impl<'k, M: Machine> OwnMachine<'k, M> {
    #[inline(always)]
    pub(super) fn new(machine: M) -> OwnMachine<'k, M> {
        OwnMachine { machine, owner: PhantomData }
    }

    /// Broadcasts a number to every lane, which costs no operation.
    #[inline(always)]
    pub fn uniform(self, value: f64) -> M::V {
        self.machine.uniform(value)
    }

    /// The element numbers, from 1.
    #[inline(always)]
    pub fn numbers(self) -> M::V {
        self.machine.numbers()
    }

    /// Loads the own element.
    #[inline(always)]
    pub fn load(self, slot: impl Into<ReadSlot<'k>>) -> M::V {
        self.machine.load(Slot::<M::Lane>::new(slot.into().array))
    }

    /// Loads the element at the shift of the slot.
    #[inline(always)]
    pub fn load_shifted(self, slot: ShiftedSlot<'k>) -> M::V {
        self.machine.load_shifted(Slot::<M::Lane>::new(slot.array), slot.shift)
    }

    /// Stores to the own element.
    #[inline(always)]
    pub fn store(self, slot: WriteSlot<'k>, value: M::V) {
        self.machine.store(Slot::<M::Lane>::new(slot.0.array), value);
    }

    /// Names the following operations, for counts and listings.
    #[inline(always)]
    pub fn section(self, name: &'static str) {
        self.machine.section(name);
    }
}
