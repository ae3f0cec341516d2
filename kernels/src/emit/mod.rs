//! Kernels as assembly text for vector processors that exist: RISC-V's vector extension. This room knows the tape and nothing else.

mod driver;
mod forms;
mod registers;
mod rvv;

use crate::backend::ListingLine;
use crate::isa::Array;
pub use driver::{ArrayFile, KernelCall, driver};
pub use forms::{FORMS, Form};
pub use rvv::emit;

/// Entries of the block of pointers before the arrays: constants, counters, and the memory of spilled registers.
const POINTERS: usize = 3;
const CONSTANTS: usize = 0;
const COUNTERS: usize = 1;
const SPILLS: usize = 2;

/// Vector registers of the processor that form one register of the kernel (LMUL).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GroupSize {
    /// A single register.
    One,
    /// Two.
    Two,
    /// Four: with 1,024 bits each they give the eight registers of 64 numbers of a CRAY-1. Predicates take one of the eight.
    Four,
    /// Eight.
    Eight,
}

impl GroupSize {
    /// Every size.
    pub const ALL: [GroupSize; 4] = [GroupSize::One, GroupSize::Two, GroupSize::Four, GroupSize::Eight];

    /// Number of registers.
    pub const fn registers(self) -> usize {
        match self {
            GroupSize::One => 1,
            GroupSize::Two => 2,
            GroupSize::Four => 4,
            GroupSize::Eight => 8,
        }
    }

    /// Name in the assembly.
    const fn name(self) -> &'static str {
        match self {
            GroupSize::One => "m1",
            GroupSize::Two => "m2",
            GroupSize::Four => "m4",
            GroupSize::Eight => "m8",
        }
    }

    /// Name of half the size.
    const fn half(self) -> &'static str {
        match self {
            GroupSize::One => "mf2",
            GroupSize::Two => "m1",
            GroupSize::Four => "m2",
            GroupSize::Eight => "m4",
        }
    }

    /// First register of the groups: below are the mask of merges, and predicates.
    const fn first(self) -> usize {
        match self {
            GroupSize::One | GroupSize::Two | GroupSize::Four => 4,
            GroupSize::Eight => 8,
        }
    }

    /// Number of groups, and of registers for predicates.
    const fn pools(self) -> (usize, usize) {
        ((32 - self.first()) / self.registers(), self.first() - 1)
    }
}

/// Reasons why a kernel has no vector code.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EmitError {
    /// An array in another precision than f64.
    #[error(
        "{operation} of {array} needs elements of {element}, which have no vector code; use machine.precision = \"f64\""
    )]
    Precision {
        /// Mnemonic of the operation.
        operation: &'static str,
        /// Label of the array.
        array: &'static str,
        /// Type of its elements.
        element: &'static str,
    },
    /// Lanes of another precision than f64.
    #[error("lanes of {0} have no vector code; use machine.precision = \"f64\"")]
    Lane(&'static str),
    /// An operation without a row in the expansion table.
    #[error("operation {0} has no vector code for these operands; see the expansion table")]
    NoForm(&'static str),
}

/// Purpose of an emitted instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Purpose {
    /// The operation that the ledger counts.
    Operation,
    /// Further vector instructions of the operation: see the expansion table.
    Expansion,
    /// A register is saved or restored.
    Spill,
    /// Addresses, constants and counters.
    Address,
    /// The loop over the strips.
    Loop,
}

impl Purpose {
    /// Every purpose.
    pub const ALL: [Purpose; 5] =
        [Purpose::Operation, Purpose::Expansion, Purpose::Spill, Purpose::Address, Purpose::Loop];

    /// Name in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Purpose::Operation => "operation",
            Purpose::Expansion => "expansion",
            Purpose::Spill => "spill",
            Purpose::Address => "address",
            Purpose::Loop => "loop",
        }
    }
}

/// An instruction of four bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EmittedLine {
    /// Text of the instruction.
    pub code: String,
    /// Its purpose.
    pub purpose: Purpose,
    /// Instruction of the tape that it belongs to; none for the loop.
    pub instruction: Option<usize>,
}

impl EmittedLine {
    /// Mnemonic of the instruction.
    pub fn mnemonic(&self) -> &str {
        self.code.split(' ').next().unwrap_or_default()
    }
}

/// An array in the block of pointers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EmittedArray {
    /// The array.
    pub array: Array,
    /// Type of its elements.
    pub element: &'static str,
    /// True if the pointer is to the first element of the array, false if to the first element of the range.
    pub indexed: bool,
}

/// A kernel as a function.
#[derive(Clone, Debug, PartialEq)]
pub struct EmittedKernel {
    /// Instructions in order.
    pub lines: Vec<EmittedLine>,
    /// Arrays in the block of pointers, after the constants, the counters and the memory of spilled registers.
    pub arrays: Vec<EmittedArray>,
    /// Constants, 8 bytes each.
    pub constants: Vec<f64>,
    /// Number of spilled registers that the memory must hold.
    pub places: usize,
    /// First instruction of the loop.
    pub start: usize,
    /// Rows of [`FORMS`] in use.
    pub forms: Vec<usize>,
}

impl EmittedKernel {
    /// Number of instructions of a purpose, in a strip or outside of the loop.
    pub fn count(&self, purpose: Purpose) -> usize {
        self.lines.iter().filter(|line| line.purpose == purpose).count()
    }

    /// Assembly text of the function, with the instruction of the tape beside the first line of each.
    pub fn text(&self, name: &str, tape: &[ListingLine]) -> String {
        let mut text = format!("    .globl {name}\n{name}:\n");
        let (mut section, mut shown) = ("", usize::MAX);
        for line in &self.lines {
            let mut comment = String::new();
            if let Some(at) = line.instruction.filter(|at| *at != shown) {
                let of = &tape[at];
                if of.section != section {
                    section = of.section;
                    text.push_str(&format!("# {section}\n"));
                }
                shown = at;
                comment =
                    format!("# {} {} {}, {}", at + 1, of.operation, of.destination, of.sources.join(", "));
            }
            text.push_str(&format!("    {:<40}{comment}\n", line.code));
        }
        text
    }
}
