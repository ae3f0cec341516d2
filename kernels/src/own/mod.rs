//! Kernels of a user: arrays with names of the user's own, and a body without `unsafe`.
//!
//! A kernel declares its arrays once: name, access and shifts. It gets a slot for each, and the compiler lets its body use no others. So
//! memory is checked against the declaration before a run, and the body cannot leave it.

mod arrays;
mod machine;
mod traced;

use arrays::footprint;
pub use arrays::{Declarations, DeclaredArray, OwnMemory, ReadSlot, ShiftedSlot, WriteSlot};
pub use machine::OwnMachine;
pub use traced::{InputSlot, TraceError, TracedKernel, TracedNode};

use crate::backend::{InstructionSet, Precision, Tape};
use crate::isa::{Element, Kernel, Machine, ProgramError, Storage};
use crate::program::{Execution, Program, Runnable};

use std::ops::Range;

/// Straight-line vector code for the elements of arrays with names of the user's own.
///
/// ```
/// use stripmine_kernels::own::{Declarations, OwnKernel, OwnMachine, OwnProgram, ReadSlot, WriteSlot};
/// use stripmine_kernels::isa::Machine;
/// use stripmine_kernels::{Execution, InstructionSet};
///
/// /// a = b + 3 c
/// struct Triad;
///
/// impl OwnKernel for Triad {
///     type Lane = f64;
///     type Slots<'k> = (ReadSlot<'k>, ReadSlot<'k>, WriteSlot<'k>);
///     fn declare<'k>(&self, arrays: &mut Declarations<'k>) -> Self::Slots<'k> {
///         (arrays.read("b"), arrays.read("c"), arrays.write("a"))
///     }
///     #[inline(always)]
///     fn body<'k, M: Machine<Lane = f64>>(&self, m: OwnMachine<'k, M>, &(b, c, a): &Self::Slots<'k>) {
///         m.store(a, m.load(b) + m.uniform(3.0) * m.load(c));
///     }
/// }
///
/// let program = OwnProgram::new(Triad)?;
/// let (b, c, mut a) = ([1.0; 10], [2.0; 10], [0.0; 10]);
/// let memory = program.memory().read("b", &b)?.read("c", &c)?.write("a", &mut a)?;
/// program.run(&memory, 0..10, Execution::Chained, InstructionSet::best())?;
/// drop(memory);
/// assert_eq!(a, [7.0; 10]);
/// # Ok::<(), stripmine_kernels::own::OwnKernelError>(())
/// ```
pub trait OwnKernel {
    /// Number type of the arrays and registers.
    type Lane: Element;
    /// Slots of the arrays.
    type Slots<'k>;

    /// Declares the arrays.
    fn declare<'k>(&self, arrays: &mut Declarations<'k>) -> Self::Slots<'k>;

    /// Executes the kernel on a machine, with the slots that [`declare`](OwnKernel::declare) returned.
    ///
    /// Mark it `#[inline(always)]`, or the chained execution calls a function for every operation.
    fn body<'k, M: Machine<Lane = Self::Lane>>(&self, machine: OwnMachine<'k, M>, slots: &Self::Slots<'k>);
}

/// Reasons why a kernel of a user, or its arrays, cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum OwnKernelError {
    /// More arrays than a kernel may have.
    #[error("the kernel declares {0} arrays; the limit is {1}")]
    TooManyArrays(usize, usize),
    /// Two written arrays have one name.
    #[error("array `{0}` is declared for writing twice; declare it once")]
    DeclaredTwice(String),
    /// An array is written, and read at a shift.
    #[error(
        "array `{0}` is written and read at a shift, so results would depend on the order of elements; write to another array"
    )]
    WrittenAndShifted(String),
    /// No array has this name.
    #[error("the kernel has no array `{name}`; its arrays are {}", known.join(", "))]
    UnknownArray {
        /// The name.
        name: String,
        /// Names of its arrays.
        known: Vec<String>,
    },
    /// An array is bound for reading, but the kernel writes it.
    #[error("array `{0}` is written by the kernel; bind it for writing")]
    ReadOnly(String),
    /// An array is not bound.
    #[error("array `{0}` is not bound; bind every array before the run")]
    Unbound(String),
    /// Arrays differ in length.
    #[error("array `{name}` has {length} elements, but `{other}` has {expected}; give all the same length")]
    Length {
        /// Name of the array.
        name: String,
        /// Its length.
        length: usize,
        /// Name of the first array.
        other: String,
        /// Length of the first array.
        expected: usize,
    },
    /// The range and its shifts leave the arrays.
    #[error("array `{name}` has elements 0 to {last}, but the range and its shifts need {first} to {end}")]
    Range {
        /// Name of the array.
        name: String,
        /// Its last element.
        last: usize,
        /// First element needed.
        first: isize,
        /// Last element needed.
        end: isize,
    },
    /// The run was refused for another reason.
    #[error(transparent)]
    Program(#[from] ProgramError),
}

/// A kernel of a user with its slots.
struct CheckedKernel<K: OwnKernel> {
    kernel: K,
    slots: K::Slots<'static>,
    arrays: Vec<DeclaredArray>,
}

// SAFETY: the body can only use slots of its own declarations (their lifetime is that of the machine, and no other slots have it), and memory is checked
// against all declarations before a run.
unsafe impl<K: OwnKernel> Kernel for CheckedKernel<K> {
    type Lane = K::Lane;

    #[inline(always)]
    fn body<M: Machine<Lane = K::Lane>>(&self, machine: M) {
        self.kernel.body(OwnMachine::new(machine), &self.slots);
    }
}

/// A kernel of a user, recorded: counted, listed, emitted and run in every execution.
pub struct OwnProgram<K: OwnKernel>(Program<CheckedKernel<K>>);

impl<K: OwnKernel> std::fmt::Debug for OwnProgram<K> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("OwnProgram").field(&self.arrays()).finish()
    }
}

impl<K: OwnKernel> OwnProgram<K> {
    /// Records the kernel.
    ///
    /// # Errors
    /// [`OwnKernelError`] names an array that is declared twice, or written and read at a shift.
    pub fn new(kernel: K) -> Result<OwnProgram<K>, OwnKernelError> {
        let mut declarations = Declarations::default();
        let slots = kernel.declare(&mut declarations);
        let checked = CheckedKernel { kernel, slots, arrays: declarations.finished()? };
        let names = checked.arrays.iter().map(|array| array.name.clone()).collect();
        let (tape, footprint) = (Tape::record(&checked), footprint(&checked.arrays, K::Lane::NAME));
        Ok(OwnProgram(Program::with_footprint(checked, tape.with_names(names), footprint)))
    }

    /// The kernel.
    pub fn kernel(&self) -> &K {
        &self.0.kernel().kernel
    }

    /// Arrays in the order of their declaration.
    pub fn arrays(&self) -> &[DeclaredArray] {
        &self.0.kernel().arrays
    }

    /// Recorded instructions.
    pub fn tape(&self) -> &Tape<K::Lane> {
        self.0.tape()
    }

    /// Elements of arrays of a length that have a neighbour at every declared shift.
    pub fn interior(&self, length: usize) -> Range<usize> {
        let lowest = self.arrays().iter().map(|array| array.lowest).min().unwrap_or(0);
        let highest = self.arrays().iter().map(|array| array.highest).max().unwrap_or(0);
        let first = lowest.unsigned_abs().min(length);
        first..length.saturating_sub(highest.unsigned_abs()).max(first)
    }

    /// Memory without arrays.
    pub fn memory(&self) -> OwnMemory<'_, K::Lane> {
        OwnMemory::new(self.arrays())
    }
}

impl<K: OwnKernel + Send + Sync> OwnProgram<K>
where
    K::Lane: Precision,
    K::Slots<'static>: Send + Sync,
{
    /// The program with its type erased: counts, listing, code.
    pub fn runnable(&self) -> &dyn Runnable {
        &self.0
    }

    /// Runs the kernel for a range of elements.
    ///
    /// # Errors
    /// [`OwnKernelError`] names an array that is not bound, of another length, or too short for the range and its shifts. Nothing was executed then.
    pub fn run(
        &self,
        memory: &OwnMemory<'_, K::Lane>,
        range: Range<usize>,
        execution: Execution,
        set: InstructionSet,
    ) -> Result<(), OwnKernelError> {
        Ok(self.0.run_on_threads(memory.checked(&range)?, range, execution, set)?)
    }
}

#[cfg(test)]
mod tests;
