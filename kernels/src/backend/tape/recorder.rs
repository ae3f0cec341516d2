//! The machine that records: every operation of a text becomes an instruction on a tape.

use super::instruction::{
    Action, Effect, File, Indices, Instruction, Number, Operand, Reference, RegisterName, Truth,
};
use crate::isa::list::for_each_op;
use crate::isa::op::{BinaryOp, CompareOp, ConnectiveOp, NegationOp, UnaryOp};
use crate::isa::{Counter, Element, Machine, Predicate, Slot, Storage, Vector};
use std::cell::{Cell, RefCell};

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

    fn push(&self, action: Action<L>) {
        let section = self.section.get();
        self.instructions.borrow_mut().push(Instruction { section, action });
    }

    /// A register that nothing was written to yet.
    fn register(&self, file: File) -> RegisterName {
        let number = self.registers.get();
        self.registers.set(number + 1);
        RegisterName { file, number }
    }

    fn number(&self, number: Number<L>) -> RegisterName {
        let to = self.register(File::Number);
        self.push(Action::Number(to, number));
        to
    }

    fn truth(&self, truth: Truth<L>) -> RegisterName {
        let to = self.register(File::Predicate);
        self.push(Action::Truth(to, truth));
        to
    }

    fn indices(&self, indices: Indices<L>) -> RegisterName {
        let to = self.register(File::Index);
        self.push(Action::Indices(to, indices));
        to
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

impl<'t, L: Element> Value<'t, L> {
    /// Arithmetic between scalar operands is done at once: no vector machine would spend an instruction on it.
    fn binary(self, op: BinaryOp, other: Self) -> Self {
        let operand = match (self.operand, other.operand) {
            (Operand::Uniform(a), Operand::Uniform(b)) => Operand::Uniform(op.apply(a, b)),
            (a, b) => Operand::Register(self.recorder.number(Number::Binary(op, a, b))),
        };
        Value { recorder: self.recorder, operand }
    }

    fn unary(self, op: UnaryOp) -> Self {
        let operand = match self.operand {
            Operand::Uniform(a) => Operand::Uniform(op.apply(a)),
            a => Operand::Register(self.recorder.number(Number::Unary(op, a))),
        };
        Value { recorder: self.recorder, operand }
    }

    fn compare(self, op: CompareOp, other: Self) -> TruthValue<'t, L> {
        let register = self.recorder.truth(Truth::Compare(op, self.operand, other.operand));
        TruthValue { recorder: self.recorder, register }
    }
}

macro_rules! record {
    (operator { $(($ov:ident, $om:literal, $oc:ident, $od:literal, $trait:ident $of:ident)),* $(,)? }
     binary { $(($bv:ident, $bm:literal, $bc:ident, $bd:literal, $bf:ident)),* $(,)? }
     unary { $(($uv:ident, $um:literal, $uc:ident, $ud:literal, $uf:ident)),* $(,)? }
     compare { $(($cv:ident, $cm:literal, $cc:ident, $cd:literal, $cf:ident)),* $(,)? }
     connective { $(($av:ident, $am:literal, $ac:ident, $ad:literal, $af:ident)),* $(,)? }
     negation { $(($nv:ident, $nm:literal, $nc:ident, $nd:literal, $nf:ident)),* $(,)? }
     machine $machine:tt) => {
        $(
            impl<L: Element> std::ops::$trait for Value<'_, L> {
                type Output = Self;
                fn $of(self, other: Self) -> Self {
                    self.binary(BinaryOp::$ov, other)
                }
            }
        )*

        impl<L: Element> Predicate for TruthValue<'_, L> {
            $(
                fn $af(self, other: Self) -> Self {
                    let truth = Truth::Connective(ConnectiveOp::$av, self.register, other.register);
                    TruthValue { register: self.recorder.truth(truth), ..self }
                }
            )*
            $(
                fn $nf(self) -> Self {
                    let truth = Truth::Negation(NegationOp::$nv, self.register);
                    TruthValue { register: self.recorder.truth(truth), ..self }
                }
            )*
        }

        impl<'t, L: Element> Vector for Value<'t, L> {
            type Predicate = TruthValue<'t, L>;

            $(
                fn $uf(self) -> Self {
                    self.unary(UnaryOp::$uv)
                }
            )*
            $(
                fn $bf(self, other: Self) -> Self {
                    self.binary(BinaryOp::$bv, other)
                }
            )*
            $(
                fn $cf(self, other: Self) -> Self::Predicate {
                    self.compare(CompareOp::$cv, other)
                }
            )*
            fn select(predicate: Self::Predicate, holds: Self, fails: Self) -> Self {
                let recorder = predicate.recorder;
                let merge = Number::Select(predicate.register, holds.operand, fails.operand);
                Value { recorder, operand: Operand::Register(recorder.number(merge)) }
            }
        }
    };
}
for_each_op!(record);

/// The recording machine itself.
#[derive(Clone, Copy)]
pub(super) struct Recording<'t, L>(pub(super) &'t Recorder<L>);

impl<'t, L: Element> Recording<'t, L> {
    fn number(self, number: Number<L>) -> Value<'t, L> {
        Value { recorder: self.0, operand: Operand::Register(self.0.number(number)) }
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
        self.number(Number::Load(reference(slot, 0)))
    }
    fn load_shifted<T: Element>(self, slot: Slot<T>, shift: isize) -> Value<'t, L> {
        self.number(Number::LoadShifted(reference(slot, shift)))
    }
    fn store<T: Element>(self, slot: Slot<T>, value: Value<'t, L>) {
        self.0.push(Action::Effect(Effect::Store(reference(slot, 0), value.operand)));
    }
    fn numbers(self) -> Value<'t, L> {
        self.number(Number::Numbers)
    }
    fn to_index(self, numbers: Value<'t, L>) -> RegisterName {
        self.0.indices(Indices::ToIndex(numbers.operand))
    }
    fn index_numbers(self, index: RegisterName) -> Value<'t, L> {
        self.number(Number::FromIndex(index))
    }
    fn load_index(self, slot: Slot<u32>) -> RegisterName {
        self.0.indices(Indices::Load(reference(slot, 0)))
    }
    fn store_index(self, slot: Slot<u32>, value: RegisterName) {
        self.0.push(Action::Effect(Effect::StoreIndex(reference(slot, 0), value)));
    }
    fn gather<T: Element>(self, slot: Slot<T>, index: RegisterName, elsewhere: Value<'t, L>) -> Value<'t, L> {
        self.number(Number::Gather(reference(slot, 0), index, elsewhere.operand))
    }
    fn gather_index(self, slot: Slot<u32>, index: RegisterName) -> RegisterName {
        self.0.indices(Indices::Gather(reference(slot, 0), index))
    }
    fn scatter_index(self, slot: Slot<u32>, index: RegisterName, value: RegisterName) {
        self.0.push(Action::Effect(Effect::ScatterIndex(reference(slot, 0), index, value)));
    }
    fn scatter<T: Element>(self, slot: Slot<T>, index: RegisterName, value: Value<'t, L>) {
        self.0.push(Action::Effect(Effect::Scatter(reference(slot, 0), index, value.operand)));
    }
    fn count(self, counter: Counter, predicate: TruthValue<'t, L>) {
        self.0.push(Action::Effect(Effect::Count(predicate.register, counter.0)));
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
