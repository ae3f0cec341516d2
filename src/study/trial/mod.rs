//! Trials: runs of a scene that a study makes, looked at on the way.

pub(super) mod any_number;
mod pairs;
mod sample;
mod stopwatch;

pub use pairs::{Compared, Paired, TOGETHER, Window, pairs, part, steady};
pub use sample::{Known, ROWS, Sample, Span};
pub use stopwatch::Stopwatch;

use super::state::State;
use crate::model::clock::{Clock, Work};
use crate::model::machine::MachineModel;
use crate::results::Meter;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use stripmine_physics::method::{Failure, Prepared, Purpose, Simulation, Until};

/// Repeats are timed over at least this long.
const LONG_TOGETHER: Duration = Duration::from_millis(1);

/// How trials are timed, and ended before their time.
#[derive(Clone, Copy, Debug)]
pub struct Trial<'t> {
    /// Seconds that they take.
    pub watch: &'t Stopwatch,
    /// Set where a user asks for the end.
    pub stop: &'t AtomicBool,
}

/// The end of a run.
pub struct End {
    pub state: State,
    /// Clock periods of a step on a machine, the mean over the looks; none where no operations are counted.
    pub clocks: Option<f64>,
}

/// How far a run goes.
#[derive(Clone, Copy, Debug)]
pub struct Course {
    pub steps: u64,
    /// Looks, evenly spread, the last one at the end.
    pub looks: u64,
    /// Seconds that a step is expected to take.
    pub each: f64,
}

/// Runs a scene; `look` sees it, the first time before the first step, with the quantities observed.
pub fn follow(
    prepared: &Prepared,
    purpose: Purpose,
    course: Course,
    machine: Option<&MachineModel>,
    meter: &Meter<'_>,
    mut look: impl FnMut(&dyn Simulation),
) -> Result<End, Failure> {
    let mut simulation = prepared.start(purpose)?;
    let mut clocks = vec![];
    for at in 0..=course.looks {
        advance(simulation.as_mut(), course.steps * at / course.looks.max(1), course.each, meter)?;
        look(simulation.as_ref());
        clocks.extend(machine.and_then(|machine| clock_periods(machine, simulation.as_ref())));
    }
    let mean = clocks.iter().sum::<f64>() / clocks.len() as f64;
    Ok(End { state: State::of(&simulation.particles()), clocks: (!clocks.is_empty()).then_some(mean) })
}

/// Goes on up to a step; what is done is heard at least twice a second, as far as steps take as long as expected.
pub fn advance(
    simulation: &mut dyn Simulation,
    end: u64,
    each: f64,
    meter: &Meter<'_>,
) -> Result<(), Failure> {
    let stride = ((0.3 / each.max(1e-12)) as u64).max(1);
    let mut done = simulation.clock().steps;
    while done < end {
        let next = (done + stride).min(end);
        simulation.advance(&[Until::Steps(next)], &AtomicBool::new(false))?;
        meter.add(each * (next - done) as f64);
        done = next;
    }
    Ok(())
}

/// Processor seconds of a run of that many steps, over all threads; short runs are made again and again.
pub fn timed(prepared: &Prepared, course: Course, meter: &Meter<'_>) -> Result<f64, Failure> {
    let (mut spent, mut runs) = (Duration::ZERO, 0);
    while spent < LONG_TOGETHER {
        let mut simulation = prepared.start(Purpose::Measurement)?;
        let before = cpu_time::ProcessTime::now();
        advance(simulation.as_mut(), course.steps, course.each, meter)?;
        spent += before.elapsed();
        runs += 1;
    }
    Ok(spent.as_secs_f64() / f64::from(runs))
}

/// Clock periods of the last step by the source's clock; none where operations are not counted.
fn clock_periods(machine: &MachineModel, simulation: &dyn Simulation) -> Option<f64> {
    let operations = simulation.operations();
    let is_counted = !operations.is_empty();
    let clocks =
        operations.into_iter().map(|(counts, n)| Clock::Paper.clocks(machine, &Work::from(counts), n));
    is_counted.then(|| clocks.sum())
}
