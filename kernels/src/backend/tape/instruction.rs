//! What a tape records: one instruction a vector operation.

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

/// What an instruction does to which operands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action<L> {
    /// A number from one number.
    Unary(Operand<L>),
    /// A number from two.
    Binary(Operand<L>, Operand<L>),
    /// A predicate from two numbers.
    Compare(Operand<L>, Operand<L>),
    /// A predicate from one or two.
    Logic(RegisterName, Option<RegisterName>),
    /// Merge under a predicate.
    Select(RegisterName, Operand<L>, Operand<L>),
    /// Population count into a counter.
    Count(RegisterName, u8),
    /// Element numbers.
    Numbers,
    /// Numbers to indices.
    ToIndex(Operand<L>),
    /// Indices to numbers.
    FromIndex(RegisterName),
    /// Numbers from memory.
    Load(Reference),
    /// Numbers to memory.
    Store(Reference, Operand<L>),
    /// Indices from memory.
    LoadIndex(Reference),
    /// Indices to memory.
    StoreIndex(Reference, RegisterName),
    /// Numbers through an index vector; the operand where it numbers none.
    Gather(Reference, RegisterName, Operand<L>),
    /// Indices through an index vector.
    GatherIndex(Reference, RegisterName),
    /// Indices to memory through an index vector: address, value.
    ScatterIndex(Reference, RegisterName, RegisterName),
}

/// One recorded vector instruction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instruction<L> {
    /// The operation, which says its name and class.
    pub op: Op,
    /// Index of the section it stands in.
    pub section: usize,
    /// The register it writes, if any.
    pub to: Option<RegisterName>,
    /// What it does.
    pub action: Action<L>,
}

impl<L: Element> Instruction<L> {
    /// The memory it touches.
    pub fn reference(&self) -> Option<Reference> {
        match self.action {
            Action::Load(r)
            | Action::Store(r, _)
            | Action::LoadIndex(r)
            | Action::StoreIndex(r, _)
            | Action::Gather(r, ..)
            | Action::GatherIndex(r, _)
            | Action::ScatterIndex(r, ..) => Some(r),
            _ => None,
        }
    }

    /// The operations it counts as: its own, and a conversion where memory holds another precision than the lanes.
    pub fn operations(&self) -> impl Iterator<Item = Op> {
        let converts = matches!(self.action, Action::Load(_) | Action::Store(..) | Action::Gather(..))
            && self.reference().is_some_and(|reference| reference.element != L::NAME);
        std::iter::once(self.op).chain(converts.then_some(Op::Widen))
    }

    /// Whether it writes to the array that `reference` names.
    pub fn overwrites(&self, reference: Reference) -> bool {
        match self.action {
            Action::Store(to, _) | Action::StoreIndex(to, _) | Action::ScatterIndex(to, ..) => {
                (to.array, to.element) == (reference.array, reference.element)
            }
            _ => false,
        }
    }

    /// Calls `visit` with every operand of numbers.
    pub fn operands(&mut self, mut visit: impl FnMut(&mut Operand<L>)) {
        match &mut self.action {
            Action::Unary(a) | Action::ToIndex(a) | Action::Store(_, a) | Action::Gather(_, _, a) => visit(a),
            Action::Binary(a, b) | Action::Compare(a, b) | Action::Select(_, a, b) => {
                visit(a);
                visit(b);
            }
            Action::Logic(..)
            | Action::Count(..)
            | Action::Numbers
            | Action::FromIndex(_)
            | Action::Load(_)
            | Action::LoadIndex(_)
            | Action::StoreIndex(..)
            | Action::GatherIndex(..)
            | Action::ScatterIndex(..) => {}
        }
    }

    /// Calls `visit` with every register it reads, then, where it writes one, with that.
    pub fn registers(&mut self, mut visit: impl FnMut(&mut RegisterName)) {
        self.operands(|operand| {
            if let Operand::Register(name) = operand {
                visit(name);
            }
        });
        match &mut self.action {
            Action::Select(a, ..)
            | Action::Gather(_, a, _)
            | Action::Logic(a, None)
            | Action::Count(a, _)
            | Action::FromIndex(a)
            | Action::StoreIndex(_, a)
            | Action::GatherIndex(_, a) => visit(a),
            Action::Logic(a, Some(b)) | Action::ScatterIndex(_, a, b) => {
                visit(a);
                visit(b);
            }
            Action::Unary(_)
            | Action::Binary(..)
            | Action::Compare(..)
            | Action::Numbers
            | Action::ToIndex(_)
            | Action::Load(_)
            | Action::Store(..)
            | Action::LoadIndex(_) => {}
        }
        if let Some(to) = &mut self.to {
            visit(to);
        }
    }
}
