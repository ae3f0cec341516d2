use super::*;
use crate::isa::op::{BinaryOp, CompareOp, UnaryOp};
use crate::isa::{OpClass, Vector};

const EXECUTIONS: [Execution; 4] =
    [Execution::Eager, Execution::Strip(1), Execution::Strip(64), Execution::Chained];

/// out = the root of |left + right − 2 own|, of elements at a distance.
struct Curvature(isize);

impl OwnKernel for Curvature {
    type Lane = f64;
    type Slots<'k> = ([ShiftedSlot<'k>; 2], ReadSlot<'k>, WriteSlot<'k>);

    fn declare<'k>(&self, arrays: &mut Declarations<'k>) -> Self::Slots<'k> {
        (arrays.read_shifted("u", [-self.0, self.0]), arrays.read("u"), arrays.write("out"))
    }

    #[inline(always)]
    fn body<'k, M: Machine<Lane = f64>>(
        &self,
        m: OwnMachine<'k, M>,
        &([left, right], u, out): &Self::Slots<'k>,
    ) {
        m.section("curvature");
        let around = m.load_shifted(left) + m.load_shifted(right);
        m.store(out, (around - m.uniform(2.0) * m.load(u)).abs().sqrt());
    }
}

fn curvature(distance: isize) -> OwnProgram<Curvature> {
    OwnProgram::new(Curvature(distance)).unwrap()
}

fn waves(length: usize) -> Vec<f64> {
    (0..length).map(|at| (0.3 * at as f64).sin()).collect()
}

#[test]
fn all_executions_equal_a_loop() {
    let program = curvature(3);
    for length in [0, 5, 6, 7, 64, 65, 1000, 70_000] {
        let u = waves(length);
        let range = program.interior(length);
        let mut expected = vec![-1.0; length];
        for at in range.clone() {
            expected[at] = (u[at - 3] + u[at + 3] - 2.0 * u[at]).abs().sqrt();
        }
        for execution in EXECUTIONS {
            let mut out = vec![-1.0; length];
            let memory = program.memory().read("u", &u).unwrap().write("out", &mut out).unwrap();
            program.run(&memory, range.clone(), execution, InstructionSet::best()).unwrap();
            drop(memory);
            assert_eq!(out, expected, "{length}, {execution:?}");
        }
    }
}

#[test]
fn listings_have_names_of_the_user() {
    let program = curvature(1);
    let listing = program.tape().listing().to_string();
    for words in ["; curvature", "[u-1]", "[u+1]", "[u]", "[out]"] {
        assert!(listing.contains(words), "{words}: {listing}");
    }
    let [(section, counts)] = &program.runnable().tally()[..] else { panic!() };
    assert_eq!((*section, counts.total()), ("curvature", 9));
    assert_eq!((counts.of_class(OpClass::Shift), counts.of_class(OpClass::Add)), (2, 2));
}

#[test]
fn wrong_arrays_are_refused_by_name() {
    let program = curvature(1);
    let (u, short) = (waves(10), waves(9));
    let (mut out, mut other) = (vec![0.0; 10], vec![0.0; 10]);
    let refused = |memory: OwnMemory<'_, f64>, range| {
        program.run(&memory, range, Execution::Chained, InstructionSet::best()).unwrap_err().to_string()
    };
    let memory = program.memory().read("u", &u).unwrap();
    assert_eq!(refused(memory, 1..9), "array `out` is not bound; bind every array before the run");
    let memory = program.memory().read("u", &short).unwrap().write("out", &mut out).unwrap();
    assert_eq!(refused(memory, 1..8), "array `out` has 10 elements, but `u` has 9; give all the same length");
    let memory = program.memory().read("u", &u).unwrap().write("out", &mut out).unwrap();
    let beyond = "array `u` has elements 0 to 9, but the range and its shifts need 0 to 10";
    assert_eq!(refused(memory, 1..10), beyond);
    let unknown = program.memory().read("v", &u).err().unwrap();
    assert_eq!(unknown.to_string(), "the kernel has no array `v`; its arrays are u, out");
    let read_only = program.memory().read("out", &other).err().unwrap();
    assert_eq!(read_only.to_string(), "array `out` is written by the kernel; bind it for writing");
    let memory = program.memory().write("u", &mut other).unwrap();
    drop(memory);
}

/// Writes arrays of some names, after it has declared one at a shift.
struct Names(Vec<String>, &'static str);

impl OwnKernel for Names {
    type Lane = f64;
    type Slots<'k> = Vec<WriteSlot<'k>>;

    fn declare<'k>(&self, arrays: &mut Declarations<'k>) -> Self::Slots<'k> {
        arrays.read_shifted(self.1, [2]);
        self.0.iter().map(|name| arrays.write(name)).collect()
    }

    #[inline(always)]
    fn body<'k, M: Machine<Lane = f64>>(&self, m: OwnMachine<'k, M>, all: &Self::Slots<'k>) {
        all.iter().for_each(|&slot| m.store(slot, m.uniform(1.0)));
    }
}

#[test]
fn impossible_declarations_are_refused_by_name() {
    let numbered = |count: usize| (0..count).map(|at| format!("a{at}")).collect::<Vec<_>>();
    assert!(OwnProgram::new(Names(numbered(15), "u")).is_ok());
    let refused = |names, shifted| OwnProgram::new(Names(names, shifted)).unwrap_err();
    assert_eq!(refused(numbered(16), "u"), OwnKernelError::TooManyArrays(17, 16));
    assert_eq!(refused(vec!["a".to_owned(); 2], "u"), OwnKernelError::DeclaredTwice("a".to_owned()));
    assert_eq!(refused(numbered(2), "a1"), OwnKernelError::WrittenAndShifted("a1".to_owned()));
}

/// out = x at the right where x < 0, else the root of x.
fn traced() -> TracedKernel {
    let nodes = vec![
        TracedNode::Input(0, 0),
        TracedNode::Constant(0.0),
        TracedNode::Compare(CompareOp::LessThan, 0, 1),
        TracedNode::Input(0, 1),
        TracedNode::Unary(UnaryOp::SquareRoot, 0),
        TracedNode::Select(2, 3, 4),
    ];
    TracedKernel::new(vec!["x".to_owned()], nodes, vec![("out".to_owned(), 5)]).unwrap()
}

#[test]
fn traced_kernels_equal_a_loop() {
    let program = OwnProgram::new(traced()).unwrap();
    let x = waves(77);
    let expected: Vec<f64> = (0..76).map(|at| if x[at] < 0.0 { x[at + 1] } else { x[at].sqrt() }).collect();
    for execution in EXECUTIONS {
        let mut out = vec![0.0; 77];
        let memory = program.memory().read("x", &x).unwrap().write("out", &mut out).unwrap();
        program.run(&memory, program.interior(77), execution, InstructionSet::best()).unwrap();
        drop(memory);
        assert_eq!(out[..76], expected, "{execution:?}");
    }
}

#[test]
fn impossible_traces_are_refused() {
    let x = || vec!["x".to_owned()];
    let out = |at| vec![("out".to_owned(), at)];
    let input = TracedNode::Input(0, 0);
    let less = TracedNode::Compare(CompareOp::LessThan, 0, 0);
    for (nodes, outputs, expected) in [
        (vec![TracedNode::Input(1, 0)], out(0), TraceError::Missing(0)),
        (vec![input, TracedNode::Binary(BinaryOp::Add, 0, 1)], out(1), TraceError::Missing(1)),
        (vec![input], out(1), TraceError::Missing(1)),
        (vec![input, less, TracedNode::Unary(UnaryOp::Absolute, 1)], out(2), TraceError::Kind(2)),
        (vec![input, TracedNode::Select(0, 0, 0)], out(1), TraceError::Kind(1)),
        (vec![input, less], out(1), TraceError::Kind(1)),
        (vec![input], vec![], TraceError::NoOutput),
        (vec![input], vec![("x".to_owned(), 0)], TraceError::Name("x".to_owned())),
    ] {
        assert_eq!(TracedKernel::new(x(), nodes, outputs).unwrap_err(), expected);
    }
}

#[test]
fn code_has_an_instruction_for_each_operation() {
    use crate::emit::{GroupSize, Purpose};
    let program = OwnProgram::new(traced()).unwrap();
    let kernel = program.runnable().emitted(GroupSize::Four).unwrap();
    assert_eq!(kernel.count(Purpose::Operation), program.tape().instructions().len());
}
