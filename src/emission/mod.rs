//! Programs of a scene as RISC-V vector code, with their arrays and the result that ours computes; and their execution by other people's tools.

mod folder;
mod target;
mod toolchain;

pub(crate) use folder::write_folder;
pub(crate) use target::{GroupChoice, ListingTarget, TargetIsa, listing_text};
pub(crate) use toolchain::{BuiltProgram, Toolchain, differing};

use stripmine_kernels::backend::ListingLine;
use stripmine_kernels::emit::{ArrayFile, EmitError, EmittedKernel, GroupSize, KernelCall, driver};
use stripmine_kernels::isa::ProgramError;
use stripmine_kernels::{Execution, InstructionSet};
use stripmine_physics::method::Prepared;
use stripmine_physics::reported::{ErrorClass, Reported};

/// Name of the file with the arrays at the start.
pub(crate) const ARRAYS: &str = "arrays.bin";

/// A program of the scene as a function.
#[derive(Clone, Debug)]
pub(crate) struct EmittedProgram {
    /// Name of its function.
    pub name: String,
    /// Number of elements.
    pub n: usize,
    pub kernel: EmittedKernel,
    /// Instructions of the tape, in words.
    pub tape: Vec<ListingLine>,
    /// Operations that the ledger counts, section by section.
    pub ledger: Vec<(&'static str, u64)>,
}

/// Programs of a scene, their arrays, and what ours makes of them.
#[derive(Clone, Debug)]
pub(crate) struct EmittedScene {
    pub programs: Vec<EmittedProgram>,
    /// Text of the program that calls the functions on the arrays.
    pub driver: String,
    /// Arrays at the start, and after the steps.
    pub start: ArrayFile,
    pub end: ArrayFile,
    pub size: GroupSize,
    pub steps: u64,
}

/// Reasons why a scene has no vector code.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum EmissionError {
    #[error(
        "{0} has no vector programs, so it has no vector code; choose a scene with forces between pairs on a lattice"
    )]
    NoPrograms(String),
    #[error("program `{part}`: {cause}")]
    NoCode { part: &'static str, cause: EmitError },
    #[error(transparent)]
    Program(#[from] ProgramError),
}

impl Reported for EmissionError {
    fn class(&self) -> ErrorClass {
        ErrorClass::Precondition
    }
}

/// Emits the programs of a scene, and runs ours for a number of steps.
///
/// # Errors
/// [`EmissionError`] names what has no vector code.
pub(crate) fn emit_scene(
    name: &str,
    prepared: &Prepared,
    size: GroupSize,
    steps: u64,
) -> Result<EmittedScene, EmissionError> {
    let mut made = None;
    prepared.model.with_bound_programs(&mut |calls, memory| {
        made = Some((|| {
            let programs: Vec<EmittedProgram> = calls
                .iter()
                .enumerate()
                .map(|(at, call)| {
                    let code = call.program.emitted(size);
                    let tally = call.program.tally().into_iter();
                    Ok(EmittedProgram {
                        name: format!("{}_{}", call.part, at + 1),
                        n: call.range.len(),
                        kernel: code.map_err(|cause| EmissionError::NoCode { part: call.part, cause })?,
                        tape: call.program.lines(),
                        ledger: tally.map(|(section, counts)| (section, counts.total())).collect(),
                    })
                })
                .collect::<Result<_, EmissionError>>()?;
            let kernels: Vec<KernelCall<'_>> = programs
                .iter()
                .zip(calls)
                .map(|(program, call)| KernelCall {
                    name: &program.name,
                    kernel: &program.kernel,
                    range: call.range.clone(),
                })
                .collect();
            let start = ArrayFile::of(memory, &kernels);
            let driver = driver(&kernels, &start, ARRAYS, steps);
            for _ in 0..steps {
                for call in calls {
                    call.program.run(
                        memory,
                        call.range.clone(),
                        Execution::Chained,
                        InstructionSet::best(),
                    )?;
                }
            }
            let end = ArrayFile::of(memory, &kernels);
            Ok(EmittedScene { programs, driver, start, end, size, steps })
        })());
    });
    made.unwrap_or_else(|| Err(EmissionError::NoPrograms(name.to_owned())))
}

impl EmittedScene {
    /// Text of all functions.
    pub(crate) fn kernels(&self) -> String {
        let functions = self.programs.iter().map(|it| it.kernel.text(&it.name, &it.tape));
        format!("    .text\n{}", functions.collect::<Vec<_>>().join("\n"))
    }
}
