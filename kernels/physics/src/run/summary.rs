//! What a run says of itself at the end.

use super::structured::Summed;
use super::{Job, forecast};
use crate::averages::Averages;
use crate::method::{Clock, Failure, RunWarning, Simulation};
use crate::origin::{Origin, host, moment};
use serde::Serialize;
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::time::{Duration, SystemTime};

/// The content of `summary.json`.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// The program.
    pub origin: Origin,
    /// The processor, where the system names it, and the platform.
    pub host: String,
    /// When this session began, in universal time.
    pub begun: String,
    /// When it ended.
    pub ended: String,
    /// Seed of the random numbers that made the start; none where it was read or listed.
    pub seed: Option<u64>,
    /// Instructions used, where the method has a choice.
    pub instruction_set: Option<Value>,
    /// Threads used.
    pub threads: usize,
    /// What the scene left open and has been chosen, with the reason.
    pub choices: Vec<String>,
    /// What the scene has no need of, with the reason.
    pub left_out: Vec<String>,
    /// What was warned about.
    pub warnings: Vec<String>,
    /// What was warned about at the end, with numbers.
    pub checks: Vec<RunWarning>,
    /// What was to be expected of the step, by name.
    pub foreseen: Map<String, Value>,
    /// What was out of the ordinary along the run's sessions: another version of the program, an older checkpoint and the
    /// like; known once it is written.
    pub notes: Vec<String>,
    /// What stopped the run, if the physics did.
    #[serde(serialize_with = "Failure::in_json")]
    pub failure: Option<Failure>,
    /// The mean of each quantity with its error.
    pub averages: Averages,
    /// What was summed up of the structure.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub structure: Vec<Summed>,
    /// Steps done.
    pub steps: u64,
    /// Simulated time.
    pub time: f64,
    /// Events so far; 0 where the method has none.
    pub events: u64,
    /// Wall seconds of this session, writing included.
    pub seconds: f64,
    /// Wall seconds of this session in each phase.
    pub phases: BTreeMap<&'static str, f64>,
    /// What the method says of itself.
    #[serde(flatten)]
    pub method: Map<String, Value>,
    /// Where this session began.
    #[serde(skip)]
    pub from: Clock,
    /// The last state, in a line.
    #[serde(skip)]
    pub in_words: String,
}

impl Summary {
    pub(super) fn of(
        Job { prepared, program, .. }: Job<'_>,
        simulation: &dyn Simulation,
        averages: Averages,
        from: Clock,
        seconds: f64,
        failure: Option<&Failure>,
    ) -> Summary {
        let clock = simulation.clock();
        let mut warnings: Vec<String> = prepared.warnings.iter().map(ToString::to_string).collect();
        let checks = simulation.warnings();
        warnings.extend(checks.iter().map(|check| check.message.clone()));
        Summary {
            origin: program.clone(),
            host: host(),
            begun: moment(SystemTime::now() - Duration::from_secs_f64(seconds)),
            ended: moment(SystemTime::now()),
            seed: prepared.seed,
            instruction_set: prepared.settings.get("instruction_set").cloned(),
            threads: rayon::current_num_threads(),
            choices: prepared.choices.clone(),
            left_out: prepared.left_out.clone(),
            warnings,
            checks,
            foreseen: forecast::as_data(forecast::of_the_step(prepared)),
            notes: vec![],
            failure: failure.cloned(),
            averages,
            structure: vec![],
            steps: clock.steps,
            time: clock.time,
            events: clock.events,
            seconds,
            phases: simulation.phases(),
            method: simulation.summary(),
            from,
            in_words: simulation.in_words(),
        }
    }
}
