//! Properties of tapes: registers, tallies, listings, folded arithmetic.

use std::collections::HashMap;
use stripmine_kernels::backend::tape::{
    Effect, Indices, Number, Operand, PredicateInstruction, RegisterKind, RegisterName, TapeAction,
};
use stripmine_kernels::backend::{Precision, Tape};
use stripmine_kernels::integrator::Inertia;
use stripmine_kernels::integrator::gear::{Acceleration, GearCorrector, GearPredictor};
use stripmine_kernels::isa::{Array, Element, Kernel, Machine, Memory, Op, OpCounts, Slot, Vector};
use stripmine_kernels::law::Law;
use stripmine_kernels::law::granular::{Contact, ContactArm, EqualDiscs, Granular};
use stripmine_kernels::law::spring::Spring;
use stripmine_kernels::mask::Mask;
use stripmine_kernels::sweep::lattice::cells::{CheckIndex, ClearIndex, EnterDiscs, IndexImages};
use stripmine_kernels::sweep::lattice::forces::Forces;
use stripmine_kernels::sweep::lattice::vectors::SpreadToLattice;
use stripmine_kernels::sweep::lattice::{Coordinates, LatticeFrame, LatticeShape};
use stripmine_kernels::{Execution, InstructionSet, Program};

fn law<const FRICTION: bool, const EQUAL: bool>() -> Granular<FRICTION, EQUAL> {
    let contact = Contact {
        spring: Spring::Hertz,
        stiffness: 100.0,
        normal_damping: 3.0,
        shear_damping: 2.0,
        friction: 0.5,
        cohesionless: true,
        arm: ContactArm::Overlap,
    };
    Granular { contact, disc: EqualDiscs { radius: 1.0, inverse_mass: 1.0 } }
}

fn lattice(mask: &Mask) -> (LatticeShape, LatticeFrame) {
    let shape = LatticeShape::new(9, 7, mask, [true, false]).unwrap();
    (shape, LatticeFrame { origin: [0.0, 0.0], edge: [1.1, 1.2] })
}

/// Registers that an instruction reads, from its action alone.
fn reads<L: Copy>(action: &TapeAction<L>) -> Vec<RegisterName> {
    let register = |operand: &Operand<L>| match operand {
        Operand::Register(name) => Some(*name),
        Operand::Uniform(_) => None,
        Operand::Memory(there) => panic!("a tape has {there:?} as an operand"),
    };
    let names: Vec<Option<RegisterName>> = match action {
        TapeAction::Number(_, number) => match number {
            Number::Unary(_, a) => vec![register(a)],
            Number::Binary(_, a, b) => vec![register(a), register(b)],
            Number::Select(p, a, b) => vec![Some(*p), register(a), register(b)],
            Number::FromIndex(a) => vec![Some(*a)],
            Number::Gather(_, a, elsewhere) => vec![Some(*a), register(elsewhere)],
            Number::Numbers | Number::Load(_) | Number::LoadShifted(_) => vec![],
        },
        TapeAction::Truth(_, truth) => match truth {
            PredicateInstruction::Compare(_, a, b) => vec![register(a), register(b)],
            PredicateInstruction::Connective(_, a, b) => vec![Some(*a), Some(*b)],
            PredicateInstruction::Negation(_, a) => vec![Some(*a)],
        },
        TapeAction::Indices(_, indices) => match indices {
            Indices::ToIndex(a) => vec![register(a)],
            Indices::Gather(_, a) => vec![Some(*a)],
            Indices::Load(_) => vec![],
        },
        TapeAction::Effect(effect) => match effect {
            Effect::Store(_, a) => vec![register(a)],
            Effect::Count(_, a) | Effect::StoreIndex(_, a) => vec![Some(*a)],
            Effect::Scatter(_, a, b) => vec![Some(*a), register(b)],
            Effect::ScatterIndex(_, a, b) => vec![Some(*a), Some(*b)],
        },
    };
    names.into_iter().flatten().collect()
}

/// Register file of an instruction's result.
fn result_file<L>(action: &TapeAction<L>) -> Option<RegisterKind> {
    match action {
        TapeAction::Number(..) => Some(RegisterKind::Number),
        TapeAction::Truth(..) => Some(RegisterKind::Predicate),
        TapeAction::Indices(..) => Some(RegisterKind::Index),
        TapeAction::Effect(_) => None,
    }
}

/// Follows the registers through a tape. Only written registers are read, values are read before they are overwritten, and there
/// are no more registers than values alive at once.
fn registers_are_sound<L: Element>(name: &str, tape: &Tape<L>) {
    let mut held: HashMap<RegisterName, usize> = HashMap::new();
    let mut last_read: Vec<(RegisterKind, usize, usize)> = Vec::new();
    for (at, instruction) in tape.instructions().iter().enumerate() {
        for operand in reads(&instruction.action) {
            let value = *held
                .get(&operand)
                .unwrap_or_else(|| panic!("{name}: {} reads {operand}, never written", at + 1));
            last_read[value].2 = at;
        }
        assert_eq!(
            instruction.to().map(|to| to.file),
            result_file(&instruction.action),
            "{name}: {}",
            at + 1
        );
        if let Some(to) = instruction.to() {
            if let Some(before) = held.insert(to, last_read.len()) {
                let (_, written, read) = last_read[before];
                assert!(read > written, "{name}: {} overwrites {to}, which was never read", at + 1);
            }
            last_read.push((to.file, at, at));
        }
    }
    assert!(last_read.iter().all(|(_, written, read)| read > written), "{name}: results that are never read");
    for file in RegisterKind::ALL {
        let alive = |at: usize| {
            last_read.iter().filter(|(of, written, read)| *of == file && *written <= at && at < *read).count()
        };
        let most = (0..tape.instructions().len()).map(alive).max().unwrap_or(0);
        assert_eq!(tape.registers(file), most, "{name}: {file:?}");
    }
}

/// Compares the tally with the sum of the instructions' operations by section; conversions are counted independently.
fn tally_is_the_sum_over_instructions<L: Element>(name: &str, tape: &Tape<L>) {
    let mut sections: Vec<(usize, OpCounts)> = vec![];
    for instruction in tape.instructions() {
        if !sections.iter().any(|(section, _)| *section == instruction.section) {
            sections.push((instruction.section, OpCounts::default()));
        }
        let (_, counts) = sections.iter_mut().find(|(section, _)| *section == instruction.section).unwrap();
        counts.record(instruction.op());
        let converts = match instruction.action {
            TapeAction::Number(
                _,
                Number::Load(there) | Number::LoadShifted(there) | Number::Gather(there, ..),
            )
            | TapeAction::Effect(Effect::Store(there, _)) => there.element != L::NAME,
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

/// Checks that each instruction has a numbered line with its mnemonic and registers, and that a comment marks each new section.
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
        assert_eq!(words.next(), Some(instruction.op().mnemonic()), "{name}: {line}");
        let rest = words.collect::<Vec<_>>().join(" ");
        let mentioned: Vec<&str> = rest.split([',', ' ', '(', ')']).collect();
        for register in instruction.to().into_iter().chain(reads(&instruction.action)) {
            assert!(mentioned.contains(&register.to_string().as_str()), "{name}: {line} lacks {register}");
        }
        if let Some(there) = instruction.reference() {
            assert!(line.contains(there.array.label()), "{name}: {line}");
        }
    }
    assert_eq!(lines.next(), None, "{name}");
}

/// Records every kernel with its options.
fn every_tape(mut double: impl FnMut(&str, &Tape<f64>), mut single: impl FnMut(&str, &Tape<f32>)) {
    let inertia = Inertia::Equal { inverse_mass: 1.0, inverse_inertia: 2.0 };
    let fall = [0.0, -9.81];
    double("Predictor 6", &Tape::record(&GearPredictor::<f64, f64, 6, 3>::new(1e-3)));
    double("Predictor 4 to f32", &Tape::record(&GearPredictor::<f64, f32, 4, 2>::new(1e-3)));
    single("Predictor f32", &Tape::record(&GearPredictor::<f32, f32, 5, 3>::new(1e-3)));
    let corrector =
        GearCorrector::<f64, f64, 6, 3>::new(1e-3, Acceleration::OfPositions, Inertia::Varying, fall);
    double("Corrector 6", &Tape::record(&corrector));
    let corrector = GearCorrector::<f64, f32, 4, 3>::new(1e-3, Acceleration::OfVelocities, inertia, fall);
    double("Corrector 4 of f32", &Tape::record(&corrector));
    let corrector = GearCorrector::<f32, f32, 5, 2>::new(1e-3, Acceleration::OfVelocities, inertia, [0.0; 2]);
    single("Corrector f32", &Tape::record(&corrector));

    let mask = Mask::square(2);
    let (shape, frame) = lattice(&mask);
    double("Clear", &Tape::record(&ClearIndex));
    double("Check", &Tape::record(&CheckIndex));
    double("Images", &Tape::record(&IndexImages));
    for coordinates in [Coordinates::Absolute, Coordinates::CellRelative] {
        double("Enter f64", &Tape::record(&EnterDiscs::<f64, f64>::new(shape, frame, coordinates)));
        double("Enter f32", &Tape::record(&EnterDiscs::<f32, f32>::new(shape, frame, coordinates)));
        double("Enter f64 to f32", &Tape::record(&EnterDiscs::<f64, f32>::new(shape, frame, coordinates)));
        let fields = <Granular<true, false> as Law<2>>::FIELDS;
        double("Spread", &Tape::record(&SpreadToLattice::<f64>::new(shape, coordinates, fields)));
        single("Spread f32", &Tape::record(&SpreadToLattice::<f32>::new(shape, coordinates, fields)));
        let full = Forces::<f64, _>::new(law::<true, false>(), &mask, shape, frame, coordinates);
        double("Forces", &Tape::record(&full));
        let full = Forces::<f32, _>::new(law::<true, true>(), &mask, shape, frame, coordinates);
        single("Forces f32", &Tape::record(&full));
        let full = Forces::<f64, _>::new(law::<false, false>(), &mask, shape, frame, coordinates);
        double("Forces without friction", &Tape::record(&full));
    }
    double("Folded", &Tape::record(&Folded::<f64>::default()));
    single("Folded f32", &Tape::record(&Folded::<f32>::default()));
}

/// Registers of every kernel.
#[test]
fn register_allocation_is_sound_and_minimal() {
    every_tape(registers_are_sound, registers_are_sound);
}

/// Tally of every kernel.
#[test]
fn tallies_are_sums_over_instructions() {
    every_tape(tally_is_the_sum_over_instructions, tally_is_the_sum_over_instructions);
}

/// Listing of every kernel.
#[test]
fn listings_have_a_line_for_each_instruction() {
    every_tape(listing_has_a_line_for_each_instruction, listing_has_a_line_for_each_instruction);
}

/// A change of precision is counted at every load, gather and store that makes one, and nowhere else.
#[test]
fn changes_of_precision_are_counted() {
    fn widened<T: Kernel>(text: &T) -> u64 {
        Tape::record(text).tally().iter().map(|(_, counts)| counts.of(Op::Widen)).sum()
    }
    assert_eq!(widened(&GearPredictor::<f64, f64, 5, 3>::new(1e-3)), 0);
    assert_eq!(widened(&GearPredictor::<f64, f32, 5, 3>::new(1e-3)), 3);
    let mixed =
        GearCorrector::<f64, f32, 5, 2>::new(1e-3, Acceleration::OfVelocities, Inertia::Varying, [0.0; 2]);
    assert_eq!(widened(&mixed), 2);
    let (shape, frame) = lattice(&Mask::square(2));
    // Periodic along x only: two loads, one store of the wrapped x, two stores for the lattice.
    assert_eq!(widened(&EnterDiscs::<f32, f32>::new(shape, frame, Coordinates::CellRelative)), 5);
    assert_eq!(widened(&EnterDiscs::<f64, f32>::new(shape, frame, Coordinates::CellRelative)), 2);
}

/// Stores numbers that are known when the kernel is recorded, and one that is not.
#[derive(Clone, Copy, Default)]
struct Folded<L>(std::marker::PhantomData<L>);

// SAFETY: the body names its slots unconditionally.
unsafe impl<L: Element> Kernel for Folded<L> {
    type Lane = L;

    fn body<M: Machine<Lane = L>>(&self, m: M) {
        let [a, b] = [0.1, 0.2].map(|value| m.uniform(value));
        let known = ((a + b) * a - b / a).abs().sqrt().min(m.uniform(7.7).truncate()).max(a);
        m.store(Slot::<L>::new(Array::Fx), known);
        m.store(Slot::<L>::new(Array::Fy), m.load(Slot::<L>::new(Array::X)) + known);
    }
}

/// Arithmetic between scalar operands costs no instruction, is evaluated in the lanes' precision, and equals the executed result.
fn folding_costs_nothing<L: Precision>(expected: L) {
    let program = Program::new(Folded::<L>::default());
    let instructions = program.tape().instructions();
    let ops: Vec<Op> = instructions.iter().map(|instruction| instruction.op()).collect();
    assert_eq!(ops, [Op::Store, Op::Load, Op::Add, Op::Store]);
    let TapeAction::Effect(Effect::Store(_, Operand::Uniform(known))) = instructions[0].action else {
        panic!("{:?} stores no scalar operand", instructions[0]);
    };
    assert_eq!(known.bits(), expected.bits());
    for execution in [Execution::Chained, Execution::Strip(5), Execution::Eager] {
        let set = InstructionSet::best();
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

/// Arithmetic on uniform values is folded, in both precisions.
#[test]
fn uniform_arithmetic_is_folded() {
    let (a, b) = (0.1f64, 0.2f64);
    folding_costs_nothing(((a + b) * a - b / a).abs().sqrt());
    let (a, b) = (0.1f32, 0.2f32);
    folding_costs_nothing(((a + b) * a - b / a).abs().sqrt());
}
