//! Error of Z over processor seconds: ours, EDMD and event-chain Monte Carlo, as `tests/rivals/error_of_z.py` measured them.

use crate::console::CommandFailure;
use crate::frame::FrameBuilder;
use crate::provenance::RepeatedMeasurement;
use crate::results::{FinishedItem, StudyEnvironment, StudySize};
use serde::Deserialize;

/// Results of the script, and their provenance.
const ERRORS: &str = include_str!("../../../study/rivals/measured/errors/errors.json");
const SOURCE: &str = include_str!("../../../study/rivals/measured/errors/provenance.json");

#[derive(Deserialize)]
struct MeasuredErrors {
    rows: Vec<MeasuredError>,
}

/// Mean and standard deviation of Z over the seeds of a program, with the processor seconds of a run.
#[derive(Clone, Debug, Deserialize)]
struct MeasuredError {
    program: String,
    packing_fraction: f64,
    seconds: f64,
    seeds: usize,
    mean: f64,
    error: f64,
}

/// Runs of one program at a packing fraction.
struct ProgramErrors<'m>(Vec<&'m MeasuredError>);

impl ProgramErrors<'_> {
    /// Standard deviation of Z in a run of one second: the root mean of the squares that the runs give, if errors fall as t^(−1/2).
    fn at_one_second(&self) -> f64 {
        let squares = self.0.iter().map(|it| it.error * it.error * it.seconds);
        (squares.sum::<f64>() / self.0.len() as f64).sqrt()
    }

    /// Mean of all runs, weighted with their times, and its standard error.
    fn mean(&self) -> [f64; 2] {
        let weight = |it: &MeasuredError| it.seconds * it.seeds as f64;
        let all: f64 = self.0.iter().map(|it| weight(it)).sum();
        let mean = self.0.iter().map(|it| weight(it) * it.mean).sum::<f64>() / all;
        [mean, self.at_one_second() / all.sqrt()]
    }
}

/// Returns the errors as the script measured them.
///
/// # Errors
/// Fails if a shipped file is not in the format of the script.
pub(crate) fn reproduce(_: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let wrong = |cause: serde_json::Error| CommandFailure::writing("errors of error_of_z.py")(cause.into());
    let MeasuredErrors { rows } = serde_json::from_str(ERRORS).map_err(wrong)?;
    let source: RepeatedMeasurement = serde_json::from_str(SOURCE).map_err(wrong)?;
    let programs: Vec<ProgramErrors<'_>> = rows
        .chunk_by(|a, b| (&a.program, a.packing_fraction) == (&b.program, b.packing_fraction))
        .map(|some| ProgramErrors(some.iter().collect()))
        .collect();
    let ours = |it: &ProgramErrors<'_>| {
        let alike = |other: &&ProgramErrors<'_>| {
            other.0[0].program == "Stripmine" && other.0[0].packing_fraction == it.0[0].packing_fraction
        };
        programs.iter().find(alike).map(ProgramErrors::at_one_second)
    };
    let frames = [
        FrameBuilder::of(&rows)
            .text("program", |it| it.program.clone())
            .number("ν", 2, |it| it.packing_fraction)
            .number("seconds", 2, |it| it.seconds)
            .short("error of Z", |it| it.error)
            .count("runs", |it| it.seeds)
            .frame("errors", "Standard deviation of Z over runs with several seeds"),
        FrameBuilder::of(&programs)
            .text("program", |it| it.0[0].program.clone())
            .number("ν", 2, |it| it.0[0].packing_fraction)
            .short("error in a second", |it| it.at_one_second())
            .number("seconds for the error of ours", 2, |it| {
                ours(it).map(|ours| (it.at_one_second() / ours).powi(2))
            })
            .number("Z", 4, |it| it.mean()[0])
            .short("standard error of Z", |it| it.mean()[1])
            .frame("programs", "Error of Z in a second, and time relative to ours for the same error"),
    ];
    Ok(FinishedItem { repeated: vec![source], ..FinishedItem::of(frames) })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: errors of 0.2 after a quarter of a second and of 0.05 after four give 0.1 in one second.
    #[test]
    fn errors_are_scaled_to_one_second() {
        let run = |seconds: f64, error: f64| MeasuredError {
            program: String::new(),
            packing_fraction: 0.5,
            seconds,
            seeds: 4,
            mean: 4.0,
            error,
        };
        let all = [run(0.25, 0.2), run(4.0, 0.05)];
        let program = ProgramErrors(all.iter().collect());
        assert!((program.at_one_second() - 0.1).abs() < 1e-15);
        let [mean, error] = program.mean();
        assert!((mean - 4.0).abs() < 1e-15 && (error - 0.1 / 17.0_f64.sqrt()).abs() < 1e-15);
    }
}
