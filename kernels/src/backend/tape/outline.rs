//! Outlines of instructions for timing models: the unit, sources and destination, without values.

use super::instruction::{ArrayReference, Instruction, Operand, RegisterKind, RegisterName};
use super::recorded::Tape;
use crate::backend::dispatch::{InstructionSet, RegisterTask, dispatch};
use crate::backend::precision::Precision;
use crate::backend::registers::Registers;
use crate::isa::{Element, Op, ProgramError, Storage, Vector};
use std::cell::Cell;

/// Location of a vector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VectorLocation {
    /// In a vector register.
    Register(RegisterName),
    /// In an array, consecutive elements.
    Memory(ArrayReference),
    /// In an array, at the elements that an index vector numbers.
    Indexed(ArrayReference),
}

/// A vector instruction without its values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Outline {
    /// The operation.
    pub op: Op,
    /// True if numbers change their precision on the way (counted also as [`Op::Widen`]).
    pub converts: bool,
    /// Vectors that it reads, without scalar operands.
    pub reads: Vec<VectorLocation>,
    /// Vector that it writes; a population count writes none.
    pub writes: Option<VectorLocation>,
}

impl Outline {
    /// Operations it counts as, [`Instruction::operations`].
    pub fn operations(&self) -> impl Iterator<Item = Op> {
        std::iter::once(self.op).chain(self.converts.then_some(Op::Widen))
    }

    /// Name under which a pass is timed: the mnemonic, with `.index` if it moves entries of an index vector, and `.convert` if
    /// numbers change their precision.
    pub fn kind(&self) -> String {
        let moves = |place: &VectorLocation| match place {
            VectorLocation::Memory(reference) | VectorLocation::Indexed(reference) => {
                reference.element == u32::NAME
            }
            VectorLocation::Register(_) => false,
        };
        let index = if self.reads.iter().chain(&self.writes).any(moves) { ".index" } else { "" };
        let convert = if self.converts { ".convert" } else { "" };
        format!("{}{index}{convert}", self.op.mnemonic())
    }

    fn of<L: Element>(instruction: &Instruction<L>) -> Outline {
        let mut reads = Vec::new();
        let mut copy = *instruction;
        copy.operands(|operand| {
            if let Operand::Memory(reference) = operand {
                reads.push(VectorLocation::Memory(*reference));
            }
        });
        copy.reads(|name| reads.push(VectorLocation::Register(*name)));
        let place = if instruction.is_indexed() { VectorLocation::Indexed } else { VectorLocation::Memory };
        let memory = instruction.reference().map(place);
        let result = instruction.to().map(VectorLocation::Register);
        if result.is_some() {
            reads.extend(memory);
        }
        Outline {
            op: instruction.op(),
            converts: instruction.operations().count() > 1,
            reads,
            writes: result.or(memory),
        }
    }
}

/// Outlines of a recorded kernel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Outlines {
    /// Number type of its lanes.
    pub lane: &'static str,
    /// Instructions of a machine that computes in registers, in order: these are counted and listed.
    pub instructions: Vec<Outline>,
    /// Passes that execute them here: loads become operands of their readers if the array keeps its contents.
    pub passes: Vec<Outline>,
    /// Registers of each file that the passes need at once, in the order of [`RegisterKind::ALL`].
    pub registers: [usize; RegisterKind::ALL.len()],
}

impl<L: Element> Tape<L> {
    /// Outlines of the kernel for a timing model.
    pub fn outlines(&self) -> Outlines {
        Outlines {
            lane: L::NAME,
            instructions: self.instructions.iter().map(Outline::of).collect(),
            passes: self.passes.iter().map(Outline::of).collect(),
            registers: self.pass_sizes,
        }
    }
}

/// Bytes per element in a register of each file, in the order of [`RegisterKind::ALL`], and the lanes of a hardware register.
///
/// # Errors
/// [`ProgramError::NoSuchInstructionSet`] if this processor lacks it.
pub fn register_shape<L: Precision>(
    set: InstructionSet,
) -> Result<([f64; RegisterKind::ALL.len()], usize), ProgramError> {
    let shape = Cell::new(Default::default());
    dispatch::<L, _>(set, RegisterShapeTask(&shape))?;
    Ok(shape.get())
}

/// Task that looks up the sizes of a register file.
struct RegisterShapeTask<'c>(&'c Cell<([f64; RegisterKind::ALL.len()], usize)>);

impl<L: Precision> RegisterTask<L> for RegisterShapeTask<'_> {
    #[inline(always)]
    fn on<R: Registers<Lane = L>>(self, _: R) {
        let sizes = [size_of::<R::V>(), size_of::<<R::V as Vector>::Predicate>(), size_of::<R::Index>()];
        self.0.set((sizes.map(|size| size as f64 / R::LANES as f64), R::LANES));
    }
}
