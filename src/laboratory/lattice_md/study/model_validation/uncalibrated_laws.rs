//! Programs of laws without calibration, to test that the model does not need a fitted number for every program.

use super::errors::{UNCALIBRATED_LAW, ValidationCase};
use super::{EXECUTIONS, OutsideCalibration};
use crate::laboratory::lattice_md::study::StudyError;
use crate::laboratory::lattice_md::study::samples::Samples;
use crate::model::host::{HostModel, StepArrays};
use stripmine_kernels::isa::{AlignedColumn, Array, Memory, Slot};
use stripmine_kernels::law::gravity::Gravity;
use stripmine_kernels::law::lennard_jones::LennardJones;
use stripmine_kernels::law::potential::CutOff;
use stripmine_kernels::mask::Mask;
use stripmine_kernels::sweep::all_pairs::shifts::{BODY_POSITION, Shifts};
use stripmine_kernels::sweep::lattice::forces::Forces;
use stripmine_kernels::sweep::lattice::{Coordinates, LatticeFrame, LatticeShape};
use stripmine_kernels::{InstructionSet, Program, Runnable};
use stripmine_physics::method::throughput::MeasurementError;

/// Approximate lengths of the vectors: in the caches and beyond.
const LENGTHS: [usize; 3] = [600, 8000, 100_000];
/// Samples per program.
const SAMPLES: usize = 5;
/// Approximate number of elements per sample.
const ELEMENTS: usize = 30_000;

/// Measures every law with vectors of every length and with every execution of programs.
pub(super) fn uncalibrated_laws(host: &HostModel) -> Result<Vec<ValidationCase>, StudyError> {
    let mut cases = vec![];
    for n in LENGTHS {
        for (name, half_width) in [("Lennard-Jones, 24 places", 2), ("Lennard-Jones, 120 places", 5)] {
            let (side, mask) = (n.isqrt(), Mask::square(half_width));
            let shape = LatticeShape::new(side, side, &mask, [true; 2]).map_err(MeasurementError::from)?;
            let law = CutOff::new(LennardJones::new(1.0, 1.0), 1.12);
            let frame = LatticeFrame { origin: [0.0; 2], edge: [0.56; 2] };
            let forces = Forces::<f64, _>::new(law, &mask, shape, frame, Coordinates::CellRelative);
            let arrays = [&[Array::X, Array::Y][..], &[Array::Fx, Array::Fy]];
            let place = (shape.swept().start, shape.swept().len(), shape.padded());
            cases.extend(time_program(host, name, &Program::new(forces), arrays, place)?);
        }
        let shifts = Program::new(Shifts::<f64, _>::new(Gravity::<false> { softening: 0.1 }, 1..17));
        let read: Vec<Array> = BODY_POSITION.into_iter().chain([Array::BodyMass]).collect();
        let arrays = [&read[..], &[Array::BodyFx, Array::BodyFy, Array::BodyFz]];
        cases.extend(time_program(host, "gravity, 16 shifts", &shifts, arrays, (0, n, 2 * n))?);
    }
    Ok(cases)
}

/// Runs a program over `n` elements starting at `first` with every execution. All arrays have `length` elements.
fn time_program(
    host: &HostModel,
    name: &str,
    program: &dyn Runnable,
    [read, written]: [&[Array]; 2],
    (first, n, length): (usize, usize, usize),
) -> Result<Vec<ValidationCase>, StudyError> {
    let near_one = |at: usize| 1.0 + 1e-3 * (at % 97) as f64;
    let column = |array: &Array| AlignedColumn::new(*array as usize, (0..length).map(near_one));
    let inputs: Vec<AlignedColumn<f64>> = read.iter().map(column).collect();
    let mut outputs: Vec<AlignedColumn<f64>> = written.iter().map(column).collect();
    let mut memory = Memory::new();
    read.iter().zip(&inputs).for_each(|(array, column)| memory.bind_read(Slot::new(*array), column));
    for (array, column) in written.iter().zip(&mut outputs) {
        memory.bind_write(Slot::new(*array), column);
    }
    let outlines = program.outlines();
    let around = StepArrays::of_step(&[(&outlines, n)]);
    let programs = EXECUTIONS.iter().filter_map(|(name, how)| Some((*name, (*how)?)));
    let cases = programs.map(|(execution, how)| {
        let predicted = host.program(&outlines, n, how, &around);
        let predicted = predicted.map_err(OutsideCalibration::of(execution.to_owned()))?;
        // Separately, because another execution would change the contents of the caches.
        let mut samples = [Samples::default()];
        for _ in 0..SAMPLES {
            let run = |_| program.run(&memory, first..first + n, how, InstructionSet::best());
            Samples::take_in_turns(&mut samples, (ELEMENTS / n).max(1), run)
                .map_err(MeasurementError::from)?;
        }
        let (place, measured) = (format!("{name}, n = {n}"), samples[0].median().unwrap_or(f64::NAN));
        Ok(ValidationCase { place, execution, phase: UNCALIBRATED_LAW, predicted, measured })
    });
    cases.collect()
}
