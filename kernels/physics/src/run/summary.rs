//! Summary that a run writes at its end.

use super::structured::StructureSummary;
use super::{RunJob, forecast};
use crate::averages::RunAverages;
use crate::method::{Clock, PhysicsFailure, RunWarning, Simulation};
use crate::origin::{Origin, host, moment};
use serde::Serialize;
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::time::{Duration, SystemTime};

/// Content of `summary.json`.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Program of the run.
    pub origin: Origin,
    /// Processor, if the system names it, and platform.
    pub host: String,
    /// Start of this session in UTC.
    pub begun: String,
    /// End of this session in UTC.
    pub ended: String,
    /// Seed of the start's random numbers; none if it was read or listed.
    pub seed: Option<u64>,
    /// Instruction set used, if the method has a choice.
    pub instruction_set: Option<Value>,
    /// Number of threads used.
    pub threads: usize,
    /// Choices that the scene left open, with the reasons.
    pub choices: Vec<String>,
    /// Features of the scene left out as unnecessary, with the reasons.
    pub left_out: Vec<String>,
    /// All warnings.
    pub warnings: Vec<String>,
    /// Warnings at the end, with numbers.
    pub checks: Vec<RunWarning>,
    /// Forecast of the step, by name.
    pub foreseen: Map<String, Value>,
    /// Unusual findings over the run's sessions: another version of the program, an older checkpoint and the like; set when it is written.
    pub notes: Vec<String>,
    /// Failure of the physics that stopped the run, if any.
    #[serde(serialize_with = "PhysicsFailure::in_json")]
    pub failure: Option<PhysicsFailure>,
    /// Mean of each quantity with its error.
    pub averages: RunAverages,
    /// Structure functions.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub structure: Vec<StructureSummary>,
    /// Number of steps done.
    pub steps: u64,
    /// Simulated time.
    pub time: f64,
    /// Number of events so far; 0 if the method has none.
    pub events: u64,
    /// Wall time of this session, output included (s).
    pub seconds: f64,
    /// Wall time of this session in each phase (s).
    pub phases: BTreeMap<&'static str, f64>,
    /// Data of the method.
    #[serde(flatten)]
    pub method: Map<String, Value>,
    /// Moment at which this session started.
    #[serde(skip)]
    pub from: Clock,
    /// Last state, in a line.
    #[serde(skip)]
    pub in_words: String,
}

impl Summary {
    pub(super) fn of(
        RunJob { prepared, program, .. }: &RunJob<'_>,
        simulation: &dyn Simulation,
        averages: RunAverages,
        from: Clock,
        seconds: f64,
        failure: Option<&PhysicsFailure>,
    ) -> Summary {
        let clock = simulation.clock();
        let mut warnings: Vec<String> = prepared.warnings.iter().map(ToString::to_string).collect();
        let checks = simulation.warnings();
        warnings.extend(checks.iter().map(|check| check.message.clone()));
        Summary {
            origin: Origin::clone(program),
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
            foreseen: forecast::as_data(forecast::step_forecast(prepared)),
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
