//! Options that choose the vector processor of emitted code, and the text of a program for it.

use clap::{Args, ValueEnum};
use std::collections::BTreeSet;
use stripmine_kernels::Runnable;
use stripmine_kernels::emit::{EmitError, EmittedKernel, FORMS, GroupSize};

/// Instruction sets of emitted code.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum TargetIsa {
    /// RISC-V with the vector extension 1.0
    Rvv,
}

/// Number of vector registers that form one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum GroupChoice {
    /// One register
    #[value(name = "1")]
    One,
    /// Two registers
    #[value(name = "2")]
    Two,
    /// Four registers
    #[value(name = "4")]
    Four,
    /// Eight registers
    #[value(name = "8")]
    Eight,
}

impl GroupChoice {
    pub(crate) const fn size(self) -> GroupSize {
        match self {
            GroupChoice::One => GroupSize::One,
            GroupChoice::Two => GroupSize::Two,
            GroupChoice::Four => GroupSize::Four,
            GroupChoice::Eight => GroupSize::Eight,
        }
    }
}

/// Options of a listing: without an instruction set, the operations of the tape are listed.
#[derive(Args, Clone, Debug)]
pub(crate) struct ListingTarget {
    /// Lists the code of a vector processor instead, with the operation beside its instructions
    #[arg(long, value_enum)]
    isa: Option<TargetIsa>,
    /// Vector registers that form one register of the program (LMUL); used with --isa
    #[arg(long, value_enum, default_value = "4", requires = "isa")]
    lmul: GroupChoice,
}

impl ListingTarget {
    /// Size of the register groups of the processor; none for a listing of the tape.
    pub(crate) fn size(&self) -> Option<GroupSize> {
        self.isa.map(|TargetIsa::Rvv| self.lmul.size())
    }
}

/// Listing of a program for a target: its functions, or the operations of its tape.
///
/// # Errors
/// As [`Runnable::emitted`].
pub(crate) fn listing_text(
    name: &str,
    program: &dyn Runnable,
    target: Option<GroupSize>,
) -> Result<String, EmitError> {
    let Some(size) = target else { return Ok(program.listing()) };
    let kernel = program.emitted(size)?;
    Ok(kernel.text(name, &program.lines()) + &expansion_text(std::slice::from_ref(&kernel)))
}

/// Rows of the expansion table that some kernels use, for operations that need more than one instruction.
fn expansion_text(kernels: &[EmittedKernel]) -> String {
    let used: BTreeSet<usize> = kernels.iter().flat_map(|kernel| kernel.forms.iter().copied()).collect();
    let rows = used.into_iter().map(|at| &FORMS[at]).filter(|form| form.code.len() > 1);
    let lines = rows
        .map(|form| format!("# {:<8} {:<4} {}\n", form.op.mnemonic(), form.operands, form.code.join("; ")));
    let text: String = lines.collect();
    if text.is_empty() {
        text
    } else {
        format!(
            "\n# Expansion table: operation, operands, instructions; the last one counts as the operation.\n{text}"
        )
    }
}
