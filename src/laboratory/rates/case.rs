//! Cases of a grid, and their measurement in this process.

use crate::console::CommandFailure;
use crate::frame::TableCell;
use crate::laboratory::running::{RunningScene, on_threads};
use crate::study::StudyError;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io;
use std::time::Instant;
use stripmine_physics::memory;
use stripmine_physics::method::{self, METHODS, StartPurpose, load};
use stripmine_physics::scene::Overrides;

/// Measured work that is not a run of a scene.
#[derive(Debug)]
pub(crate) struct StudyWork {
    /// Name by which the measuring process identifies the work.
    pub name: &'static str,
    /// Measures the work that some parameters describe.
    pub(crate) measure: fn(&serde_json::Value) -> Result<CaseReading, StudyError>,
}

/// Parses the parameters given to a measuring process.
///
/// # Errors
/// [`StudyError::Parameters`] if they are not of the type `T`.
pub(crate) fn parse_parameters<T: DeserializeOwned>(parameters: &serde_json::Value) -> Result<T, StudyError> {
    T::deserialize(parameters).map_err(StudyError::Parameters)
}

/// One case of a grid.
#[derive(Clone, Debug)]
pub(crate) struct RateCase {
    pub(super) labels: Vec<(String, TableCell)>,
    pub(super) task: CaseTask,
    /// Number of threads if wall time is measured; otherwise processor time is measured.
    pub(super) threads: Option<usize>,
}

/// Work of a case, as sent to another process.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) enum CaseTask {
    Scene {
        preset: String,
        overrides: Vec<String>,
        in_events: bool,
        /// Steps or events before the clock starts, and minimum number after it.
        amount: [u64; 2],
        /// Minimum measured seconds.
        seconds: f64,
    },
    Own {
        name: String,
        parameters: serde_json::Value,
        #[serde(skip)]
        own: Option<&'static StudyWork>,
    },
}

impl RateCase {
    /// Times a scene over some steps after a warm-up.
    pub(crate) fn steps(preset: &str, overrides: &Overrides, warm_up: u64, steps: u64) -> RateCase {
        RateCase::scene(preset, overrides, false, [warm_up, steps])
    }

    /// Times a scene over some events after a warm-up.
    pub(crate) fn events(preset: &str, overrides: &Overrides, warm_up: u64, events: u64) -> RateCase {
        RateCase::scene(preset, overrides, true, [warm_up, events])
    }

    fn scene(preset: &str, overrides: &Overrides, in_events: bool, amount: [u64; 2]) -> RateCase {
        let (preset, overrides) = (preset.to_owned(), overrides.texts());
        RateCase {
            labels: vec![],
            task: CaseTask::Scene { preset, overrides, in_events, amount, seconds: 0.0 },
            threads: None,
        }
    }

    /// Times work that is not a run of a scene.
    pub(crate) fn own(own: &'static StudyWork, parameters: serde_json::Value) -> RateCase {
        let task = CaseTask::Own { name: own.name.to_owned(), parameters, own: Some(own) };
        RateCase { labels: vec![], task, threads: None }
    }

    /// Adds a label that distinguishes the case: a column of the frame and a part of its name.
    #[must_use]
    pub(crate) fn label(mut self, heading: &str, value: impl Into<TableCell>) -> RateCase {
        self.labels.push((heading.to_owned(), value.into()));
        self
    }

    /// Extends the case to more steps or events until they take at least `least` seconds.
    #[must_use]
    pub(crate) fn for_seconds(mut self, least: f64) -> RateCase {
        if let CaseTask::Scene { seconds, .. } = &mut self.task {
            *seconds = least;
        }
        self
    }

    /// Runs the case on a number of threads and measures wall time. By default a case runs on one thread and measures processor time.
    #[must_use]
    pub(crate) fn on_threads(self, threads: usize) -> RateCase {
        RateCase { threads: Some(threads), ..self }
    }

    /// Name in messages.
    pub(super) fn name(&self) -> String {
        let label =
            |(heading, value): &(String, TableCell)| format!("{heading} = {}", value.formatted_text());
        self.labels.iter().map(label).collect::<Vec<_>>().join(", ")
    }

    /// Measures the case. `all` lists the work other than scenes, for cases sent by another process.
    pub(super) fn measure(&self, all: &[&StudyWork]) -> Result<CaseReading, CommandFailure> {
        let threads = self.threads.unwrap_or(1);
        let measured = match &self.task {
            CaseTask::Own { name, parameters, own } => {
                let known = || all.iter().find(|it| it.name == name).copied();
                let unknown = || io::Error::other(format!("unknown measured work `{name}`"));
                let own = own.or_else(known).ok_or_else(unknown).map_err(CommandFailure::writing("cases"))?;
                on_threads(threads, || (own.measure)(parameters))
            }
            CaseTask::Scene { preset, overrides, in_events, amount, seconds } => on_threads(threads, || {
                let (prepared, method) = load(preset, overrides, METHODS)?;
                let mut running = RunningScene::of(method, prepared, StartPurpose::Measurement)?;
                let mut advance = |running: &mut RunningScene, amount: u64| match in_events {
                    true => running.advance_events(amount),
                    false => running.advance_steps(amount),
                };
                let clock = if self.threads.is_some() { wall_clock } else { processor_clock };
                time_scene(&mut running, *amount, *seconds, &mut advance, clock)
            }),
        };
        Ok(measured?)
    }
}

fn wall_clock() -> Box<dyn Fn() -> f64> {
    let begun = Instant::now();
    Box::new(move || begun.elapsed().as_secs_f64())
}

fn processor_clock() -> Box<dyn Fn() -> f64> {
    let begun = cpu_time::ProcessTime::now();
    Box::new(move || begun.elapsed().as_secs_f64())
}

/// Times a running scene over at least `least` steps or events and at least `seconds`.
fn time_scene(
    running: &mut RunningScene,
    [warm_up, least]: [u64; 2],
    seconds: f64,
    advance: &mut dyn FnMut(&mut RunningScene, u64) -> Result<(), method::PhysicsFailure>,
    clock: fn() -> Box<dyn Fn() -> f64>,
) -> Result<CaseReading, StudyError> {
    advance(running, warm_up)?;
    running.simulation.reset_phases();
    let counts = |running: &RunningScene| running.simulation.event_operations();
    let (work, before) = (running.simulation.work(), counts(running));
    let elapsed = clock();
    advance(running, least)?;
    let mut done = least;
    while elapsed() < seconds {
        // Estimated from the rate so far; the first steps may be slow.
        let more = (done as f64 * (seconds / elapsed() - 1.0)).ceil().clamp(1.0, 4.0 * done as f64) as u64;
        advance(running, more)?;
        done += more;
    }
    let seconds = elapsed();
    let owned = |(name, value): (&str, f64)| (name.to_owned(), value);
    let after = counts(running).into_iter().zip(before);
    Ok(CaseReading {
        work: running.simulation.work() - work,
        seconds,
        parts: running.simulation.phases().into_iter().map(owned).collect(),
        counts: after.map(|((name, after), (_, before))| owned((name, (after - before) as f64))).collect(),
        peak_memory: memory::peak().map_or(0.0, |bytes| bytes as f64),
    })
}

/// Measurement of a case by one process.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct CaseReading {
    /// Work done: particle-steps, events, interactions.
    pub work: f64,
    /// Measured seconds.
    pub seconds: f64,
    /// Seconds of the parts, by name.
    pub parts: BTreeMap<String, f64>,
    /// Counted operations, by name.
    pub counts: BTreeMap<String, f64>,
    /// Peak memory of the process so far (bytes), for scenes; 0 if the system does not report it.
    #[serde(default)]
    pub peak_memory: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_physics::scene::COUNT;

    /// With a clock set by the test, work continues until the seconds are reached.
    #[test]
    fn work_continues_for_the_requested_seconds() {
        thread_local!(static NOW: std::cell::Cell<f64> = const { std::cell::Cell::new(0.0) });
        let clock: fn() -> Box<dyn Fn() -> f64> = || Box::new(|| NOW.get());
        let discs = Overrides::new().set(&COUNT, 16_u64);
        let mut running = RunningScene::begin_timed("hard-disks", &discs).unwrap();
        let mut amounts = vec![];
        let found = time_scene(
            &mut running,
            [7, 10],
            30.0,
            &mut |running, amount| {
                if !amounts.is_empty() {
                    NOW.set(NOW.get() + amount as f64);
                }
                amounts.push(amount);
                running.advance_events(amount)
            },
            clock,
        );
        assert_eq!(amounts, [7, 10, 20]);
        let found = found.unwrap();
        assert_eq!((found.work, found.seconds), (30.0, 30.0));
    }
}
