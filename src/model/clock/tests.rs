//! Golden values of the sources, and properties of every clock.

use super::*;
use crate::model::machine::{MachineFeature, MachineModel, NumberProvenance};
use crate::model::machines::{names, preset};
use stripmine_kernels::backend::tape::{ArrayReference, Outline, RegisterKind, RegisterName, VectorLocation};
use stripmine_kernels::isa::Array;
use stripmine_kernels::isa::OpCounts;
use stripmine_kernels::isa::op::Op;

fn counts_of(op: Op, times: u64) -> ProgramWork {
    let mut counts = OpCounts::default();
    (0..times).for_each(|_| counts.record(op));
    counts.into()
}

/// One time step as in the table of BP93 section 3: 59 + 12 + 54 operations on particles, 1656 on cells.
fn paper_step(particles: u64, cells: u64) -> f64 {
    let machine = preset("paper").unwrap();
    [(59, particles), (12, particles), (1656, cells), (54, particles)]
        .into_iter()
        .map(|(operations, n)| Clock::Paper.clocks(&machine, &counts_of(Op::Multiply, operations), n))
        .sum()
}

#[test]
fn a_time_step_costs_what_the_paper_prints() {
    for (particles, cells) in [(1, 1), (100, 1_000), (5_000, 20_000)] {
        let printed = 125 * (particles + 20) + 1656 * (cells + 20);
        assert_eq!(paper_step(particles, cells), printed as f64);
    }
}

#[test]
fn large_system_cost_matches_bp93() {
    let particles = 1_000_000_000;
    for (cells_per_particle, per_particle) in [(10, 16_685.0), (4, 6_749.0)] {
        let clocks = paper_step(particles, particles * cells_per_particle) / particles as f64;
        assert!((clocks - per_particle).abs() < 1e-3, "{clocks} instead of {per_particle}");
    }
}

#[test]
fn the_paper_machine_charges_every_operation_alike() {
    let machine = preset("paper").unwrap();
    for &op in Op::ALL {
        assert_eq!(Clock::Paper.clocks(&machine, &counts_of(op, 3), 100), 3.0 * 120.0, "{op:?}");
    }
}

#[test]
fn vector_speedup_tends_to_the_pipeline_depth() {
    let machine = preset("paper").unwrap();
    let counts = counts_of(Op::Add, 7);
    let speed_up = |n| Clock::Scalar.clocks(&machine, &counts, n) / Clock::Paper.clocks(&machine, &counts, n);
    for n in [1_u64, 20, 64, 1_000] {
        let expected = 20.0 * n as f64 / (n as f64 + 20.0);
        assert!((speed_up(n) - expected).abs() < 1e-12, "n = {n}");
    }
    assert!((speed_up(1_000_000_000) - 20.0).abs() < 1e-6);
}

#[test]
fn a_missing_operation_is_charged_by_its_expansion() {
    let machine = preset("cray-1").unwrap();
    let divide = counts_of(Op::Divide, 1);
    // One reciprocal approximation of depth 14 and three products of depth 7.
    assert_eq!(Clock::Paper.clocks(&machine, &divide, 64), (64.0 + 14.0) + 3.0 * (64.0 + 7.0));
    assert_eq!(Clock::Scalar.clocks(&machine, &divide, 64), 64.0 * (14.0 + 3.0 * 7.0));
}

#[test]
fn empty_vectors_and_empty_counts_cost_nothing() {
    let machine = preset("cray-1").unwrap();
    for &clock in Clock::ALL {
        assert_eq!(clock.clocks(&machine, &counts_of(Op::SquareRoot, 5), 0), 0.0);
        assert_eq!(clock.clocks(&machine, &ProgramWork::default(), 1_000), 0.0);
    }
}

/// The machine of Hennessy and Patterson's examples; start-ups 12, 7 and 6, one memory port.
fn textbook(chaining: bool) -> MachineModel {
    let quantity = |value: f64| format!("{{ value = {value}, provenance = \"sourced\", note = \"H&P\" }}");
    let unit = |name: &str, serves: &str| {
        format!("[units.{name}]\nserves = [{serves}]\ncount = {}\n", quantity(1.0))
    };
    let text = [
        "format = 1\ntitle = \"VMIPS\"\n".to_owned(),
        format!("year = {}\nclock_period_ns = {}\n", quantity(1990.0), quantity(1.0)),
        format!("chaining = {}\n", quantity(1.0).replace("1,", &format!("{chaining},"))),
        format!("loop_overhead = {}\n", quantity(15.0)),
        format!("[vector_registers]\ncount = {}\nlength = {}\n", quantity(8.0), quantity(64.0)),
        format!(
            "[start_up]\ndefault = {}\nmultiply = {}\nadd = {}\n",
            quantity(12.0),
            quantity(7.0),
            quantity(6.0)
        ),
        unit("add", r#""add", "compare", "convert""#),
        unit("multiply", r#""multiply""#),
        unit("divide", r#""divide", "square_root""#),
        unit("logical", r#""logical", "reduce""#),
        format!("[memory]\nload_ports = {}\n", quantity(1.0)),
    ];
    MachineModel::parse("textbook.toml", &text.concat()).unwrap()
}

fn register(number: u32) -> VectorLocation {
    VectorLocation::Register(RegisterName { file: RegisterKind::Number, number })
}

fn array(array: Array) -> VectorLocation {
    VectorLocation::Memory(ArrayReference { array, element: "f64", shift: 0 })
}

fn instruction(op: Op, reads: &[VectorLocation], to: VectorLocation) -> Outline {
    Outline { op, converts: false, reads: reads.to_vec(), writes: Some(to) }
}

/// Y = a X + Y.
fn daxpy() -> ProgramWork {
    ProgramWork::in_order(vec![
        instruction(Op::Load, &[array(Array::X)], register(0)),
        instruction(Op::Multiply, &[register(0)], register(1)),
        instruction(Op::Load, &[array(Array::Y)], register(2)),
        instruction(Op::Add, &[register(1), register(2)], register(3)),
        instruction(Op::Store, &[register(3)], array(Array::Y)),
    ])
}

#[test]
fn strip_mining_formula_matches_the_textbook() {
    let charge = |start: f64| Charge { strip: Some(64.0), each_strip: 15.0 + start, each_element: 3.0 };
    assert_eq!(charge(49.0).clocks(200), 856.0);
    assert_eq!(charge(49.0).clocks(1000), 4024.0);
    assert_eq!(charge(31.0).clocks(200), 784.0);
}

#[test]
fn daxpy_convoys_match_the_textbook() {
    let machine = textbook(true);
    let convoys = convoys(&machine, daxpy().order().unwrap(), MemoryModel::Ports);
    // Load and multiply, load and add, store: starts 12 + 7, 12 + 6 and 12, together 49; three chimes.
    assert_eq!(convoys.iter().map(|convoy| convoy.instructions).collect::<Vec<_>>(), [2, 2, 1]);
    assert_eq!(convoys.iter().map(|convoy| convoy.start_up).collect::<Vec<_>>(), [19.0, 18.0, 12.0]);
    assert_eq!(Clock::Ports.clocks(&machine, &daxpy(), 200), 856.0);
    assert_eq!(Clock::Ports.clocks(&machine, &daxpy(), 1000), 4024.0);
    // With memory never busy there is a single convoy, as long as its chain: 12 + 7 + 6 + 12.
    assert_eq!(Clock::Chained.clocks(&machine, &daxpy(), 200), 4.0 * (15.0 + 37.0) + 200.0);
}

#[test]
fn chaining_reduces_141_clocks_to_77() {
    let pair = ProgramWork::in_order(vec![
        instruction(Op::Multiply, &[register(0), register(1)], register(2)),
        instruction(Op::Add, &[register(2), register(3)], register(4)),
    ]);
    let without_loop = |chaining| Clock::Chained.clocks(&textbook(chaining), &pair, 64) - 15.0;
    assert_eq!(without_loop(false), 141.0);
    assert_eq!(without_loop(true), 77.0);
}

#[test]
fn stored_data_are_loaded_by_later_convoys() {
    let machine = textbook(true);
    let program = ProgramWork::in_order(vec![
        instruction(Op::Store, &[register(0)], array(Array::X)),
        instruction(Op::Load, &[array(Array::X)], register(1)),
        instruction(Op::Load, &[array(Array::Y)], register(2)),
    ]);
    let convoys = convoys(&machine, program.order().unwrap(), MemoryModel::NeverBusy);
    assert_eq!(convoys.iter().map(|convoy| convoy.instructions).collect::<Vec<_>>(), [1, 2]);
}

#[test]
fn register_strips_add_the_loop_overhead() {
    let machine = textbook(true);
    let work = daxpy();
    for n in [1, 63, 64] {
        let paper = Clock::Paper.clocks(&machine, &work, n);
        assert_eq!(Clock::Registers.clocks(&machine, &work, n), paper + 15.0, "n = {n}");
    }
    let two = Clock::Paper.clocks(&machine, &work, 64) + Clock::Paper.clocks(&machine, &work, 1) + 30.0;
    assert_eq!(Clock::Registers.clocks(&machine, &work, 65), two);
}

#[test]
fn chaining_never_costs_and_ports_never_save() {
    for name in names() {
        // A fused product needs fewer instructions, by which registers may win over the paper's clock.
        let machine = preset(name).unwrap().with_feature(MachineFeature::Fma, false);
        for n in [1, 8, 64, 65, 1000, 100_000] {
            let clocks = |clock: Clock| clock.clocks(&machine, &daxpy(), n);
            assert!(clocks(Clock::Chained) <= clocks(Clock::Registers) + 1e-9, "{name}, n = {n}");
            assert!(clocks(Clock::Paper) <= clocks(Clock::Registers) + 1e-9, "{name}, n = {n}");
        }
    }
}

#[test]
fn vector_clocks_agree_on_the_paper_machine() {
    let machine = preset("paper").unwrap();
    for clock in [Clock::Registers, Clock::Chained, Clock::Ports] {
        for n in [1, 64, 1000] {
            assert_eq!(clock.clocks(&machine, &daxpy(), n), Clock::Paper.clocks(&machine, &daxpy(), n));
        }
    }
}

#[test]
fn whole_registers_give_a_staircase() {
    let machine = preset("spacemit-a100").unwrap();
    let clocks =
        |registers: usize, n| Clock::WholeRegisters.clocks(&machine.with_group(registers), &daxpy(), n);
    // Two loads, a product, a sum and a store on a register of 16 doubles.
    let one = 2.0 * 2.36 + 5.0 + 4.0 + 2.48;
    for (n, strips) in [(1, 1.0), (16, 1.0), (17, 2.0), (64, 4.0)] {
        assert!((clocks(1, n) - strips * one).abs() < 1e-9, "n = {n}");
    }
    let four = 2.0 * 8.43 + 20.43 + 16.0 + 8.31;
    assert!((clocks(4, 1) - four).abs() < 1e-9);
    assert!((clocks(4, 65) - 2.0 * four).abs() < 1e-9);
    // A gather has no measured time: a clock period an element.
    let gather = counts_of(Op::Gather, 3);
    assert_eq!(Clock::WholeRegisters.clocks(&machine, &gather, 100), 300.0);
}

#[test]
fn measured_machines_are_mostly_sourced() {
    let names = ["spacemit-a100", "spacemit-x60", "spacemit-x100", "xuantie-c908", "sifive-x280"];
    let (mut all, mut sourced) = (0, 0);
    for (entry, provenance) in names.iter().flat_map(|name| preset(name).unwrap().provenances()) {
        let numbers = if entry.starts_with("whole_registers.periods") { 4 } else { 1 };
        all += numbers;
        sourced += if provenance == NumberProvenance::Sourced { numbers } else { 0 };
    }
    assert!(10 * sourced >= 9 * all, "{sourced} of {all}");
}

/// By hand: DAXPY's product feeds its sum, so that five operations become four; a product that is read twice, or by another product, stays.
#[test]
fn fused_products_leave_the_program() {
    let fused = daxpy().fused();
    assert_eq!(fused.order().unwrap().len(), 4);
    let machine = preset("sx-aurora").unwrap();
    let [without, with] = [false, true].map(|has| machine.with_feature(MachineFeature::Fma, has));
    let clocks = |machine: &MachineModel| Clock::Registers.clocks(machine, &daxpy(), 256);
    // Start-ups of 10, a loop of 15, and 256 elements for each instruction.
    assert_eq!(clocks(&without), 15.0 + 5.0 * (10.0 + 256.0));
    assert_eq!(clocks(&with), 15.0 + 4.0 * (10.0 + 256.0));
    assert_eq!(Clock::Paper.clocks(&without, &daxpy(), 256), Clock::Paper.clocks(&with, &daxpy(), 256));
    let product = instruction(Op::Multiply, &[register(0), register(1)], register(2));
    for readers in [
        vec![
            instruction(Op::Add, &[register(2), register(0)], register(3)),
            instruction(Op::Add, &[register(2), register(1)], register(4)),
        ],
        vec![instruction(Op::Multiply, &[register(2), register(0)], register(3))],
        vec![instruction(Op::Add, &[register(2), register(2)], register(3))],
        // The register of a factor has another value when the sum is taken.
        vec![
            instruction(Op::Load, &[array(Array::X)], register(0)),
            instruction(Op::Add, &[register(2), register(1)], register(3)),
        ],
    ] {
        let order: Vec<Outline> = [product.clone()].into_iter().chain(readers).collect();
        let work = ProgramWork::in_order(order.clone());
        assert_eq!(work.fused().order().unwrap(), order);
    }
    // A sum of two products takes one of them.
    let other = instruction(Op::Multiply, &[register(3), register(4)], register(5));
    let sum = instruction(Op::Add, &[register(2), register(5)], register(6));
    assert_eq!(ProgramWork::in_order(vec![product, other, sum]).fused().order().unwrap().len(), 2);
}
