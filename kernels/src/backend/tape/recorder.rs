//! Recording machine: every operation of a kernel becomes an instruction on a tape.

use super::instruction::{
    ArrayReference, Effect, Indices, Instruction, Number, Operand, PredicateInstruction, RegisterKind,
    RegisterName, TapeAction,
};
use crate::backend::values::{implement_operator, implement_predicate, implement_vector};
use crate::isa::list::for_each_op;
use crate::isa::op::{BinaryOp, CompareOp, ConnectiveOp, NegationOp, UnaryOp};
use crate::isa::{Element, LaneCounter, Machine, Predicate, Slot, Storage, Vector};
use std::cell::{Cell, RefCell};

/// Collects instructions while a kernel runs on it; every result gets a register of its own.
pub(super) struct TapeRecorder<L> {
    pub(super) instructions: RefCell<Vec<Instruction<L>>>,
    pub(super) sections: RefCell<Vec<&'static str>>,
    section: Cell<usize>,
    registers: Cell<u32>,
}

impl<L: Element> TapeRecorder<L> {
    pub(super) fn new() -> Self {
        TapeRecorder {
            instructions: RefCell::default(),
            sections: RefCell::new(vec!["body"]),
            section: Cell::new(0),
            registers: Cell::new(0),
        }
    }

    fn push(&self, action: TapeAction<L>) {
        let section = self.section.get();
        self.instructions.borrow_mut().push(Instruction { section, action });
    }

    /// Returns a register that has not been written yet.
    fn register(&self, file: RegisterKind) -> RegisterName {
        let number = self.registers.get();
        self.registers.set(number + 1);
        RegisterName { file, number }
    }

    fn number(&self, number: Number<L>) -> RecordedValue<'_, L> {
        let to = self.register(RegisterKind::Number);
        self.push(TapeAction::Number(to, number));
        RecordedValue { recorder: self, operand: Operand::Register(to) }
    }

    fn truth(&self, truth: PredicateInstruction<L>) -> RecordedPredicate<'_, L> {
        let register = self.register(RegisterKind::Predicate);
        self.push(TapeAction::Truth(register, truth));
        RecordedPredicate { recorder: self, register }
    }

    fn indices(&self, indices: Indices<L>) -> RegisterName {
        let to = self.register(RegisterKind::Index);
        self.push(TapeAction::Indices(to, indices));
        to
    }
}

/// A vector of numbers during recording: a register, or a known number.
#[derive(Clone, Copy)]
pub(super) struct RecordedValue<'t, L> {
    recorder: &'t TapeRecorder<L>,
    operand: Operand<L>,
}

/// A predicate during recording.
#[derive(Clone, Copy)]
pub(super) struct RecordedPredicate<'t, L> {
    recorder: &'t TapeRecorder<L>,
    register: RegisterName,
}

impl<L: Element> RecordedValue<'_, L> {
    /// Evaluates arithmetic between scalar operands at once: no vector machine would spend an instruction on it.
    fn binary(self, op: BinaryOp, other: Self) -> Self {
        match (self.operand, other.operand) {
            (Operand::Uniform(a), Operand::Uniform(b)) => {
                RecordedValue { operand: Operand::Uniform(op.apply(a, b)), ..self }
            }
            (a, b) => self.recorder.number(Number::Binary(op, a, b)),
        }
    }

    fn unary(self, op: UnaryOp) -> Self {
        match self.operand {
            Operand::Uniform(a) => RecordedValue { operand: Operand::Uniform(op.apply(a)), ..self },
            a => self.recorder.number(Number::Unary(op, a)),
        }
    }
}

/// Records an operation of values as an instruction on the tape.
macro_rules! recorded {
    (() V unary $op:ident $f:ident ($a:ident) $result:tt) => {
        $a.unary(UnaryOp::$op)
    };
    (() V merge $op:ident $f:ident ($predicate:ident $a:ident $b:ident) $result:tt) => {
        $predicate.recorder.number(Number::$op($predicate.register, $a.operand, $b.operand))
    };
    (() V $group:ident $op:ident $f:ident ($a:ident $b:ident) $result:tt) => {
        $a.binary(BinaryOp::$op, $b)
    };
    (() P compare $op:ident $f:ident ($a:ident $b:ident) $result:tt) => {
        $a.recorder.truth(PredicateInstruction::Compare(CompareOp::$op, $a.operand, $b.operand))
    };
    (() P connective $op:ident $f:ident ($a:ident $b:ident) $result:tt) => {
        $a.recorder.truth(PredicateInstruction::Connective(ConnectiveOp::$op, $a.register, $b.register))
    };
    (() P negation $op:ident $f:ident ($a:ident) $result:tt) => {
        $a.recorder.truth(PredicateInstruction::Negation(NegationOp::$op, $a.register))
    };
}
for_each_op!(each implement_operator (['t, L: Element] RecordedValue<'t, L>, recorded ()));

impl<'t, L: Element> Vector for RecordedValue<'t, L> {
    type Predicate = RecordedPredicate<'t, L>;
    for_each_op!(each implement_vector (recorded ()));
}

impl<L: Element> Predicate for RecordedPredicate<'_, L> {
    for_each_op!(each implement_predicate (recorded ()));
}

/// Handle of the recording machine.
#[derive(Clone, Copy)]
pub(super) struct Recording<'t, L>(pub(super) &'t TapeRecorder<L>);

fn reference<T: Storage>(slot: Slot<T>, shift: isize) -> ArrayReference {
    ArrayReference { array: slot.array(), element: T::NAME, shift }
}

/// Converts an operand to its form on a tape, by its kind.
#[rustfmt::skip]
macro_rules! operand {
    (V $value:ident) => { $value.operand };
    (P $predicate:ident) => { $predicate.register };
    (Counter $counter:ident) => { $counter.0 };
    (Numbers $slot:ident $shift:ident) => { reference($slot, $shift) };
    (Numbers $slot:ident) => { reference($slot, 0) };
    (Entries $slot:ident) => { reference($slot, 0) };
    ($kind:ident $index:ident) => { $index };
}

/// Implements the method of an instruction, by its enumeration.
macro_rules! record {
    ($this:ident $about:tt [$($signature:tt)*]
     $file:ident $form:ident $f:ident $(($($x:ident $($shift:ident)?: $kind:ident),+))?) => {
        $($signature)* {
            push!($file $this.0, $file::$form $(($(operand!($kind $x $($shift)?)),+))?)
        }
    };
}
#[rustfmt::skip]
macro_rules! push {
    (Number $recorder:expr, $number:expr) => { $recorder.number($number) };
    (Indices $recorder:expr, $indices:expr) => { $recorder.indices($indices) };
    (Effect $recorder:expr, $effect:expr) => { $recorder.push(TapeAction::Effect($effect)) };
}

impl<'t, L: Element> Machine for Recording<'t, L> {
    type Lane = L;
    type V = RecordedValue<'t, L>;
    type P = RecordedPredicate<'t, L>;
    type I = RegisterName;

    fn uniform(self, value: f64) -> RecordedValue<'t, L> {
        RecordedValue { recorder: self.0, operand: Operand::Uniform(L::from_f64(value)) }
    }
    for_each_op!(each_instruction record self);
    fn none(self, _: RecordedPredicate<'t, L>) -> bool {
        // A tape is straight-line: it contains every operation, as the CRAY executed them.
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
