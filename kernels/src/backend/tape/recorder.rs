//! The machine that records: every operation of a text becomes an instruction on a tape.

use super::instruction::{Action, File, Instruction, Operand, Reference, RegisterName};
use crate::isa::{Counter, Element, Machine, Op, Predicate, Slot, Storage, Vector};
use std::cell::{Cell, RefCell};
use std::ops::{Add, Div, Mul, Sub};

/// Collects instructions while a text runs on it; every result gets a register of its own.
pub(super) struct Recorder<L> {
    pub(super) instructions: RefCell<Vec<Instruction<L>>>,
    pub(super) sections: RefCell<Vec<&'static str>>,
    section: Cell<usize>,
    registers: Cell<u32>,
}

impl<L: Element> Recorder<L> {
    pub(super) fn new() -> Self {
        Recorder {
            instructions: RefCell::default(),
            sections: RefCell::new(vec!["body"]),
            section: Cell::new(0),
            registers: Cell::new(0),
        }
    }

    fn push(&self, op: Op, to: Option<RegisterName>, action: Action<L>) {
        let section = self.section.get();
        self.instructions.borrow_mut().push(Instruction { op, section, to, action });
    }

    fn emit(&self, op: Op, file: File, action: Action<L>) -> RegisterName {
        let name = RegisterName { file, number: self.registers.get() };
        self.registers.set(name.number + 1);
        self.push(op, Some(name), action);
        name
    }
}

/// A vector of numbers that is being recorded: a register, or a number known already.
#[derive(Clone, Copy)]
pub(super) struct Value<'t, L> {
    recorder: &'t Recorder<L>,
    operand: Operand<L>,
}

/// A predicate that is being recorded.
#[derive(Clone, Copy)]
pub(super) struct TruthValue<'t, L> {
    recorder: &'t Recorder<L>,
    register: RegisterName,
}

impl<L: Element> Value<'_, L> {
    /// Arithmetic between scalar operands is done at once: no vector machine would spend an instruction on it.
    fn binary(self, op: Op, other: Self, known: impl Fn(L, L) -> L) -> Self {
        let operand = match (self.operand, other.operand) {
            (Operand::Uniform(a), Operand::Uniform(b)) => Operand::Uniform(known(a, b)),
            (a, b) => Operand::Register(self.recorder.emit(op, File::Number, Action::Binary(a, b))),
        };
        Value { recorder: self.recorder, operand }
    }

    fn unary(self, op: Op, known: impl Fn(L) -> L) -> Self {
        let operand = match self.operand {
            Operand::Uniform(a) => Operand::Uniform(known(a)),
            a => Operand::Register(self.recorder.emit(op, File::Number, Action::Unary(a))),
        };
        Value { recorder: self.recorder, operand }
    }
}

impl<'t, L: Element> Value<'t, L> {
    fn compare(self, op: Op, other: Self) -> TruthValue<'t, L> {
        let action = Action::Compare(self.operand, other.operand);
        TruthValue { recorder: self.recorder, register: self.recorder.emit(op, File::Predicate, action) }
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, $op:ident) => {
        impl<L: Element> $trait for Value<'_, L> {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                self.binary(Op::$op, other, |a, b| a.$method(b))
            }
        }
    };
}
operator!(Add, add, Add);
operator!(Sub, sub, Subtract);
operator!(Mul, mul, Multiply);
operator!(Div, div, Divide);

impl<L: Element> Predicate for TruthValue<'_, L> {
    fn and(self, other: Self) -> Self {
        let action = Action::Logic(self.register, Some(other.register));
        TruthValue { register: self.recorder.emit(Op::And, File::Predicate, action), ..self }
    }
    fn not(self) -> Self {
        let action = Action::Logic(self.register, None);
        TruthValue { register: self.recorder.emit(Op::Not, File::Predicate, action), ..self }
    }
}

impl<'t, L: Element> Vector for Value<'t, L> {
    type Predicate = TruthValue<'t, L>;

    fn sqrt(self) -> Self {
        self.unary(Op::SquareRoot, L::sqrt)
    }
    fn abs(self) -> Self {
        self.unary(Op::Absolute, L::abs)
    }
    fn truncate(self) -> Self {
        self.unary(Op::Truncate, L::truncate)
    }
    fn min(self, other: Self) -> Self {
        self.binary(Op::Minimum, other, L::min)
    }
    fn max(self, other: Self) -> Self {
        self.binary(Op::Maximum, other, L::max)
    }
    fn less_than(self, other: Self) -> Self::Predicate {
        self.compare(Op::LessThan, other)
    }
    fn less_equal(self, other: Self) -> Self::Predicate {
        self.compare(Op::LessEqual, other)
    }
    fn equal(self, other: Self) -> Self::Predicate {
        self.compare(Op::Equal, other)
    }
    fn select(predicate: Self::Predicate, holds: Self, fails: Self) -> Self {
        let action = Action::Select(predicate.register, holds.operand, fails.operand);
        let recorder = predicate.recorder;
        Value { recorder, operand: Operand::Register(recorder.emit(Op::Select, File::Number, action)) }
    }
}

/// The recording machine itself.
#[derive(Clone, Copy)]
pub(super) struct Recording<'t, L>(pub(super) &'t Recorder<L>);

impl<'t, L: Element> Recording<'t, L> {
    fn number(self, op: Op, action: Action<L>) -> Value<'t, L> {
        Value { recorder: self.0, operand: Operand::Register(self.0.emit(op, File::Number, action)) }
    }
}

fn reference<T: Storage>(slot: Slot<T>, shift: isize) -> Reference {
    Reference { array: slot.array(), element: T::NAME, shift }
}

impl<'t, L: Element> Machine for Recording<'t, L> {
    type Lane = L;
    type V = Value<'t, L>;
    type P = TruthValue<'t, L>;
    type I = RegisterName;

    fn uniform(self, value: f64) -> Value<'t, L> {
        Value { recorder: self.0, operand: Operand::Uniform(L::from_f64(value)) }
    }
    fn load<T: Element>(self, slot: Slot<T>) -> Value<'t, L> {
        self.number(Op::Load, Action::Load(reference(slot, 0)))
    }
    fn load_shifted<T: Element>(self, slot: Slot<T>, shift: isize) -> Value<'t, L> {
        self.number(Op::LoadShifted, Action::Load(reference(slot, shift)))
    }
    fn store<T: Element>(self, slot: Slot<T>, value: Value<'t, L>) {
        self.0.push(Op::Store, None, Action::Store(reference(slot, 0), value.operand));
    }
    fn numbers(self) -> Value<'t, L> {
        self.number(Op::Numbers, Action::Numbers)
    }
    fn to_index(self, numbers: Value<'t, L>) -> RegisterName {
        self.0.emit(Op::ToIndex, File::Index, Action::ToIndex(numbers.operand))
    }
    fn index_numbers(self, index: RegisterName) -> Value<'t, L> {
        self.number(Op::FromIndex, Action::FromIndex(index))
    }
    fn load_index(self, slot: Slot<u32>) -> RegisterName {
        self.0.emit(Op::Load, File::Index, Action::LoadIndex(reference(slot, 0)))
    }
    fn store_index(self, slot: Slot<u32>, value: RegisterName) {
        self.0.push(Op::Store, None, Action::StoreIndex(reference(slot, 0), value));
    }
    fn gather<T: Element>(self, slot: Slot<T>, index: RegisterName, elsewhere: Value<'t, L>) -> Value<'t, L> {
        self.number(Op::Gather, Action::Gather(reference(slot, 0), index, elsewhere.operand))
    }
    fn gather_index(self, slot: Slot<u32>, index: RegisterName) -> RegisterName {
        self.0.emit(Op::Gather, File::Index, Action::GatherIndex(reference(slot, 0), index))
    }
    fn scatter_index(self, slot: Slot<u32>, index: RegisterName, value: RegisterName) {
        self.0.push(Op::Scatter, None, Action::ScatterIndex(reference(slot, 0), index, value));
    }
    fn count(self, counter: Counter, predicate: TruthValue<'t, L>) {
        self.0.push(Op::Count, None, Action::Count(predicate.register, counter.0));
    }
    fn none(self, _: TruthValue<'t, L>) -> bool {
        // A tape is straight-line: it holds every operation, as the CRAY executed them.
        false
    }
    fn section(self, name: &'static str) {
        let mut sections = self.0.sections.borrow_mut();
        let found = sections.iter().position(|&section| section == name);
        self.0.section.set(found.unwrap_or_else(|| {
            sections.push(name);
            sections.len() - 1
        }));
    }
}
