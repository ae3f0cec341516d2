//! Drills: small texts that do one operation again and again, and the arrays that they work on.

use std::marker::PhantomData;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::isa::{Array, Counter, Element, Machine, Memory, Op, Slot, Text, Vector};
use stripmine_kernels::{Program, Runnable};

/// Vectors that a drill works on at once: enough to keep a pipelined unit busy.
const WIDTH: usize = 8;
/// Executions of the drilled operation.
pub(super) const ROUNDS: usize = 48;

/// The operations that are drilled, by number: a text's code must not branch over them.
pub(super) const DRILLED: [Op; 14] = [
    Op::Add,
    Op::Multiply,
    Op::Divide,
    Op::SquareRoot,
    Op::Minimum,
    Op::Absolute,
    Op::Truncate,
    Op::Select,
    Op::Count,
    Op::LessThan,
    Op::FromIndex,
    Op::Gather,
    Op::Scatter,
    Op::Store,
];

/// Where stores go.
const STORED: [Array; WIDTH] = [
    Array::Fx,
    Array::Fy,
    Array::Torque,
    Array::Excess,
    Array::PartnerFx,
    Array::PartnerFy,
    Array::PartnerTorque,
    Array::Vx,
];

/// One execution of an operation on the vectors.
#[inline(always)]
fn round<M: Machine, const OPERATION: usize>(
    m: M,
    v: &mut [M::V; WIDTH],
    i: usize,
    next: usize,
    y: M::V,
    index: M::I,
    holds: M::P,
) {
    match DRILLED[OPERATION] {
        Op::Add => v[i] = v[i] + v[next],
        Op::Multiply => v[i] = v[i] * y,
        Op::Divide => v[i] = v[i] / y,
        Op::SquareRoot => v[i] = v[i].sqrt(),
        Op::Minimum => v[i] = v[i].min(v[next]),
        Op::Absolute => v[i] = v[next].abs(),
        Op::Truncate => v[i] = v[next].truncate(),
        Op::Select => v[i] = M::V::select(holds, v[next], v[i]),
        Op::Count => m.count(Counter(0), holds),
        Op::LessThan => m.count(Counter(0), v[i].less_than(v[next])),
        Op::FromIndex => v[i] = m.index_numbers(m.to_index(v[next])),
        Op::Gather => v[i] = m.gather(Slot::<M::Lane>::new(Array::Y), index, v[i]),
        Op::Scatter => m.scatter_index(Slot::new(Array::HaloCell), index, index),
        _ => m.store(Slot::<M::Lane>::new(STORED[i]), v[i]),
    }
}

/// `ROUNDS` executions of one operation between the same beginning and end, or, without rounds, these alone.
#[derive(Clone, Copy)]
struct Drill<L, const OPERATION: usize, const ROUNDS: usize>(PhantomData<L>);

// SAFETY: the slots depend on the constants only.
unsafe impl<L: Element, const OPERATION: usize, const ROUNDS: usize> Text for Drill<L, OPERATION, ROUNDS> {
    type Lane = L;

    #[inline(always)]
    fn body<M: Machine<Lane = L>>(&self, m: M) {
        let x = m.load(Slot::<L>::new(Array::X));
        let y = m.load(Slot::<L>::new(Array::Y));
        let index = m.load_index(Slot::new(Array::Index));
        let holds = x.less_than(y);
        let mut v = [0, 1, 2, 3, 4, 5, 6, 7].map(|i| x + m.uniform(f64::from(i)));
        // Written out, for a loop that is not unrolled would keep its vectors in memory.
        macro_rules! rounds {
            ($($round:literal)*) => {
                $(if $round < ROUNDS {
                    round::<M, OPERATION>(m, &mut v, $round % WIDTH, ($round + 1) % WIDTH, y, index, holds);
                })*
            };
        }
        rounds!(0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23);
        rounds!(24 25 26 27 28 29 30 31 32 33 34 35 36 37 38 39 40 41 42 43 44 45 46 47);
        let sum = v.into_iter().reduce(|a, b| a + b);
        m.store(Slot::<L>::new(Array::Vy), sum.unwrap_or(x));
    }
}

/// A drill and the same without its rounds.
pub(super) struct Pair {
    /// What is drilled.
    pub(super) op: Op,
    /// With the rounds.
    pub(super) drill: Box<dyn Runnable>,
    /// Without.
    pub(super) rest: Box<dyn Runnable>,
}

/// Every drill on lanes of `L`.
pub(super) fn drills<L: Precision>() -> Vec<Pair> {
    macro_rules! pairs {
        ($($number:literal),*) => {
            vec![$(Pair {
                op: DRILLED[$number],
                drill: Box::new(Program::new(Drill::<L, $number, ROUNDS>(PhantomData))),
                rest: Box::new(Program::new(Drill::<L, 0, 0>(PhantomData))),
            }),*]
        };
    }
    pairs![0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13]
}

/// Most elements of a vector in a calibration.
pub(super) const LONGEST: usize = 4_000_000;

/// The arrays of the drills.
pub(super) struct Arrays<L> {
    read: [Vec<L>; 2],
    written: Vec<Vec<L>>,
    index: Vec<u32>,
    scattered: Vec<u32>,
}

impl<L: Element> Arrays<L> {
    /// For vectors of up to `n` elements.
    pub(super) fn new(n: usize) -> Self {
        // Near 1, so that no chain of products, quotients or roots leaves the normal numbers.
        let near_one = |step: f64| (0..n).map(|i| L::from_f64(1.0 + step * (i % 97) as f64)).collect();
        // As discs lie in cells at a usual occupancy: every fourth element, in order.
        let index: Vec<u32> = (0..n).map(|i| ((4 * i) % n) as u32 + 1).collect();
        Arrays {
            read: [near_one(1e-7), near_one(2e-7)],
            written: vec![vec![L::default(); n]; STORED.len() + 1],
            scattered: vec![0; n],
            index,
        }
    }

    /// How many arrays there are.
    pub(super) fn count(&self) -> usize {
        self.read.len() + self.written.len() + 2
    }

    /// The arrays bound to their slots.
    pub(super) fn memory(&mut self) -> Memory<'_> {
        let mut memory = Memory::new()
            .read(Slot::new(Array::X), &self.read[0])
            .read(Slot::new(Array::Y), &self.read[1])
            .read(Slot::new(Array::Index), &self.index)
            .write(Slot::new(Array::HaloCell), &mut self.scattered);
        for (&array, column) in STORED.iter().chain(&[Array::Vy]).zip(&mut self.written) {
            memory = memory.write(Slot::new(array), column);
        }
        memory
    }
}
