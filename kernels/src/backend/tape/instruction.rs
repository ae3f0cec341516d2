//! What a tape records: one instruction a vector operation.

use crate::isa::list::for_each_op;
use crate::isa::op::{BinaryOp, CompareOp, ConnectiveOp, NegationOp, UnaryOp};
use crate::isa::{Array, Element, Op};

/// The three register files of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum File {
    /// Vectors of numbers, `V`.
    Number,
    /// Vectors of truth values, `P`.
    Predicate,
    /// Index vectors, `I`.
    Index,
}

impl File {
    /// All register files.
    pub const ALL: [File; 3] = [File::Number, File::Predicate, File::Index];

    /// The letter in a listing.
    pub const fn letter(self) -> char {
        match self {
            File::Number => 'V',
            File::Predicate => 'P',
            File::Index => 'I',
        }
    }
}

/// A vector register.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct RegisterName {
    /// Its register file.
    pub file: File,
    /// Its number in the file.
    pub number: u32,
}

/// What an instruction reads: a register of numbers, or the same number in every lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Operand<L> {
    /// A register of numbers.
    Register(RegisterName),
    /// A scalar operand.
    Uniform(L),
    /// An array as it lies in memory: what a load becomes where it is executed, never on the recorded tape.
    Memory(Reference),
}

/// An array in memory as an instruction meets it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reference {
    /// The array.
    pub array: Array,
    /// Name of its element type.
    pub element: &'static str,
    /// Elements from the own place.
    pub shift: isize,
}

/// What gives numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Number<L> {
    /// One number.
    Unary(UnaryOp, Operand<L>),
    /// Two numbers.
    Binary(BinaryOp, Operand<L>, Operand<L>),
    /// A merge under a predicate.
    Select(RegisterName, Operand<L>, Operand<L>),
    /// Element numbers.
    Numbers,
    /// Indices.
    FromIndex(RegisterName),
    /// Memory at the own place.
    Load(Reference),
    /// Memory at a shift.
    LoadShifted(Reference),
    /// Memory through an index vector; the operand where it numbers none.
    Gather(Reference, RegisterName, Operand<L>),
}

/// What gives a predicate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Truth<L> {
    /// Two numbers.
    Compare(CompareOp, Operand<L>, Operand<L>),
    /// Two predicates.
    Connective(ConnectiveOp, RegisterName, RegisterName),
    /// One predicate.
    Negation(NegationOp, RegisterName),
}

/// What gives an index vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Indices<L> {
    /// Numbers.
    ToIndex(Operand<L>),
    /// Memory.
    Load(Reference),
    /// Memory through an index vector.
    Gather(Reference, RegisterName),
}

/// What writes no register.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Effect<L> {
    /// Population count into a counter.
    Count(RegisterName, u8),
    /// Numbers to memory.
    Store(Reference, Operand<L>),
    /// Indices to memory.
    StoreIndex(Reference, RegisterName),
    /// Numbers to memory through an index vector: address, value.
    Scatter(Reference, RegisterName, Operand<L>),
    /// Indices to memory through an index vector: address, value.
    ScatterIndex(Reference, RegisterName, RegisterName),
}

/// What an instruction does to which operands, and the register that it writes: the type says of which file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action<L> {
    /// Writes a register of numbers.
    Number(RegisterName, Number<L>),
    /// Writes a predicate.
    Truth(RegisterName, Truth<L>),
    /// Writes an index vector.
    Indices(RegisterName, Indices<L>),
    /// Writes memory or a counter.
    Effect(Effect<L>),
}

macro_rules! define_action_op {
    (operator $o:tt binary $b:tt unary $u:tt compare $c:tt connective $a:tt negation $n:tt machine {
        $(($variant:ident, $mnemonic:literal, $class:ident, $doc:literal, [$($file:ident $action:ident),*])),* $(,)?
    }) => {
        impl<L> Action<L> {
            /// The operation it is, which says its name and class.
            pub fn op(&self) -> Op {
                match self {
                    Action::Number(_, Number::Binary(op, ..)) => op.op(),
                    Action::Number(_, Number::Unary(op, _)) => op.op(),
                    Action::Truth(_, Truth::Compare(op, ..)) => op.op(),
                    Action::Truth(_, Truth::Connective(op, ..)) => op.op(),
                    Action::Truth(_, Truth::Negation(op, _)) => op.op(),
                    $($(Action::$file(.., $file::$action { .. }) => Op::$variant,)*)*
                }
            }
        }
    };
}
for_each_op!(define_action_op);

/// One recorded vector instruction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instruction<L> {
    /// Index of the section it stands in.
    pub section: usize,
    /// What it does.
    pub action: Action<L>,
}

impl<L: Element> Instruction<L> {
    /// The operation, which says its name and class.
    pub fn op(&self) -> Op {
        self.action.op()
    }

    /// The register it writes, if any.
    pub fn to(&self) -> Option<RegisterName> {
        match self.action {
            Action::Number(to, _) | Action::Truth(to, _) | Action::Indices(to, _) => Some(to),
            Action::Effect(_) => None,
        }
    }

    /// The memory it touches.
    pub fn reference(&self) -> Option<Reference> {
        match self.action {
            Action::Number(_, Number::Load(r) | Number::LoadShifted(r) | Number::Gather(r, ..))
            | Action::Indices(_, Indices::Load(r) | Indices::Gather(r, _))
            | Action::Effect(
                Effect::Store(r, _)
                | Effect::StoreIndex(r, _)
                | Effect::Scatter(r, ..)
                | Effect::ScatterIndex(r, ..),
            ) => Some(r),
            _ => None,
        }
    }

    /// The operations it counts as: its own, and a conversion where memory holds another precision than the lanes.
    pub fn operations(&self) -> impl Iterator<Item = Op> {
        let numbers = match self.action {
            Action::Number(..) | Action::Effect(Effect::Store(..) | Effect::Scatter(..)) => self.reference(),
            _ => None,
        };
        let converts = numbers.is_some_and(|reference| reference.element != L::NAME);
        std::iter::once(self.op()).chain(converts.then_some(Op::Widen))
    }

    /// Whether it writes to the array that `reference` names.
    pub fn overwrites(&self, reference: Reference) -> bool {
        match self.action {
            Action::Effect(Effect::Count(..)) => false,
            Action::Effect(_) => self
                .reference()
                .is_some_and(|to| (to.array, to.element) == (reference.array, reference.element)),
            _ => false,
        }
    }

    /// Calls `visit` with every operand of numbers.
    pub fn operands(&mut self, mut visit: impl FnMut(&mut Operand<L>)) {
        match &mut self.action {
            Action::Number(_, Number::Unary(_, a) | Number::Gather(_, _, a))
            | Action::Indices(_, Indices::ToIndex(a))
            | Action::Effect(Effect::Store(_, a) | Effect::Scatter(_, _, a)) => visit(a),
            Action::Number(_, Number::Binary(_, a, b) | Number::Select(_, a, b))
            | Action::Truth(_, Truth::Compare(_, a, b)) => {
                visit(a);
                visit(b);
            }
            Action::Number(
                _,
                Number::Numbers | Number::FromIndex(_) | Number::Load(_) | Number::LoadShifted(_),
            )
            | Action::Truth(_, Truth::Connective(..) | Truth::Negation(..))
            | Action::Indices(_, Indices::Load(_) | Indices::Gather(..))
            | Action::Effect(Effect::Count(..) | Effect::StoreIndex(..) | Effect::ScatterIndex(..)) => {}
        }
    }

    /// Calls `visit` with every register it reads.
    pub fn reads(&mut self, mut visit: impl FnMut(&mut RegisterName)) {
        self.operands(|operand| {
            if let Operand::Register(name) = operand {
                visit(name);
            }
        });
        match &mut self.action {
            Action::Number(_, Number::Select(a, ..) | Number::Gather(_, a, _) | Number::FromIndex(a))
            | Action::Truth(_, Truth::Negation(_, a))
            | Action::Indices(_, Indices::Gather(_, a))
            | Action::Effect(Effect::Count(a, _) | Effect::StoreIndex(_, a) | Effect::Scatter(_, a, _)) => {
                visit(a);
            }
            Action::Truth(_, Truth::Connective(_, a, b)) | Action::Effect(Effect::ScatterIndex(_, a, b)) => {
                visit(a);
                visit(b);
            }
            Action::Number(
                _,
                Number::Unary(..)
                | Number::Binary(..)
                | Number::Numbers
                | Number::Load(_)
                | Number::LoadShifted(_),
            )
            | Action::Truth(_, Truth::Compare(..))
            | Action::Indices(_, Indices::ToIndex(_) | Indices::Load(_))
            | Action::Effect(Effect::Store(..)) => {}
        }
    }

    /// Calls `visit` with every register it reads, then, where it writes one, with that.
    pub fn registers(&mut self, mut visit: impl FnMut(&mut RegisterName)) {
        self.reads(&mut visit);
        if let Action::Number(to, _) | Action::Truth(to, _) | Action::Indices(to, _) = &mut self.action {
            visit(to);
        }
    }
}
