//! The source's vector machine: whole-array operations between all bodies and those that are a shift behind them, for every shift.

use super::bodies::{Bodies, Columns};
use super::field::{Sums, potential};
use crate::method::VectorProgram;
use stripmine_kernels::backend;
use stripmine_kernels::isa::{Memory, ProgramError, Slot};
use stripmine_kernels::law::gravity::Gravity;
use stripmine_kernels::law::{Axis, Field, Law, Sum};
use stripmine_kernels::sweep::all_pairs::shifts::{BODY_POSITION, Shifts, body_array, body_sum_array};
use stripmine_kernels::{Execution, InstructionSet, Program};

/// Shifts of a program: sums and own bodies are loaded once for them.
const BLOCK: usize = 16;
const AXES: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];

/// Programs over all shifts, in a precision.
pub(super) struct Shifted<P: backend::Precision> {
    softening: f64,
    count: usize,
    execution: Execution,
    set: InstructionSet,
    forces: Vec<Program<Shifts<P, Gravity<false>>>>,
    with_rates: Vec<Program<Shifts<P, Gravity<true>>>>,
    /// Of every body twice over.
    position: [Vec<P>; 3],
    velocity: [Vec<P>; 3],
    mass: Vec<P>,
    /// Forces and their rates.
    sums: [Vec<P>; 6],
    /// In double precision, for the energy.
    masses: Vec<f64>,
}

/// The programs of all shifts of a number of bodies.
fn programs<P: backend::Precision, const RATE: bool>(
    softening: f64,
    count: usize,
) -> Vec<Program<Shifts<P, Gravity<RATE>>>> {
    let firsts = (1..count).step_by(BLOCK);
    firsts
        .map(|first| Program::new(Shifts::new(Gravity { softening }, first..count.min(first + BLOCK))))
        .collect()
}

/// The programs of a step's forces, of which those of whole blocks execute the same operations.
pub(super) fn counted(softening: f64, count: usize) -> Vec<VectorProgram> {
    let of = |shifts: usize, times: usize| VectorProgram {
        part: "forces",
        length: "N",
        n: count,
        times: times as u64,
        program: Box::new(Program::new(Shifts::<f64, _>::new(Gravity::<false> { softening }, 1..1 + shifts))),
    };
    let (blocks, rest) = ((count - 1) / BLOCK, (count - 1) % BLOCK);
    [(BLOCK, blocks), (rest, 1)]
        .into_iter()
        .filter(|(shifts, times)| shifts * times > 0)
        .map(|it| of(it.0, it.1))
        .collect()
}

impl<P: backend::Precision> Shifted<P> {
    /// Of bodies.
    pub(super) fn new(
        softening: f64,
        bodies: &Bodies,
        (execution, set): (Execution, InstructionSet),
    ) -> Self {
        let count = bodies.len();
        let twice = || vec![P::default(); 2 * count];
        let mut mass = twice();
        doubled(&mut mass, &bodies.mass[..count]);
        Shifted {
            softening,
            count,
            execution,
            set,
            forces: programs(softening, count),
            with_rates: vec![],
            position: [twice(), twice(), twice()],
            velocity: [twice(), twice(), twice()],
            mass,
            sums: std::array::from_fn(|_| vec![P::default(); count]),
            masses: bodies.mass[..count].to_vec(),
        }
    }
}

/// Writes the entries of a column twice over.
fn doubled<P: backend::Precision>(to: &mut [P], from: &[f64]) {
    for half in to.chunks_exact_mut(from.len().max(1)) {
        half.iter_mut().zip(from).for_each(|(to, &from)| *to = P::from_f64(from));
    }
}

/// Runs programs over all bodies, one after the other.
fn run<P: backend::Precision, L: Law<3> + Send + Sync>(
    programs: &[Program<Shifts<P, L>>],
    memory: &Memory<'_>,
    count: usize,
    (execution, set): (Execution, InstructionSet),
) -> Result<(), ProgramError> {
    programs.iter().try_for_each(|program| program.run_on_threads(memory, 0..count, execution, set))
}

impl<P: backend::Precision> Sums for Shifted<P> {
    fn sum(
        &mut self,
        position: &Columns,
        velocity: Option<&Columns>,
        observed: bool,
    ) -> Result<[f64; 2], ProgramError> {
        let count = self.count;
        for (to, from) in self.position.iter_mut().zip(position) {
            doubled(to, &from[..count]);
        }
        for (to, from) in self.velocity.iter_mut().zip(velocity.into_iter().flatten()) {
            doubled(to, &from[..count]);
        }
        if velocity.is_some() && self.with_rates.is_empty() {
            self.with_rates = programs(self.softening, count);
        }
        self.sums.iter_mut().for_each(|sums| sums.fill(P::default()));
        let Shifted { forces, with_rates, position: at, velocity: with, mass, sums, .. } = self;
        let mut memory = Memory::new();
        memory.bind_read(Slot::new(body_array(Field::Mass)), mass);
        for axis in AXES {
            memory.bind_read(Slot::new(BODY_POSITION[axis as usize]), &at[axis as usize]);
            let of_velocity = body_array(Field::Velocity(axis));
            memory.bind_read(Slot::new(of_velocity), &with[axis as usize]);
        }
        let [fx, fy, fz, rate_x, rate_y, rate_z] = sums;
        for (axis, (force, rate)) in AXES.into_iter().zip([(fx, rate_x), (fy, rate_y), (fz, rate_z)]) {
            memory.bind_write(Slot::new(body_sum_array(Sum::Force(axis))), force);
            memory.bind_write(Slot::new(body_sum_array(Sum::ForceRate(axis))), rate);
        }
        let way = (self.execution, self.set);
        match velocity {
            None => run(forces, &memory, count, way)?,
            Some(_) => run(with_rates, &memory, count, way)?,
        }
        // The programs have forces alone, as the source's.
        let energy = if observed { potential(&self.masses, position, self.softening) } else { 0.0 };
        Ok([energy, 0.0])
    }

    fn over(&self, inverse_mass: &[f64], first: usize, into: &mut Columns) {
        for (into, sum) in into.iter_mut().zip(&self.sums[first..]) {
            for ((into, sum), inverse) in into.iter_mut().zip(sum).zip(inverse_mass) {
                *into = sum.to_f64() * inverse;
            }
        }
    }
}
