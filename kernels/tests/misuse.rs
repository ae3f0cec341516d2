//! What cannot run is refused before anything is written, and says why; and what a tape promises about its
//! instructions.

use std::panic::{AssertUnwindSafe, catch_unwind};
use stripmine_kernels::backend::tape::{Action, File, Operand, RegisterName};
use stripmine_kernels::backend::{Precision, Tape};
use stripmine_kernels::integrator::gear::{Acceleration, Corrector, Inertia, Predictor};
use stripmine_kernels::isa::{
    Array, Counter, Element, Machine, Memory, Op, OpCounts, ProgramError, Slot, Text, Vector,
};
use stripmine_kernels::law::Law;
use stripmine_kernels::law::granular::{Contact, ContactArm, Disc, Granular};
use stripmine_kernels::mask::Mask;
use stripmine_kernels::sweep::lattice::cells::{Check, Clear, Enter, Images};
use stripmine_kernels::sweep::lattice::forces::{Forces, Join};
use stripmine_kernels::sweep::lattice::vectors::Spread;
use stripmine_kernels::sweep::lattice::{Coordinates, Frame, LatticeShape};
use stripmine_kernels::{Execution, GROUP, InstructionSet, Program};

const X: Slot<f64> = Slot::new(Array::X);
const FX: Slot<f64> = Slot::new(Array::Fx);
const FY: Slot<f64> = Slot::new(Array::Fy);
const CELL: Slot<u32> = Slot::new(Array::DiscCell);
const INDEX: Slot<u32> = Slot::new(Array::Index);
const COUNTED: Counter = Counter(2);

const BEST: fn() -> InstructionSet = InstructionSet::best;

/// The ways to execute that differ in how they reach memory.
fn ways() -> impl Iterator<Item = (Execution, InstructionSet)> {
    [Execution::Chained, Execution::Block(2), Execution::Strip(5), Execution::Eager]
        .into_iter()
        .flat_map(|execution| [InstructionSet::Scalar, BEST()].map(|set| (execution, set)))
}

/// Fx = x three elements back + x two ahead, Fy = 1, and a count: touches memory in every way that is
/// checked.
#[derive(Clone, Copy)]
struct Touch<const GROUPED: bool>;

// SAFETY: the body names its slots unconditionally.
unsafe impl<const GROUPED: bool> Text for Touch<GROUPED> {
    type Lane = f64;
    const GROUP: Option<usize> = if GROUPED { Some(GROUP) } else { None };

    fn body<M: Machine<Lane = f64>>(&self, m: M) {
        m.store(FY, m.uniform(1.0));
        let sum = m.load_shifted(X, -3) + m.load_shifted(X, 2);
        m.count(COUNTED, m.uniform(0.0).less_than(sum));
        m.store(FX, sum);
    }
}

/// The arrays of [`Touch`].
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

/// Runs a program that must be refused; nothing may have been written or counted.
fn refused<T: Text<Lane = f64>>(
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

/// The control of the tests below: where nothing is wrong, the same program writes and counts in every way.
#[test]
fn a_program_with_nothing_wrong_runs() {
    for (execution, set) in ways() {
        let mut arrays = Touched::new(32, 32, 32);
        let memory = arrays.memory();
        Program::new(Touch::<false>).run(&memory, 3..30, execution, set).unwrap();
        assert_eq!(memory.counted(COUNTED), 27);
        for (i, (fx, fy)) in arrays.fx.iter().zip(&arrays.fy).enumerate() {
            let expected = if (3..30).contains(&i) { [2.0, 1.0] } else { [-7.0, -7.0] };
            assert_eq!([*fx, *fy], expected, "element {i} with {execution:?} on {set:?}");
        }
    }
}

/// An array bound to no slice is named with the element type asked for; another type's slice does not stand
/// in.
#[test]
fn an_unbound_array_is_named() {
    for (execution, set) in ways() {
        let error = Program::new(Touch::<false>).run(&Memory::new(), 0..0, execution, set).unwrap_err();
        assert_eq!(error, ProgramError::Unbound { array: "Fy", element: "f64" });
        assert_eq!(error.to_string(), "the program uses Fy (f64), which is bound to no slice");

        let (single, mut fx, mut fy) = (vec![1f32; 32], vec![-7.0; 32], vec![-7.0; 32]);
        let memory =
            Memory::new().read(Slot::<f32>::new(Array::X), &single).write(FX, &mut fx).write(FY, &mut fy);
        let error = Program::new(Touch::<false>).run(&memory, 3..30, execution, set).unwrap_err();
        assert_eq!(error, ProgramError::Unbound { array: "x", element: "f64" });
        assert!(fx.iter().chain(&fy).all(|&f| f == -7.0));
    }
}

/// An array that is written must have been bound for writing, by stores as by scatters.
#[test]
fn writing_an_array_bound_for_reading_is_refused() {
    for (execution, set) in ways() {
        let (x, fx, mut fy) = (vec![1.0; 32], vec![-7.0; 32], vec![-7.0; 32]);
        let memory = Memory::new().read(X, &x).read(FX, &fx).write(FY, &mut fy);
        let error = Program::new(Touch::<false>).run(&memory, 3..30, execution, set).unwrap_err();
        assert_eq!(error, ProgramError::ReadOnly { array: "Fx" });
        assert_eq!(error.to_string(), "the program writes Fx, which is bound for reading only");
        assert!(fy.iter().all(|&f| f == -7.0));

        let (cell, index) = (vec![1; 4], vec![0; 4]);
        let memory = Memory::new().read(CELL, &cell).read(INDEX, &index);
        let error = Program::new(Through::Scatter).run(&memory, 0..4, execution, set).unwrap_err();
        assert_eq!(error, ProgramError::ReadOnly { array: "Index" });
        assert_eq!(index, [0; 4]);
    }
}

/// Shifts that reach before the first or behind the last element are refused, to the element, with the
/// numbers.
#[test]
fn too_short_an_array_is_refused_to_the_element() {
    let range = |start: usize, end: usize, arrays: [usize; 3], way| {
        let [x, fx, fy] = arrays;
        refused(Touch::<false>, &mut Touched::new(x, fx, fy), start..end, way)
    };
    for way in ways() {
        // x is met from 3 before to 2 behind.
        let error = range(2, 8, [10, 10, 10], way);
        assert_eq!(error, ProgramError::TooShort { array: "x", first: -1, last: 9, length: 10 });
        assert_eq!(error.to_string(), "the program touches elements -1 to 9 of x, which has 10");
        let error = range(3, 9, [10, 10, 10], way);
        assert_eq!(error, ProgramError::TooShort { array: "x", first: 0, last: 10, length: 10 });
        let error = range(3, 8, [10, 7, 8], way);
        assert_eq!(error, ProgramError::TooShort { array: "Fx", first: 3, last: 7, length: 7 });
        let error = range(3, 8, [10, 8, 0], way);
        assert_eq!(error, ProgramError::TooShort { array: "Fy", first: 3, last: 7, length: 0 });
        // Just enough is enough, and an empty range touches nothing.
        for (range, written) in [(3..8, 5), (0..0, 0), (500..500, 0)] {
            let mut arrays = Touched::new(10, 8, 8);
            let memory = arrays.memory();
            Program::new(Touch::<false>).run(&memory, range, way.0, way.1).unwrap();
            assert_eq!(memory.counted(COUNTED), written);
        }
    }
}

/// Strips of no elements and strips that are not compiled.
#[test]
fn impossible_strips_are_refused() {
    for set in [InstructionSet::Scalar, BEST()] {
        let mut arrays = Touched::new(40, 40, 40);
        let mut try_it = |execution| refused(Touch::<false>, &mut arrays, 3..30, (execution, set));
        assert_eq!(try_it(Execution::Strip(0)), ProgramError::EmptyStrip);
        for asked in [0, 1, 5, 16] {
            let error = try_it(Execution::Block(asked));
            assert_eq!(error, ProgramError::NoSuchBlock { asked, compiled: &[2, 8] });
            let expected = format!("strips of {asked} registers are not compiled; these are: [2, 8]");
            assert_eq!(error.to_string(), expected);
        }
    }
}

/// A text that sums in groups runs in whole groups only.
#[test]
fn groups_are_neither_cut_nor_changed() {
    let mut arrays = Touched::new(128, 128, 128);
    for set in [InstructionSet::Scalar, BEST()] {
        for (start, end) in [(16, 47), (17, 48), (3, 19), (8, 24)] {
            for execution in [Execution::Chained, Execution::Strip(GROUP)] {
                let error = refused(Touch::<true>, &mut arrays, start..end, (execution, set));
                assert_eq!(error, ProgramError::PartialGroup { group: GROUP, start, end });
            }
        }
        let with = [
            (Execution::Eager, 32),
            (Execution::Block(2), 32),
            (Execution::Block(5), 32),
            (Execution::Strip(8), 8),
            (Execution::Strip(32), 32),
            (Execution::Strip(0), 0),
        ];
        for (execution, asked) in with {
            let error = refused(Touch::<true>, &mut arrays, 16..48, (execution, set));
            assert_eq!(error, ProgramError::FixedGroup { group: GROUP, asked }, "{execution:?}");
        }
        for execution in [Execution::Chained, Execution::Strip(GROUP)] {
            let mut arrays = Touched::new(128, 128, 128);
            let memory = arrays.memory();
            Program::new(Touch::<true>).run(&memory, 16..48, execution, set).unwrap();
            assert_eq!(memory.counted(COUNTED), 32);
        }
    }
}

/// An instruction set that this processor has not (no processor has both AVX2 and Neon) is named.
#[test]
fn an_absent_instruction_set_is_named() {
    let mut absent = InstructionSet::ALL.iter().copied().filter(|set| !set.is_available()).peekable();
    assert!(absent.peek().is_some());
    for set in absent {
        let mut arrays = Touched::new(40, 40, 40);
        for execution in [Execution::Chained, Execution::Block(8), Execution::Eager, Execution::Strip(4)] {
            let error = refused(Touch::<false>, &mut arrays, 3..30, (execution, set));
            assert_eq!(error, ProgramError::NoSuchInstructionSet(set.name()));
            assert!(error.to_string().contains(set.name()));
        }
    }
}

/// Reads x beside its own place and writes it: of strips, the one would see what the other wrote.
#[derive(Clone, Copy)]
enum Hazard<const GROUPED: bool> {
    Load,
    Store,
}

// SAFETY: the slots depend on the variant only.
unsafe impl<const GROUPED: bool> Text for Hazard<GROUPED> {
    type Lane = f64;
    const GROUP: Option<usize> = if GROUPED { Some(GROUP) } else { None };

    fn body<M: Machine<Lane = f64>>(&self, m: M) {
        match self {
            Hazard::Load => m.store(X, m.load(X) + m.load_shifted(X, 1)),
            Hazard::Store => m.store_shifted(X, -1, m.uniform(2.0)),
        }
    }
}

/// A text that writes what it also meets at a shift is none, unless it sums in groups.
#[test]
#[should_panic(expected = "x is written and met at a shift: strips would see each other's results")]
fn a_text_that_writes_what_it_loads_at_a_shift_is_refused() {
    Program::new(Hazard::<false>::Load);
}

/// A store at a shift alone is such a text too.
#[test]
#[should_panic(expected = "x is written and met at a shift: strips would see each other's results")]
fn a_text_that_stores_at_a_shift_is_refused() {
    Program::new(Hazard::<false>::Store);
}

/// In groups of fixed length the order is defined, so both texts are programs.
#[test]
fn texts_in_groups_may_write_at_shifts() {
    assert_eq!(Program::new(Hazard::<true>::Load).tape().instructions().len(), 4);
    assert_eq!(Program::new(Hazard::<true>::Store).tape().instructions().len(), 1);
}

/// A full sweep is refused a half mask, and the other way round.
#[test]
#[should_panic(expected = "a half mask for a half sweep, a full one for a full sweep")]
fn a_half_mask_is_none_for_a_full_sweep() {
    let mask = Mask::square(2);
    let (shape, frame) = lattice(&mask);
    Forces::<f64, _, false>::new(law::<true, false>(), &mask.half(), shape, frame, Coordinates::Absolute);
}

/// Meets memory through the index vector in `DiscCell`.
#[derive(Clone, Copy, Debug)]
enum Through {
    Gather,
    GatherIndex,
    Scatter,
}

// SAFETY: the slots depend on the variant only.
unsafe impl Text for Through {
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

/// What running `text` over all of `cell` leaves in Fx and Index, both of `length` elements, or the panic's
/// message.
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
    for way in ways() {
        let (fx, _) = through(Through::Gather, &cell, 8, way).unwrap();
        let expected = cell.map(|number| if number == 0 { -1.0 } else { 9.0 + f64::from(number) });
        assert_eq!(fx, expected, "{way:?}");
        let (fx, _) = through(Through::GatherIndex, &cell, 8, way).unwrap();
        assert_eq!(
            fx,
            cell.map(|number| if number == 0 { 0.0 } else { 99.0 + f64::from(number) }),
            "{way:?}"
        );
        let (_, index) = through(Through::Scatter, &cell, 8, way).unwrap();
        assert_eq!(index, [9, 7, 4, 103, 10, 105, 106, 8], "{way:?}");
    }
}

/// A wrong entry anywhere panics, naming the element (from 0) and how many there are; it never reads or
/// writes beyond.
#[test]
fn a_wrong_index_vector_panics_with_element_and_length() {
    for way in ways() {
        for (text, what) in [
            (Through::Gather, "gather from"),
            (Through::GatherIndex, "gather from"),
            (Through::Scatter, "scatter to"),
        ] {
            for wrong in [9, 1000, u32::MAX] {
                for at in [0, 1, 6, 16, 36] {
                    let mut cell = vec![3; 37];
                    cell[at] = wrong;
                    let message = through(text, &cell, 8, way).unwrap_err();
                    assert_eq!(message, format!("{what} element {} of 8", wrong - 1), "{text:?} {way:?}");
                }
            }
        }
    }
}

/// An array without elements has none to gather: an entry that numbers one panics, whatever the execution.
#[test]
fn gathering_from_an_empty_array_panics_in_every_execution() {
    for way in ways() {
        assert_eq!(through(Through::Gather, &[0, 0, 0], 0, way).unwrap().0, [-1.0; 3]);
        let message = through(Through::Gather, &[0, 1, 0], 0, way);
        assert_eq!(message, Err("gather from element 0 of 0".to_owned()), "{way:?}");
    }
}

// ---- tapes ----------------------------------------------------------------------------------------------

fn law<const FRICTION: bool, const EQUAL: bool>() -> Granular<FRICTION, EQUAL> {
    let contact = Contact {
        stiffness: 100.0,
        normal_damping: 3.0,
        shear_damping: 2.0,
        friction: 0.5,
        cohesionless: true,
        arm: ContactArm::Overlap,
    };
    Granular { contact, disc: Disc { radius: 1.0, inverse_mass: 1.0 } }
}

fn lattice(mask: &Mask) -> (LatticeShape, Frame) {
    let shape = LatticeShape::new(9, 7, mask, [true, false]).unwrap();
    (shape, Frame { origin: [0.0, 0.0], edge: [1.1, 1.2] })
}

/// What an instruction reads, told from its action alone.
fn reads<L: Copy>(action: &Action<L>) -> Vec<RegisterName> {
    let register = |operand: &Operand<L>| match operand {
        Operand::Register(name) => Some(*name),
        Operand::Uniform(_) => None,
    };
    let names: Vec<Option<RegisterName>> = match action {
        Action::Unary(a) | Action::ToIndex(a) | Action::Store(_, a) => vec![register(a)],
        Action::Binary(a, b) | Action::Compare(a, b) => vec![register(a), register(b)],
        Action::Logic(a, b) => vec![Some(*a), *b],
        Action::Select(p, a, b) => vec![Some(*p), register(a), register(b)],
        Action::Count(a, _) | Action::FromIndex(a) | Action::StoreIndex(_, a) | Action::GatherIndex(_, a) => {
            vec![Some(*a)]
        }
        Action::Gather(_, a, elsewhere) => vec![Some(*a), register(elsewhere)],
        Action::ScatterIndex(_, a, b) => vec![Some(*a), Some(*b)],
        Action::Numbers | Action::Load(_) | Action::LoadIndex(_) => vec![],
    };
    names.into_iter().flatten().collect()
}

/// The register file an instruction's result goes to.
fn result_file<L>(action: &Action<L>) -> Option<File> {
    match action {
        Action::Unary(_)
        | Action::Binary(..)
        | Action::Select(..)
        | Action::Numbers
        | Action::FromIndex(_)
        | Action::Load(_)
        | Action::Gather(..) => Some(File::Number),
        Action::Compare(..) | Action::Logic(..) => Some(File::Predicate),
        Action::ToIndex(_) | Action::LoadIndex(_) | Action::GatherIndex(..) => Some(File::Index),
        Action::Count(..) | Action::Store(..) | Action::StoreIndex(..) | Action::ScatterIndex(..) => None,
    }
}

/// Follows the registers through a tape: read only what was written, results apart from operands and read
/// before they are overwritten, as many registers as the tape says.
fn registers_are_sound<L: Element>(name: &str, tape: &Tape<L>) {
    use std::collections::HashMap;
    let mut held: HashMap<RegisterName, bool> = HashMap::new();
    let mut used = [const { Vec::new() }; 3];
    for (at, instruction) in tape.instructions().iter().enumerate() {
        let operands = reads(&instruction.action);
        for operand in &operands {
            let read = held.get_mut(operand);
            *read.unwrap_or_else(|| panic!("{name}: {} reads {operand}, never written", at + 1)) = true;
        }
        assert_eq!(instruction.to.map(|to| to.file), result_file(&instruction.action), "{name}: {}", at + 1);
        if let Some(to) = instruction.to {
            assert!(!operands.contains(&to), "{name}: {} writes its operand {to}", at + 1);
            let before = held.insert(to, false);
            assert_ne!(before, Some(false), "{name}: {} overwrites {to}, which nobody read", at + 1);
            used[to.file as usize].push(to.number as usize);
        }
    }
    assert!(held.values().all(|&read| read), "{name}: results that nobody reads");
    for file in File::ALL {
        let numbers = &mut used[file as usize];
        numbers.sort_unstable();
        numbers.dedup();
        assert_eq!(*numbers, (0..tape.registers(file)).collect::<Vec<_>>(), "{name}: {file:?}");
    }
}

/// Sums the instructions' operations by section and compares with the tally; conversions are found
/// independently.
fn tally_is_the_sum_over_instructions<L: Element>(name: &str, tape: &Tape<L>) {
    let mut sections: Vec<(usize, OpCounts)> = vec![];
    for instruction in tape.instructions() {
        if !sections.iter().any(|(section, _)| *section == instruction.section) {
            sections.push((instruction.section, OpCounts::default()));
        }
        let (_, counts) = sections.iter_mut().find(|(section, _)| *section == instruction.section).unwrap();
        counts.record(instruction.op);
        let converts = match instruction.action {
            Action::Load(there) | Action::Store(there, _) | Action::Gather(there, ..) => {
                there.element != L::NAME
            }
            _ => false,
        };
        if converts {
            counts.record(Op::Widen);
        }
    }
    sections.sort_by_key(|(section, _)| *section);
    let tally = tape.tally();
    assert_eq!(tally.len(), sections.len(), "{name}");
    for ((section, counted), (_, expected)) in tally.iter().zip(&sections) {
        assert_eq!(counted, expected, "{name}: {section}");
    }
    let executed: usize =
        tape.instructions().iter().map(|instruction| instruction.operations().count()).sum();
    let total: u64 = tally.iter().map(|(_, counts)| counts.total()).sum();
    assert_eq!(total, executed as u64, "{name}");
}

/// One line an instruction, numbered, with its mnemonic and registers, and a comment where the section
/// changes.
fn listing_has_a_line_for_each_instruction<L: Element>(name: &str, tape: &Tape<L>) {
    let listing = tape.listing().to_string();
    let mut lines = listing.lines();
    let mut order: Vec<usize> = tape.instructions().iter().map(|instruction| instruction.section).collect();
    order.sort_unstable();
    order.dedup();
    let tally = tape.tally();
    let mut section = None;
    for (at, instruction) in tape.instructions().iter().enumerate() {
        if section != Some(instruction.section) {
            section = Some(instruction.section);
            let named = tally[order.binary_search(&instruction.section).unwrap()].0;
            assert_eq!(lines.next().unwrap(), format!("; {named}"), "{name}");
        }
        let line = lines.next().unwrap();
        let mut words = line.split_whitespace();
        assert_eq!(words.next(), Some((at + 1).to_string().as_str()), "{name}: {line}");
        assert_eq!(words.next(), Some(instruction.op.mnemonic()), "{name}: {line}");
        let rest = words.collect::<Vec<_>>().join(" ");
        let mentioned: Vec<&str> = rest.split([',', ' ', '(', ')']).collect();
        for register in instruction.to.into_iter().chain(reads(&instruction.action)) {
            assert!(mentioned.contains(&register.to_string().as_str()), "{name}: {line} lacks {register}");
        }
        if let Some(there) = instruction.reference() {
            assert!(line.contains(there.array.label()), "{name}: {line}");
        }
    }
    assert_eq!(lines.next(), None, "{name}");
}

/// Every kernel text with its options, recorded.
fn every_tape(mut double: impl FnMut(&str, &Tape<f64>), mut single: impl FnMut(&str, &Tape<f32>)) {
    let inertia = Inertia::Equal { inverse_mass: 1.0, inverse_inertia: 2.0 };
    let fall = [0.0, -9.81];
    double("Predictor 6", &Tape::record(&Predictor::<f64, f64, 6, 3>::new(1e-3)));
    double("Predictor 4 to f32", &Tape::record(&Predictor::<f64, f32, 4, 2>::new(1e-3)));
    single("Predictor f32", &Tape::record(&Predictor::<f32, f32, 5, 3>::new(1e-3)));
    let corrector = Corrector::<f64, f64, 6, 3>::new(1e-3, Acceleration::OfPositions, Inertia::Varying, fall);
    double("Corrector 6", &Tape::record(&corrector));
    let corrector = Corrector::<f64, f32, 4, 3>::new(1e-3, Acceleration::OfVelocities, inertia, fall);
    double("Corrector 4 of f32", &Tape::record(&corrector));
    let corrector = Corrector::<f32, f32, 5, 2>::new(1e-3, Acceleration::OfVelocities, inertia, [0.0; 2]);
    single("Corrector f32", &Tape::record(&corrector));

    let mask = Mask::square(2);
    let (shape, frame) = lattice(&mask);
    double("Clear", &Tape::record(&Clear));
    double("Check", &Tape::record(&Check));
    double("Images", &Tape::record(&Images));
    for coordinates in [Coordinates::Absolute, Coordinates::CellRelative] {
        double("Enter f64", &Tape::record(&Enter::<f64, f64>::new(shape, frame, coordinates)));
        double("Enter f32", &Tape::record(&Enter::<f32, f32>::new(shape, frame, coordinates)));
        double("Enter f64 to f32", &Tape::record(&Enter::<f64, f32>::new(shape, frame, coordinates)));
        let fields = law::<true, false>().fields();
        double("Spread", &Tape::record(&Spread::<f64>::new(shape, coordinates, fields)));
        single("Spread f32", &Tape::record(&Spread::<f32>::new(shape, coordinates, fields)));
        let full = Forces::<f64, _, false>::new(law::<true, false>(), &mask, shape, frame, coordinates);
        double("Forces", &Tape::record(&full));
        let full = Forces::<f32, _, false>::new(law::<true, true>(), &mask, shape, frame, coordinates);
        single("Forces f32", &Tape::record(&full));
        let full = Forces::<f64, _, false>::new(law::<false, false>(), &mask, shape, frame, coordinates);
        double("Forces without friction", &Tape::record(&full));
        let half = Forces::<f64, _, true>::new(law::<true, false>(), &mask.half(), shape, frame, coordinates);
        double("half Forces", &Tape::record(&half));
    }
    double("Join", &Tape::record(&Join::<f64>::new(law::<true, false>().sums())));
    double("Touch", &Tape::record(&Touch::<false>));
    for text in [Through::Gather, Through::GatherIndex, Through::Scatter] {
        double("Through", &Tape::record(&text));
    }
    double("Folded", &Tape::record(&Folded::<f64>::default()));
    single("Folded f32", &Tape::record(&Folded::<f32>::default()));
}

/// Registers of every kernel text.
#[test]
fn no_instruction_reads_what_was_not_written_or_writes_what_it_reads() {
    every_tape(registers_are_sound, registers_are_sound);
}

/// The tally of every kernel text.
#[test]
fn tallies_are_sums_over_instructions() {
    every_tape(tally_is_the_sum_over_instructions, tally_is_the_sum_over_instructions);
}

/// The listing of every kernel text.
#[test]
fn listings_have_a_line_for_each_instruction() {
    every_tape(listing_has_a_line_for_each_instruction, listing_has_a_line_for_each_instruction);
}

/// A change of precision is counted at every load, gather and store that makes one, and nowhere else.
#[test]
fn changes_of_precision_are_counted() {
    fn widened<T: Text>(text: &T) -> u64 {
        Tape::record(text).tally().iter().map(|(_, counts)| counts.of(Op::Widen)).sum()
    }
    assert_eq!(widened(&Predictor::<f64, f64, 5, 3>::new(1e-3)), 0);
    assert_eq!(widened(&Predictor::<f64, f32, 5, 3>::new(1e-3)), 3);
    let mixed =
        Corrector::<f64, f32, 5, 2>::new(1e-3, Acceleration::OfVelocities, Inertia::Varying, [0.0; 2]);
    assert_eq!(widened(&mixed), 2);
    let (shape, frame) = lattice(&Mask::square(2));
    // Periodic along x only: two loads, one store of the wrapped x, two stores for the lattice.
    assert_eq!(widened(&Enter::<f32, f32>::new(shape, frame, Coordinates::CellRelative)), 5);
    assert_eq!(widened(&Enter::<f64, f32>::new(shape, frame, Coordinates::CellRelative)), 2);
}

/// Stores numbers that are known when the text is recorded, and one that is not.
#[derive(Clone, Copy, Default)]
struct Folded<L>(std::marker::PhantomData<L>);

// SAFETY: the body names its slots unconditionally.
unsafe impl<L: Element> Text for Folded<L> {
    type Lane = L;

    fn body<M: Machine<Lane = L>>(&self, m: M) {
        let [a, b] = [0.1, 0.2].map(|value| m.uniform(value));
        let known = ((a + b) * a - b / a).abs().sqrt().min(m.uniform(7.7).truncate()).max(a);
        m.store(Slot::<L>::new(Array::Fx), known);
        m.store(Slot::<L>::new(Array::Fy), m.load(Slot::<L>::new(Array::X)) + known);
    }
}

/// Arithmetic between scalar operands costs no instruction, is done in the lanes' precision, and gives what
/// executing it gives.
fn folding_costs_nothing<L: Precision>(expected: L) {
    let program = Program::new(Folded::<L>::default());
    let instructions = program.tape().instructions();
    let ops: Vec<Op> = instructions.iter().map(|instruction| instruction.op).collect();
    assert_eq!(ops, [Op::Store, Op::Load, Op::Add, Op::Store]);
    let Action::Store(_, Operand::Uniform(known)) = instructions[0].action else {
        panic!("{:?} stores no scalar operand", instructions[0]);
    };
    assert_eq!(known.bits(), expected.bits());
    for (execution, set) in ways() {
        let x: Vec<L> = (0..21).map(|i| L::from_f64(f64::from(i))).collect();
        let (mut fx, mut fy) = (vec![L::default(); 21], vec![L::default(); 21]);
        let memory = Memory::new()
            .read(Slot::new(Array::X), &x)
            .write(Slot::new(Array::Fx), &mut fx)
            .write(Slot::new(Array::Fy), &mut fy);
        program.run(&memory, 0..21, execution, set).unwrap();
        assert!(fx.iter().all(|f| f.bits() == expected.bits()), "{execution:?} on {set:?}");
        assert!(
            fy.iter().zip(&x).all(|(f, &x)| f.bits() == (x + expected).bits()),
            "{execution:?} on {set:?}"
        );
    }
}

/// Uniform arithmetic is folded, in either precision.
#[test]
fn uniform_arithmetic_is_folded() {
    let (a, b) = (0.1f64, 0.2f64);
    folding_costs_nothing(((a + b) * a - b / a).abs().sqrt());
    let (a, b) = (0.1f32, 0.2f32);
    folding_costs_nothing(((a + b) * a - b / a).abs().sqrt());
}
