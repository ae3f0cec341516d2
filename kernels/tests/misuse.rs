//! Kernels that cannot run are rejected before anything is written, with the reason.

use std::panic::{AssertUnwindSafe, catch_unwind};
use stripmine_kernels::isa::{Array, Kernel, LaneCounter, Machine, Memory, ProgramError, Slot, Vector};
use stripmine_kernels::{Execution, InstructionSet, Program};

const X: Slot<f64> = Slot::new(Array::X);
const FX: Slot<f64> = Slot::new(Array::Fx);
const FY: Slot<f64> = Slot::new(Array::Fy);
const CELL: Slot<u32> = Slot::new(Array::DiscCell);
const INDEX: Slot<u32> = Slot::new(Array::Index);
const COUNTED: LaneCounter = LaneCounter(2);

const BEST: fn() -> InstructionSet = InstructionSet::best;

/// Executions that differ in how they access memory.
fn configurations() -> impl Iterator<Item = (Execution, InstructionSet)> {
    [Execution::Chained, Execution::Strip(5), Execution::Eager]
        .into_iter()
        .flat_map(|execution| [InstructionSet::Scalar, BEST()].map(|set| (execution, set)))
}

/// Fx = x three elements back + x two ahead, Fy = 1, and a count: makes every kind of access that is checked.
#[derive(Clone, Copy)]
struct Touch;

// SAFETY: the body names its slots unconditionally.
unsafe impl Kernel for Touch {
    type Lane = f64;

    fn body<M: Machine<Lane = f64>>(&self, m: M) {
        m.store(FY, m.uniform(1.0));
        let sum = m.load_shifted(X, -3) + m.load_shifted(X, 2);
        m.count(COUNTED, m.uniform(0.0).less_than(sum));
        m.store(FX, sum);
    }
}

/// Arrays of [`Touch`].
struct Touched {
    x: Vec<f64>,
    fx: Vec<f64>,
    fy: Vec<f64>,
}

impl Touched {
    fn new(x: usize, fx: usize, fy: usize) -> Touched {
        Touched { x: vec![1.0; x], fx: vec![-7.0; fx], fy: vec![-7.0; fy] }
    }

    fn untouched(&self) -> bool {
        self.fx.iter().chain(&self.fy).all(|&f| f == -7.0)
    }

    fn memory(&mut self) -> Memory<'_> {
        Memory::new().read(X, &self.x).write(FX, &mut self.fx).write(FY, &mut self.fy)
    }
}

/// Runs a kernel that must be rejected; nothing may have been written or counted.
fn refused<T: Kernel<Lane = f64>>(
    text: T,
    arrays: &mut Touched,
    range: std::ops::Range<usize>,
    (execution, set): (Execution, InstructionSet),
) -> ProgramError {
    let memory = arrays.memory();
    let error = Program::new(text).run(&memory, range, execution, set).unwrap_err();
    assert_eq!(memory.counted(COUNTED), 0, "counted after {error}");
    assert!(arrays.untouched(), "written after {error}");
    error
}

/// Control of the tests below: without an error, the same kernel writes and counts in every execution.
#[test]
fn valid_kernels_run_in_every_execution() {
    for (execution, set) in configurations() {
        let mut arrays = Touched::new(32, 32, 32);
        let memory = arrays.memory();
        Program::new(Touch).run(&memory, 3..30, execution, set).unwrap();
        assert_eq!(memory.counted(COUNTED), 27);
        for (i, (fx, fy)) in arrays.fx.iter().zip(&arrays.fy).enumerate() {
            let expected = if (3..30).contains(&i) { [2.0, 1.0] } else { [-7.0, -7.0] };
            assert_eq!([*fx, *fy], expected, "element {i} with {execution:?} on {set:?}");
        }
    }
}

/// The error names an unbound array with the requested element type; a slice of another type is no substitute.
#[test]
fn errors_name_unbound_arrays() {
    for (execution, set) in configurations() {
        let error = Program::new(Touch).run(&Memory::new(), 0..0, execution, set).unwrap_err();
        assert_eq!(error, ProgramError::Unbound { array: "Fy", element: "f64" });
        assert_eq!(error.to_string(), "array Fy (f64) is not bound to a slice; bind it before the run");

        let (single, mut fx, mut fy) = (vec![1f32; 32], vec![-7.0; 32], vec![-7.0; 32]);
        let memory =
            Memory::new().read(Slot::<f32>::new(Array::X), &single).write(FX, &mut fx).write(FY, &mut fy);
        let error = Program::new(Touch).run(&memory, 3..30, execution, set).unwrap_err();
        assert_eq!(error, ProgramError::Unbound { array: "x", element: "f64" });
        assert!(fx.iter().chain(&fy).all(|&f| f == -7.0));
    }
}

/// An array that is written must be bound for writing, for stores and for scatters.
#[test]
fn writes_to_read_only_arrays_are_rejected() {
    for (execution, set) in configurations() {
        let (x, fx, mut fy) = (vec![1.0; 32], vec![-7.0; 32], vec![-7.0; 32]);
        let memory = Memory::new().read(X, &x).read(FX, &fx).write(FY, &mut fy);
        let error = Program::new(Touch).run(&memory, 3..30, execution, set).unwrap_err();
        assert_eq!(error, ProgramError::ReadOnly { array: "Fx" });
        assert_eq!(
            error.to_string(),
            "array Fx is bound read-only, but the kernel writes it; bind it for writing"
        );
        assert!(fy.iter().all(|&f| f == -7.0));

        let (cell, index) = (vec![1; 4], vec![0; 4]);
        let memory = Memory::new().read(CELL, &cell).read(INDEX, &index);
        let error = Program::new(Through::Scatter).run(&memory, 0..4, execution, set).unwrap_err();
        assert_eq!(error, ProgramError::ReadOnly { array: "Index" });
        assert_eq!(index, [0; 4]);
    }
}

/// Shifts before the first or behind the last element are rejected, with the exact elements.
#[test]
fn too_short_arrays_are_rejected_exactly() {
    let range = |start: usize, end: usize, arrays: [usize; 3], configuration| {
        let [x, fx, fy] = arrays;
        refused(Touch, &mut Touched::new(x, fx, fy), start..end, configuration)
    };
    for configuration in configurations() {
        // x is read from 3 before to 2 behind.
        let error = range(2, 8, [10, 10, 10], configuration);
        assert_eq!(error, ProgramError::TooShort { array: "x", first: -1, last: 9, length: 10 });
        assert_eq!(error.to_string(), "x has 10 elements, but the kernel touches elements -1 to 9");
        let error = range(3, 9, [10, 10, 10], configuration);
        assert_eq!(error, ProgramError::TooShort { array: "x", first: 0, last: 10, length: 10 });
        let error = range(3, 8, [10, 7, 8], configuration);
        assert_eq!(error, ProgramError::TooShort { array: "Fx", first: 3, last: 7, length: 7 });
        let error = range(3, 8, [10, 8, 0], configuration);
        assert_eq!(error, ProgramError::TooShort { array: "Fy", first: 3, last: 7, length: 0 });
        // The exact size suffices, and an empty range touches nothing.
        for (range, written) in [(3..8, 5), (0..0, 0), (500..500, 0)] {
            let mut arrays = Touched::new(10, 8, 8);
            let memory = arrays.memory();
            Program::new(Touch).run(&memory, range, configuration.0, configuration.1).unwrap();
            assert_eq!(memory.counted(COUNTED), written);
        }
    }
}

/// Strips without elements.
#[test]
fn empty_strips_are_rejected() {
    for set in [InstructionSet::Scalar, BEST()] {
        let mut arrays = Touched::new(40, 40, 40);
        let error = refused(Touch, &mut arrays, 3..30, (Execution::Strip(0), set));
        assert_eq!(error, ProgramError::EmptyStrip);
    }
}

/// The error names an instruction set that this processor lacks (no processor has both AVX2 and Neon).
#[test]
fn errors_name_absent_instruction_sets() {
    let mut absent = InstructionSet::ALL.iter().copied().filter(|set| !set.is_available()).peekable();
    assert!(absent.peek().is_some());
    for set in absent {
        let mut arrays = Touched::new(40, 40, 40);
        for execution in [Execution::Chained, Execution::Eager, Execution::Strip(4)] {
            let error = refused(Touch, &mut arrays, 3..30, (execution, set));
            assert_eq!(error, ProgramError::NoSuchInstructionSet(set.name()));
            assert!(error.to_string().contains(set.name()));
        }
    }
}

/// Reads x beside the own element and writes it: strips would read each other's results.
#[derive(Clone, Copy)]
struct Hazard;

// SAFETY: the body names its slot unconditionally.
unsafe impl Kernel for Hazard {
    type Lane = f64;

    fn body<M: Machine<Lane = f64>>(&self, m: M) {
        m.store(X, m.load(X) + m.load_shifted(X, 1));
    }
}

/// A kernel that writes an array it also reads at a shift is rejected.
#[test]
#[should_panic(expected = "x is written and read at a shift, so results would depend on the strip length")]
fn kernels_with_shift_hazards_are_rejected() {
    Program::new(Hazard);
}

/// Accesses memory through the index vector in `DiscCell`.
#[derive(Clone, Copy, Debug)]
enum Through {
    Gather,
    GatherIndex,
    Scatter,
}

// SAFETY: the slots depend on the variant only.
unsafe impl Kernel for Through {
    type Lane = f64;

    fn body<M: Machine<Lane = f64>>(&self, m: M) {
        let cell = m.load_index(CELL);
        match self {
            Through::Gather => m.store(FX, m.gather(X, cell, m.uniform(-1.0))),
            Through::GatherIndex => m.store(FX, m.index_numbers(m.gather_index(INDEX, cell))),
            Through::Scatter => m.scatter_index(INDEX, cell, m.to_index(m.numbers())),
        }
    }
}

/// Runs `text` over all of `cell`. Returns Fx and Index, both of `length` elements, or the panic message.
fn through(
    text: Through,
    cell: &[u32],
    length: usize,
    (execution, set): (Execution, InstructionSet),
) -> Result<(Vec<f64>, Vec<u32>), String> {
    let x: Vec<f64> = (0..length).map(|i| 10.0 + i as f64).collect();
    let mut fx = vec![0.0; cell.len()];
    let mut index: Vec<u32> = (0..length).map(|i| 100 + i as u32).collect();
    let memory = Memory::new().read(X, &x).write(FX, &mut fx).read(CELL, cell).write(INDEX, &mut index);
    let run = || Program::new(text).run(&memory, 0..cell.len(), execution, set).unwrap();
    let outcome = catch_unwind(AssertUnwindSafe(run));
    match outcome {
        Ok(()) => Ok((fx, index)),
        Err(panic) => Err(panic.downcast_ref::<String>().expect("a formatted message").clone()),
    }
}

/// Index vectors number elements from 1 to the array's length, and 0 is none.
#[test]
fn an_index_vector_numbers_elements_from_one() {
    let cell = [8, 1, 0, 3, 0, 2, 2, 8, 1, 5, 0];
    for configuration in configurations() {
        let (fx, _) = through(Through::Gather, &cell, 8, configuration).unwrap();
        let expected = cell.map(|number| if number == 0 { -1.0 } else { 9.0 + f64::from(number) });
        assert_eq!(fx, expected, "{configuration:?}");
        let (fx, _) = through(Through::GatherIndex, &cell, 8, configuration).unwrap();
        assert_eq!(
            fx,
            cell.map(|number| if number == 0 { 0.0 } else { 99.0 + f64::from(number) }),
            "{configuration:?}"
        );
        let (_, index) = through(Through::Scatter, &cell, 8, configuration).unwrap();
        assert_eq!(index, [9, 7, 4, 103, 10, 105, 106, 8], "{configuration:?}");
    }
}

/// A wrong entry anywhere panics with the element (from 0) and the length; nothing is read or written out of bounds.
#[test]
fn wrong_indices_panic_with_element_and_length() {
    for configuration in configurations() {
        for (text, what, why) in [
            (Through::Gather, "gather from", "the array has 8 elements"),
            (Through::GatherIndex, "gather from", "the array has 8 elements"),
            (Through::Scatter, "scatter to", "the array must be writable and has 8 elements"),
        ] {
            for wrong in [9, 1000, u32::MAX] {
                for at in [0, 1, 6, 16, 36] {
                    let mut cell = vec![3; 37];
                    cell[at] = wrong;
                    let message = through(text, &cell, 8, configuration).unwrap_err();
                    assert_eq!(
                        message,
                        format!("{what} element {}, but {why}", wrong - 1),
                        "{text:?} {configuration:?}"
                    );
                }
            }
        }
    }
}

/// An empty array has no element to gather: an entry that numbers one panics in every execution.
#[test]
fn gathering_from_empty_arrays_panics() {
    for configuration in configurations() {
        assert_eq!(through(Through::Gather, &[0, 0, 0], 0, configuration).unwrap().0, [-1.0; 3]);
        let message = through(Through::Gather, &[0, 1, 0], 0, configuration);
        assert_eq!(
            message,
            Err("gather from element 0, but the array has 0 elements".to_owned()),
            "{configuration:?}"
        );
    }
}
