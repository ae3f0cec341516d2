//! Force sum on the vector machine (PWP): whole-array operations between all bodies and those shifted by an offset, for every shift.

use super::bodies::{PointMasses, StateColumns};
use super::rounded::RoundedBodies;
use super::sums::{ForceSums, StopCallback, over, potential};
use crate::method::{BoundPrograms, ProgramCall, VectorProgram};
use stripmine_kernels::backend;
use stripmine_kernels::isa::{Memory, ProgramError, Slot};
use stripmine_kernels::law::gravity::Gravity;
use stripmine_kernels::law::{Axis, Law, ParticleField, ParticleSum};
use stripmine_kernels::sweep::all_pairs::is_split;
use stripmine_kernels::sweep::all_pairs::shifts::{
    BODY_POSITION, BODY_REST, Shifts, body_array, body_sum_array,
};
use stripmine_kernels::{Execution, InstructionSet, Program};

/// Shifts per program: sums and own bodies are loaded once for all of them.
const BLOCK: usize = 16;
const AXES: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];

/// Programs over all shifts, in precision `P`.
pub(super) struct ShiftedPrograms<P: backend::Precision> {
    softening: f64,
    count: usize,
    execution: Execution,
    set: InstructionSet,
    forces: Vec<Program<Shifts<P, Gravity<false>>>>,
    with_rates: Vec<Program<Shifts<P, Gravity<true>>>>,
    /// Bodies stored twice in a row, so that shifts need no wrapping.
    bodies: RoundedBodies<P>,
    /// Sums of the forces and their rates.
    sums: [Vec<P>; 6],
    /// Masses in double precision, for the energy.
    masses: Vec<f64>,
}

/// Builds the programs of all shifts for a number of bodies.
fn programs<P: backend::Precision, const RATE: bool>(
    softening: f64,
    count: usize,
) -> Vec<Program<Shifts<P, Gravity<RATE>>>> {
    let firsts = (1..count).step_by(BLOCK);
    firsts
        .map(|first| Program::new(Shifts::new(Gravity { softening }, first..count.min(first + BLOCK))))
        .collect()
}

/// Programs of the forces of a step; all whole blocks execute the same operations.
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

/// Binds the bodies and their sums, which are set to zero.
fn bound<'a, P: backend::Precision>(bodies: &'a RoundedBodies<P>, sums: &'a mut [Vec<P>; 6]) -> Memory<'a> {
    sums.iter_mut().for_each(|sums| sums.fill(P::default()));
    let mut memory = Memory::new();
    memory.bind_read(Slot::new(body_array(ParticleField::Mass)), &bodies.mass);
    for axis in AXES {
        memory.bind_read(Slot::new(BODY_POSITION[axis as usize]), &bodies.position[axis as usize]);
        if is_split::<P>() {
            memory.bind_read(Slot::new(BODY_REST[axis as usize]), &bodies.rest[axis as usize]);
        }
        let of_velocity = body_array(ParticleField::Velocity(axis));
        memory.bind_read(Slot::new(of_velocity), &bodies.velocity[axis as usize]);
    }
    let [fx, fy, fz, rate_x, rate_y, rate_z] = sums;
    for (axis, (force, rate)) in AXES.into_iter().zip([(fx, rate_x), (fy, rate_y), (fz, rate_z)]) {
        memory.bind_write(Slot::new(body_sum_array(ParticleSum::Force(axis))), force);
        memory.bind_write(Slot::new(body_sum_array(ParticleSum::ForceRate(axis))), rate);
    }
    memory
}

/// Calls `task` with the programs of the forces and their arrays.
pub(super) fn with_bound_programs<P: backend::Precision>(
    softening: f64,
    bodies: &PointMasses,
    task: &mut BoundPrograms<'_>,
) {
    let mut shifted =
        ShiftedPrograms::<P>::new(softening, bodies, (Execution::Chained, InstructionSet::best()));
    shifted.bodies.convert_bodies(&bodies.position, None);
    let ShiftedPrograms { forces, bodies, sums, count, .. } = &mut shifted;
    let calls: Vec<ProgramCall<'_>> =
        forces.iter().map(|program| ProgramCall { part: "forces", program, range: 0..*count }).collect();
    task(&calls, &bound(bodies, sums));
}

impl<P: backend::Precision> ShiftedPrograms<P> {
    /// Creates the sums of bodies.
    pub(super) fn new(
        softening: f64,
        bodies: &PointMasses,
        (execution, set): (Execution, InstructionSet),
    ) -> Self {
        let count = bodies.len();
        let masses = bodies.mass[..count].to_vec();
        let bodies = RoundedBodies::new(bodies, count, 2);
        let held = bodies.units.length(softening);
        ShiftedPrograms {
            softening,
            count,
            execution,
            set,
            forces: programs(held, count),
            with_rates: vec![],
            bodies,
            sums: std::array::from_fn(|_| vec![P::default(); count]),
            masses,
        }
    }
}

/// Memory of the programs of all shifts, in bytes.
fn program_bytes<P: backend::Precision, const RATE: bool>(count: usize) -> usize {
    let law = Gravity::<RATE> { softening: 0.0 };
    let block = Program::new(Shifts::<P, _>::new(law, 1..1 + BLOCK)).tape().bytes();
    (count - 1).div_ceil(BLOCK) * (block + size_of::<Program<Shifts<P, Gravity<RATE>>>>())
}

/// Runs programs over all bodies in sequence.
fn run<P: backend::Precision, L: Law<3> + Send + Sync>(
    programs: &[Program<Shifts<P, L>>],
    memory: &Memory<'_>,
    count: usize,
    (execution, set): (Execution, InstructionSet),
    stop: StopCallback<'_>,
) -> Result<(), ProgramError> {
    programs.iter().try_for_each(|program| {
        if stop() {
            return Err(ProgramError::Interrupted);
        }
        program.run_on_threads(memory, 0..count, execution, set)
    })
}

impl<P: backend::Precision> ShiftedPrograms<P> {
    /// Memory in bytes, with or without rates of the forces.
    pub(super) fn bytes(count: usize, has_rates: bool) -> usize {
        let rates = if has_rates { program_bytes::<P, true>(count) } else { 0 };
        let columns = 6 * P::BYTES + size_of::<f64>();
        RoundedBodies::<P>::bytes(count, 2) + count * columns + program_bytes::<P, false>(count) + rates
    }
}

impl<P: backend::Precision> ForceSums for ShiftedPrograms<P> {
    fn sum(
        &mut self,
        position: &StateColumns,
        velocity: Option<&StateColumns>,
        observed: bool,
        stop: StopCallback<'_>,
    ) -> Result<f64, ProgramError> {
        let count = self.count;
        self.bodies.convert_bodies(position, velocity);
        if velocity.is_some() && self.with_rates.is_empty() {
            self.with_rates = programs(self.bodies.units.length(self.softening), count);
        }
        let ShiftedPrograms { forces, with_rates, bodies, sums, .. } = self;
        let memory = bound(bodies, sums);
        let configuration = (self.execution, self.set);
        match velocity {
            None => run(forces, &memory, count, configuration, stop)?,
            Some(_) => run(with_rates, &memory, count, configuration, stop)?,
        }
        // As in PWP, the programs calculate forces only.
        if observed { potential(&self.masses, position, self.softening, stop) } else { Ok(0.0) }
    }

    fn over(&self, per_mass: &[f64], [acceleration, jerk]: [Option<&mut StateColumns>; 2]) {
        let units = self.bodies.units;
        over(&self.sums[..3], units.force(), per_mass, acceleration);
        over(&self.sums[3..], units.force_rate(), per_mass, jerk);
    }
}
