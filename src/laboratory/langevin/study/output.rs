//! LAN17's output: positions and the mean square displacement as text on the disk after each of 100 steps, one task after the other and in
//! parallel sections.

use crate::frame::{FrameBuilder, ResultFrame, TableCell};
use crate::laboratory::rates::{CaseReading, MeasuredCase, StudyWork};
use crate::laboratory::running::RunningScene;
use crate::study::StudyError;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::time::Instant;
use stripmine_physics::scene::Overrides;

/// Measured work: the tasks of the output.
pub(super) const WORK: StudyWork = StudyWork { name: "langevin-output", measure: |_| measure_output() };

/// Number of steps; output follows each.
const STEPS: usize = 100;
/// Step of the velocities (time); γ = m = kT = 1.
const DT: f64 = 0.001;
/// Parts of the measurement: each task alone, all of them one after the other, and at the same time.
const PARTS: [&str; 5] = [
    "velocities",
    "positions as text",
    "mean square displacement",
    "one after the other",
    "in parallel sections",
];

/// State of the tasks.
struct OutputTasks {
    positions: Vec<[f64; 2]>,
    start: Vec<[f64; 2]>,
    velocities: Vec<[f64; 2]>,
    trajectory: BufWriter<File>,
    means: BufWriter<File>,
}

impl OutputTasks {
    fn new() -> Result<OutputTasks, StudyError> {
        let mut running = RunningScene::begin_timed("langevin-report", &Overrides::new())?;
        let places = |running: &RunningScene| -> Vec<[f64; 2]> {
            running.simulation.particles().all().iter().map(|it| it.planar_position()).collect()
        };
        let start = places(&running);
        running.advance_steps(STEPS as u64)?;
        let moving = running.simulation.particles();
        let file = || tempfile::tempfile().map(BufWriter::new).map_err(StudyError::Files);
        Ok(OutputTasks {
            positions: places(&running),
            start,
            velocities: moving.all().iter().map(|it| it.planar_velocity()).collect(),
            trajectory: file()?,
            means: file()?,
        })
    }
}

/// A step of the velocities: friction and a force that stands for noise and pairs.
fn move_velocities(velocities: &mut [[f64; 2]], forces: &[[f64; 2]]) {
    for (velocity, force) in velocities.iter_mut().zip(forces) {
        (0..2).for_each(|axis| velocity[axis] += DT * (force[axis] - velocity[axis]));
    }
}

fn write_positions(out: &mut impl Write, positions: &[[f64; 2]]) -> io::Result<()> {
    positions.iter().try_for_each(|[x, y]| writeln!(out, "{x} {y}"))?;
    out.flush()
}

fn write_mean(out: &mut impl Write, positions: &[[f64; 2]], start: &[[f64; 2]]) -> io::Result<()> {
    let square = |([x, y], [x0, y0]): (&[f64; 2], &[f64; 2])| (x - x0) * (x - x0) + (y - y0) * (y - y0);
    let sum: f64 = positions.iter().zip(start).map(square).sum();
    writeln!(out, "{}", sum / positions.len() as f64)?;
    out.flush()
}

/// Measures the tasks of all steps.
fn measure_output() -> Result<CaseReading, StudyError> {
    let OutputTasks { positions, start, mut velocities, mut trajectory, mut means } = OutputTasks::new()?;
    let mut seconds = [0.0; 5];
    let mut timed = |part: usize, task: &mut dyn FnMut() -> io::Result<()>| {
        let begun = Instant::now();
        let done = task();
        seconds[part] += begun.elapsed().as_secs_f64();
        done.map_err(StudyError::Files)
    };
    for _ in 0..STEPS {
        timed(0, &mut || {
            move_velocities(&mut velocities, &positions);
            Ok(())
        })?;
        timed(1, &mut || write_positions(&mut trajectory, &positions))?;
        timed(2, &mut || write_mean(&mut means, &positions, &start))?;
        timed(4, &mut || {
            let (_, (written, averaged)) = rayon::join(
                || move_velocities(&mut velocities, &positions),
                || {
                    rayon::join(
                        || write_positions(&mut trajectory, &positions),
                        || write_mean(&mut means, &positions, &start),
                    )
                },
            );
            written.and(averaged)
        })?;
    }
    seconds[3] = seconds[..3].iter().sum();
    let parts = PARTS.into_iter().zip(seconds).map(|(name, seconds)| (name.to_owned(), seconds)).collect();
    Ok(CaseReading { work: 1.0, seconds: seconds[3], parts, ..CaseReading::default() })
}

/// Table of the parts.
pub(super) fn frame(measured: &MeasuredCase) -> ResultFrame {
    FrameBuilder::of(PARTS)
        .text("part", |name| *name)
        .cell("time (s)", |name| -> TableCell { measured.part(name).cell(1.0, 4) })
        .frame("output", "LAN17's output of 100 steps: median and range of three processes, two threads")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand, for two particles; the first has moved by (3, 4).
    #[test]
    fn output_has_positions_and_the_mean() {
        let (mut trajectory, mut means) = (vec![], vec![]);
        let positions = [[3.0, 4.5], [1.0, 2.0]];
        write_positions(&mut trajectory, &positions).unwrap();
        write_mean(&mut means, &positions, &[[0.0, 0.5], [1.0, 2.0]]).unwrap();
        assert_eq!((trajectory, means), (b"3 4.5\n1 2\n".to_vec(), b"12.5\n".to_vec()));
        let mut velocities = [[2.0, 0.0]];
        move_velocities(&mut velocities, &[[1.0, 1.0]]);
        assert_eq!(velocities, [[1.999, 0.001]]);
    }
}
