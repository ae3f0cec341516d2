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

    /// Calls `visit` with every register it reads, then, where it writes one, with that.
    pub fn registers(&mut self, mut visit: impl FnMut(&mut RegisterName, Role)) {
        let mut read = |operand: &mut Operand<L>| {
            if let Operand::Register(name) = operand {
                visit(name, Role::Reads);
            }
        };
        match &mut self.action {
            Action::Unary(a) | Action::ToIndex(a) | Action::Store(_, a) => read(a),
            Action::Binary(a, b) | Action::Compare(a, b) => {
                read(a);
                read(b);
            }
            Action::Select(predicate, a, b) => {
                read(a);
                read(b);
                visit(predicate, Role::Reads);
            }
            Action::Gather(_, index, elsewhere) => {
                read(elsewhere);
                visit(index, Role::Reads);
            }
            Action::Logic(a, b) => {
                visit(a, Role::Reads);
                if let Some(b) = b {
                    visit(b, Role::Reads);
                }
            }
            Action::Count(a, _)
            | Action::FromIndex(a)
            | Action::StoreIndex(_, a)
            | Action::GatherIndex(_, a) => visit(a, Role::Reads),
            Action::ScatterIndex(_, a, b) => {
                visit(a, Role::Reads);
                visit(b, Role::Reads);
            }
            Action::Numbers | Action::Load(_) | Action::LoadIndex(_) => {}
        }
        if let Some(to) = &mut self.to {
            visit(to, Role::Writes);
        }
    }
}

/// How an instruction uses a register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// It reads the register.
    Reads,
    /// It writes the register.
    Writes,
}
