//! A scene's programs on this host: operations, flops and bytes of each, with the time that the host model predicts beside the measured one.

use crate::console::CommandFailure;
use crate::emission::EmissionError;
use crate::frame::{FrameBuilder, ResultFrame};
use crate::laboratory::running::on_threads;
use crate::model::host::{HostModel, StepArrays};
use crate::statistics::median;
use crate::study::StudyError;
use std::time::{Duration, Instant};
use stripmine_kernels::backend::tape::Outlines;
use stripmine_kernels::isa::{Memory, ProgramError};
use stripmine_kernels::{Execution, InstructionSet};
use stripmine_physics::method::{Prepared, ProgramCall};

/// Executions by their names in scenes.
const EXECUTIONS: [(&str, Execution); 3] =
    [("eager", Execution::Eager), ("strip:512", Execution::Strip(512)), ("chained", Execution::Chained)];
/// Steps before the measurement, fewest and most measured steps, and time of the measurement of an execution.
const WARM_UP: usize = 2;
const FEWEST: usize = 3;
const MOST: usize = 1000;
const LASTS: Duration = Duration::from_millis(500);

/// A program with an execution.
struct TimedProgram {
    part: String,
    n: usize,
    execution: &'static str,
    /// Sums over the elements.
    operations: u64,
    flops: u64,
    bytes: f64,
    /// Nanoseconds; none beyond the calibrated range.
    predicted: Option<f64>,
    measured: f64,
}

/// Runs the programs of a scene for some steps on one thread.
///
/// # Errors
/// [`StudyError`] if the scene has no programs, or one fails.
pub(crate) fn host_frame(
    name: &str,
    prepared: &Prepared,
    model: &HostModel,
) -> Result<ResultFrame, CommandFailure> {
    let mut rows = None;
    on_threads(1, || {
        prepared.model.with_bound_programs(&mut |calls, memory| rows = Some(timed(calls, memory, model)));
        Ok(())
    })?;
    let rows = rows.ok_or_else(|| StudyError::NoPrograms(name.to_owned()))?;
    let rows = rows.map_err(EmissionError::from)?;
    Ok(FrameBuilder::of(&rows)
        .text("part", |it| &it.part)
        .text("execution", |it| it.execution)
        .count("n", |it| it.n)
        .number("NOP·n (million)", 3, |it| 1e-6 * it.operations as f64)
        .number("Mflop", 3, |it| 1e-6 * it.flops as f64)
        .number("moved (MB)", 3, |it| 1e-6 * it.bytes)
        .number("predicted (µs)", 1, |it| it.predicted.map(|ns| 1e-3 * ns))
        .number("measured (µs)", 1, |it| 1e-3 * it.measured)
        .number("predicted over measured", 2, |it| it.predicted.map(|ns| ns / it.measured))
        .number("GFlop/s", 2, |it| it.flops as f64 / it.measured)
        .frame("host", format!("{name}: a step on this host, {}", model.title)))
}

fn timed(
    calls: &[ProgramCall<'_>],
    memory: &Memory<'_>,
    model: &HostModel,
) -> Result<Vec<TimedProgram>, ProgramError> {
    let outlined: Vec<Outlines> = calls.iter().map(|call| call.program.outlines()).collect();
    let visited: Vec<(&Outlines, usize)> =
        outlined.iter().zip(calls).map(|(outlines, call)| (outlines, call.range.len())).collect();
    let arrays = StepArrays::of_step(&visited);
    let mut rows = vec![];
    for (name, execution) in EXECUTIONS {
        let measured = medians(calls, memory, execution)?;
        for ((at, call), measured) in calls.iter().enumerate().zip(measured) {
            let n = call.range.len();
            let [operations, flops] = call.program.tally().iter().fold([0, 0], |sum, (_, counts)| {
                [sum[0] + counts.total() * n as u64, sum[1] + counts.flops() * n as u64]
            });
            rows.push(TimedProgram {
                part: format!("{} {}", call.part, at + 1),
                n,
                execution: name,
                operations,
                flops,
                bytes: arrays.bytes(&outlined[at], n, execution),
                predicted: model.program(&outlined[at], n, execution, &arrays).ok(),
                measured,
            });
        }
    }
    Ok(rows)
}

/// Median nanoseconds of each program in steps of one execution.
fn medians(
    calls: &[ProgramCall<'_>],
    memory: &Memory<'_>,
    execution: Execution,
) -> Result<Vec<f64>, ProgramError> {
    let mut samples = vec![vec![]; calls.len()];
    let begun = Instant::now();
    for step in 0..WARM_UP + MOST {
        if step >= WARM_UP + FEWEST && begun.elapsed() > LASTS {
            break;
        }
        for (call, samples) in calls.iter().zip(&mut samples) {
            let start = Instant::now();
            call.program.run(memory, call.range.clone(), execution, InstructionSet::best())?;
            if step >= WARM_UP {
                samples.push(start.elapsed().as_nanos() as f64);
            }
        }
    }
    Ok(samples.into_iter().map(|samples| median(samples.into_iter())).collect())
}
