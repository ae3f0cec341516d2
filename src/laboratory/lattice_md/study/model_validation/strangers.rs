//! Programs of laws that nothing was calibrated on: a model that needs a number for every program would have none for these.

use super::errors::{Case, STRANGER};
use super::{EXECUTIONS, ValidationError};
use crate::laboratory::lattice_md::study::samples::Samples;
use crate::model::host::{Around, HostModel, OutOfRange};
use stripmine_kernels::backend::tape::Outlines;
use stripmine_kernels::isa::{AlignedColumn, Array, Memory, Slot};
use stripmine_kernels::law::gravity::Gravity;
use stripmine_kernels::law::lennard_jones::LennardJones;
use stripmine_kernels::mask::Mask;
use stripmine_kernels::sweep::all_pairs::shifts::{BODY_POSITION, Shifts};
use stripmine_kernels::sweep::lattice::forces::Forces;
use stripmine_kernels::sweep::lattice::{Coordinates, Frame, LatticeShape};
use stripmine_kernels::{InstructionSet, Program, Runnable};
use stripmine_physics::method::throughput::MeasurementError;

/// Elements of the vectors, about: in the caches and beyond.
const LENGTHS: [usize; 3] = [600, 8000, 100_000];
/// Samples of each.
const SAMPLES: usize = 5;
/// Least nanoseconds of one.
const SHORTEST: f64 = 200_000.0;

const BODY_SUMS: [Array; 3] = [Array::BodyFx, Array::BodyFy, Array::BodyFz];

/// Every law over vectors of every length, by every execution of programs.
pub(super) fn strangers(host: &HostModel) -> Result<Vec<Case>, ValidationError> {
    let mut cases = vec![];
    for n in LENGTHS {
        for (name, half_width) in [("Lennard-Jones, 24 places", 2), ("Lennard-Jones, 120 places", 5)] {
            let side = (n as f64).sqrt() as usize;
            let mask = Mask::square(half_width);
            let shape = LatticeShape::new(side, side, &mask, [true; 2]).map_err(MeasurementError::from)?;
            let (law, frame) =
                (LennardJones::new(1.0, 1.0, 1.12), Frame { origin: [0.0; 2], edge: [0.56; 2] });
            let forces = Forces::<f64, _>::new(law, &mask, shape, frame, Coordinates::CellRelative);
            let arrays = [&[Array::X, Array::Y][..], &[Array::Fx, Array::Fy]];
            let run =
                Ran { program: &Program::new(forces), first: shape.swept().start, n: shape.swept().len() };
            cases.extend(run.cases(host, name, arrays, shape.padded())?);
        }
        let shifts = Shifts::<f64, _>::new(Gravity::<false> { softening: 0.1 }, 1..17);
        let read: Vec<Array> = BODY_POSITION.into_iter().chain([Array::BodyMass]).collect();
        let run = Ran { program: &Program::new(shifts), first: 0, n };
        cases.extend(run.cases(host, "gravity, 16 shifts", [&read, &BODY_SUMS], 2 * n)?);
    }
    Ok(cases)
}

struct Ran<'p> {
    program: &'p dyn Runnable,
    first: usize,
    n: usize,
}

impl Ran<'_> {
    /// By every execution; `arrays` are read and written, of `length` elements each.
    fn cases(
        &self,
        host: &HostModel,
        name: &str,
        [read, written]: [&[Array]; 2],
        length: usize,
    ) -> Result<Vec<Case>, ValidationError> {
        let Ran { program, first, n } = *self;
        let near_one = |array: &Array| {
            AlignedColumn::new(*array as usize, (0..length).map(|i| 1.0 + 1e-3 * (i % 97) as f64))
        };
        let inputs: Vec<AlignedColumn<f64>> = read.iter().map(near_one).collect();
        let mut outputs: Vec<AlignedColumn<f64>> =
            written.iter().map(|array| AlignedColumn::filled(*array as usize, 0.0, length)).collect();
        let mut memory = Memory::new();
        read.iter().zip(&inputs).for_each(|(array, column)| memory.bind_read(Slot::new(*array), column));
        for (array, column) in written.iter().zip(&mut outputs) {
            memory.bind_write(Slot::new(*array), column);
        }
        let outlines: Outlines = program.outlines();
        let out = |cause: OutOfRange| ValidationError::OutOfRange { case: name.to_owned(), cause };
        let around = Around::of_step(&[(&outlines, n)]);
        let mut cases = vec![];
        for (execution, how) in EXECUTIONS.iter().filter_map(|(name, how)| Some((*name, (*how)?))) {
            let predicted = host.program(&outlines, n, how, &around).map_err(out)?;
            let mut samples = Samples::default();
            for _ in 0..SAMPLES {
                let run = || program.run(&memory, first..first + n, how, InstructionSet::best());
                samples.take(SHORTEST, run).map_err(MeasurementError::from)?;
            }
            cases.push(Case {
                place: format!("{name}, n = {n}"),
                execution,
                phase: STRANGER,
                predicted,
                measured: samples.middle(),
                halves: samples.halves(),
                baseline: Some(host.baseline(&outlines, n, how)),
            });
        }
        Ok(cases)
    }
}
