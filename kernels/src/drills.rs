//! Drills: small texts that do one operation again and again, and the arrays that they work on.
//!
//! Which operation is a number of the text, not a type: the interpreter never sees the branch, and a text a precision is
//! all that is compiled.

use crate::backend::Precision;
use crate::isa::{
    AlignedColumn, Array, Counter, Element, Machine, Memory, Op, Predicate, Slot, Text, Vector,
};
use crate::{Program, Runnable};
use std::marker::PhantomData;

/// Registers that a drill works on at once.
const WIDTH: usize = 8;
/// Predicates and index vectors at once.
const FEW: usize = 4;
/// Executions of the drilled operation in a long and in a short drill; their difference leaves beginning and end out.
pub const ROUNDS: [usize; 2] = [36, 8];
/// How far the operand of [`Kind::Shifted`] lies: no whole number of registers.
const SHIFT: usize = 5;

/// What is drilled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// An operation on numbers, predicates or index vectors in registers.
    Plain(Op),
    /// The same on entries of an index vector in memory.
    Index(Op),
    /// The same on numbers that change their precision.
    Convert(Op),
    /// A difference of a register and an array met at a shift.
    Shifted,
}

impl Kind {
    /// Every kind.
    pub const ALL: [Kind; 29] = [
        Kind::Plain(Op::Add),
        Kind::Plain(Op::Subtract),
        Kind::Plain(Op::Multiply),
        Kind::Plain(Op::Divide),
        Kind::Plain(Op::SquareRoot),
        Kind::Plain(Op::Absolute),
        Kind::Plain(Op::Minimum),
        Kind::Plain(Op::Maximum),
        Kind::Plain(Op::Truncate),
        Kind::Plain(Op::LessThan),
        Kind::Plain(Op::LessEqual),
        Kind::Plain(Op::Equal),
        Kind::Plain(Op::And),
        Kind::Plain(Op::Not),
        Kind::Plain(Op::Select),
        Kind::Plain(Op::Count),
        Kind::Plain(Op::Numbers),
        Kind::Plain(Op::ToIndex),
        Kind::Plain(Op::FromIndex),
        Kind::Plain(Op::Store),
        Kind::Plain(Op::Gather),
        Kind::Index(Op::Load),
        Kind::Index(Op::Store),
        Kind::Index(Op::Gather),
        Kind::Index(Op::Scatter),
        Kind::Convert(Op::Load),
        Kind::Convert(Op::Store),
        Kind::Convert(Op::Gather),
        Kind::Shifted,
    ];

    /// The name of the pass, as outlines give it.
    pub fn name(self) -> String {
        match self {
            Kind::Plain(op) => op.mnemonic().to_owned(),
            Kind::Index(op) => format!("{}.index", op.mnemonic()),
            Kind::Convert(op) => format!("{}.convert", op.mnemonic()),
            Kind::Shifted => "shifted".to_owned(),
        }
    }
}

/// Where stores go, and where the ends of a drill do.
const WRITTEN: [Array; WIDTH + 2] = [
    Array::Fx,
    Array::Fy,
    Array::Torque,
    Array::Deepest,
    Array::Power,
    Array::Radius,
    Array::InverseMass,
    Array::Vx,
    Array::Vy,
    Array::Omega,
];
/// What is read and written in the other precision.
const OTHERS: [Array; 2] = [Array::DiscX, Array::DiscY];
/// Where index vectors go.
const WRITTEN_INDEX: [Array; 2] = [Array::DiscCell, Array::HaloCell];

/// The registers of a drill.
struct Registers<M: Machine> {
    numbers: [M::V; WIDTH],
    predicates: [M::P; FEW],
    indices: [M::I; FEW],
    one: M::V,
}

impl<M: Machine> Registers<M> {
    #[inline(always)]
    fn new(m: M) -> Self {
        let x = m.load(Slot::<M::Lane>::new(Array::X));
        let numbers = [0, 1, 2, 3, 4, 5, 6, 7].map(|i| x + m.uniform(f64::from(i)));
        let index = || m.load_index(Slot::new(Array::Index));
        Registers {
            one: m.load(Slot::<M::Lane>::new(Array::Y)) + m.uniform(0.0),
            // None of them holds, as hardly any lane that is counted does.
            predicates: [0, 1, 2, 3].map(|i| numbers[i + 1].less_than(numbers[i])),
            indices: [index(), index(), index(), index()],
            numbers,
        }
    }

    /// One execution.
    #[inline(always)]
    fn round<O: Element>(&mut self, m: M, kind: Kind, round: usize) {
        let Registers { numbers: v, predicates: p, indices: index, one } = self;
        let (i, next, few, other) = (round % WIDTH, (round + 1) % WIDTH, round % FEW, (round + 1) % FEW);
        let own = Slot::<M::Lane>::new(Array::Y);
        let converted = Slot::<O>::new(Array::DiscX);
        match kind {
            Kind::Plain(op) => match op {
                Op::Add => v[i] = v[i] + v[next],
                Op::Subtract => v[i] = v[i] - v[next],
                Op::Multiply => v[i] = v[i] * *one,
                Op::Divide => v[i] = v[i] / *one,
                Op::SquareRoot => v[i] = v[i].sqrt(),
                Op::Absolute => v[i] = v[next].abs(),
                Op::Minimum => v[i] = v[i].min(v[next]),
                Op::Maximum => v[i] = v[i].max(v[next]),
                Op::Truncate => v[i] = v[next].truncate(),
                Op::LessThan => p[few] = v[next].less_than(v[i]),
                Op::LessEqual => p[few] = v[next].less_equal(v[i]),
                Op::Equal => p[few] = v[next].equal(v[i]),
                Op::And => p[few] = p[few].and(p[other]),
                Op::Not => p[few] = p[other].not(),
                Op::Select => v[i] = M::V::select(p[few], v[next], v[i]),
                Op::Count => m.count(Counter(0), p[few]),
                Op::Numbers => v[i] = m.numbers(),
                Op::ToIndex => index[few] = m.to_index(v[i]),
                Op::FromIndex => v[i] = m.index_numbers(index[few]),
                Op::Store => m.store(Slot::<M::Lane>::new(WRITTEN[i]), v[i]),
                Op::Gather => v[i] = m.gather(own, index[few], v[next]),
                // Drilled by the other kinds.
                Op::Load | Op::Scatter | Op::LoadShifted | Op::Widen => {}
            },
            Kind::Index(Op::Load) => index[few] = m.load_index(Slot::new(Array::Index)),
            Kind::Index(Op::Store) => m.store_index(Slot::new(Array::DiscCell), index[few]),
            Kind::Index(Op::Scatter) => m.scatter_index(Slot::new(Array::HaloCell), index[few], index[other]),
            Kind::Index(Op::Gather) => index[few] = m.gather_index(Slot::new(Array::HaloSource), index[few]),
            Kind::Convert(Op::Load) => v[i] = m.load(converted),
            Kind::Convert(Op::Store) => m.store(Slot::<O>::new(Array::DiscY), v[i]),
            Kind::Convert(Op::Gather) => v[i] = m.gather(converted, index[few], v[next]),
            // No such drill, so no round of it: the test of the rounds sees one that is asked for.
            Kind::Index(_) | Kind::Convert(_) => {}
            Kind::Shifted => v[i] = v[i] - m.load_shifted(Slot::<M::Lane>::new(Array::X), SHIFT as isize),
        }
    }

    /// Reads every register once more, so that none is given up before.
    #[inline(always)]
    fn end(self, m: M) {
        m.store(Slot::<M::Lane>::new(Array::Vy), m.uniform(1.0));
        let Registers { numbers, predicates, indices, one } = self;
        let mut sum = one;
        for number in numbers {
            sum = sum + number;
        }
        for (predicate, index) in predicates.into_iter().zip(indices) {
            m.count(Counter(0), predicate);
            m.store_index(Slot::new(Array::DiscCell), index);
        }
        m.store(Slot::<M::Lane>::new(Array::Omega), sum);
    }
}

/// `rounds` executions of one kind between the same beginning and end.
#[derive(Clone, Copy)]
struct Drill<L, O> {
    kind: Kind,
    rounds: usize,
    precisions: PhantomData<(L, O)>,
}

// SAFETY: the slots depend on the kind and the rounds only.
unsafe impl<L: Element, O: Element> Text for Drill<L, O> {
    type Lane = L;

    #[inline(always)]
    fn body<M: Machine<Lane = L>>(&self, m: M) {
        let mut registers = Registers::new(m);
        for round in 0..self.rounds {
            registers.round::<O>(m, self.kind, round);
        }
        registers.end(m);
    }
}

/// Lanes that are drilled, with the other precision that they are converted from and to. Drills are compiled here, once.
pub trait Drilled: Precision {
    /// The other precision.
    type Other: Precision;

    /// A long and a short drill of a kind.
    fn drill(kind: Kind) -> [Box<dyn Runnable>; 2];
}

macro_rules! drilled {
    ($($lane:ty, $other:ty;)*) => {$(
        impl Drilled for $lane {
            type Other = $other;

            fn drill(kind: Kind) -> [Box<dyn Runnable>; 2] {
                ROUNDS.map(|rounds| -> Box<dyn Runnable> {
                    Box::new(Program::new(Drill::<$lane, $other> { kind, rounds, precisions: PhantomData }))
                })
            }
        }
    )*};
}

drilled! {
    f64, f32;
    f32, f64;
}

/// Most elements of a vector in a calibration.
pub const LONGEST: usize = 4_000_000;

/// The arrays of the drills.
pub struct Arrays<L, O> {
    read: [AlignedColumn<L>; 2],
    written: Vec<AlignedColumn<L>>,
    others: [AlignedColumn<O>; 2],
    index: AlignedColumn<u32>,
    through: AlignedColumn<u32>,
    written_index: [AlignedColumn<u32>; 2],
}

impl<L: Element, O: Element> Arrays<L, O> {
    /// For vectors of up to `n` elements.
    pub fn new(n: usize) -> Self {
        let n = n + SHIFT;
        // Near 1, so that no chain of products, quotients or roots leaves the normal numbers.
        let near_one = |array, step: f64| {
            AlignedColumn::new(array as usize, (0..n).map(|i| L::from_f64(1.0 + step * (i % 97) as f64)))
        };
        // As discs lie in cells at a usual occupancy: every fourth element, in order.
        let index = |array| AlignedColumn::new(array as usize, (0..n).map(|i| ((4 * i) % n) as u32 + 1));
        let ones = |array: Array| AlignedColumn::filled(array as usize, L::from_f64(1.0), n);
        Arrays {
            read: [near_one(Array::X, 1e-7), near_one(Array::Y, 2e-7)],
            written: WRITTEN.map(ones).into_iter().collect(),
            others: OTHERS.map(|array| AlignedColumn::filled(array as usize, O::from_f64(1.0), n)),
            index: index(Array::Index),
            through: index(Array::HaloSource),
            written_index: WRITTEN_INDEX.map(|array| AlignedColumn::filled(array as usize, 1, n)),
        }
    }

    /// The arrays bound to their slots.
    pub fn memory(&mut self) -> Memory<'_> {
        let mut memory = Memory::new();
        for (array, column) in [Array::X, Array::Y].into_iter().zip(&self.read) {
            memory.bind_read(Slot::new(array), column);
        }
        let [from, to] = &mut self.others;
        memory.bind_read(Slot::new(OTHERS[0]), from);
        memory.bind_write(Slot::new(OTHERS[1]), to);
        memory.bind_read(Slot::new(Array::Index), &self.index);
        memory.bind_read(Slot::new(Array::HaloSource), &self.through);
        for (array, column) in WRITTEN_INDEX.into_iter().zip(&mut self.written_index) {
            memory.bind_write(Slot::new(array), column);
        }
        for (array, column) in WRITTEN.into_iter().zip(&mut self.written) {
            memory.bind_write(Slot::new(array), column);
        }
        memory
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_round_of_a_drill_is_a_pass_of_its_kind() {
        for kind in Kind::ALL {
            let name = if kind == Kind::Shifted { Op::Subtract.mnemonic().to_owned() } else { kind.name() };
            let [long, short] = f64::drill(kind)
                .map(|program| program.outlines().passes.iter().filter(|pass| pass.kind() == name).count());
            assert_eq!(long - short, ROUNDS[0] - ROUNDS[1], "{kind:?}");
        }
    }

    #[test]
    fn every_operation_has_a_drill_of_its_own() {
        for &op in Op::ALL {
            let drills = |kind: &Kind| match (op, kind) {
                (Op::LoadShifted, kind) => *kind == Kind::Shifted,
                (Op::Widen, kind) => matches!(kind, Kind::Convert(_)),
                (op, Kind::Plain(drilled) | Kind::Index(drilled)) => op == *drilled,
                (_, Kind::Convert(_) | Kind::Shifted) => false,
            };
            assert!(Kind::ALL.iter().any(drills), "{op:?}");
        }
    }
}
