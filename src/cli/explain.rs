//! `stripmine explain`: finds the cheapest configuration, step and run length for a target error.

use super::display::decimals;
use crate::console::{
    CommandFailure, Common, clear_progress, print, print_json, print_message, print_text, warn,
};
use crate::report::{FrameBuilder, TableCell, terminal};
use crate::study::explain::{
    ExplainError, LIMIT, PlanCache, PlanCacheError, PlanTarget, RunPlan, SECONDS, explain, page, seconds,
    with_unit,
};
use crate::study::trial::{SampleSpan, Stopwatch, TrialControl, TrialSample};
use crate::study::{StudyCase, StudyError};
use clap::Args;
use serde::Serialize;
use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use stripmine_physics::io::replace::{check_folder_writable, check_may_write, write_atomically_new};
use stripmine_physics::memory::peak;
use stripmine_physics::method::Methods;
use stripmine_physics::number::{count_with_noun, significant};
use stripmine_physics::quoted;
use stripmine_physics::reported::{ErrorClass, Reported};
use stripmine_physics::scene::Width;
use stripmine_physics::signals;

/// Finds the cheapest configuration that reaches a target error
///
/// The plan names integrator, step, precision, search, run length and seeds, with the cost and the reason of each.
#[derive(Args)]
pub(super) struct ExplainVerb {
    /// Preset name or scene file
    #[arg(required_unless_present = "forget")]
    scene: Option<String>,
    /// Overrides a value; can be repeated
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE")]
    overrides: Vec<String>,
    /// Target error of the mean (95 % confidence), such as 1% or 0.02; default: the error of the scene as it is
    #[arg(long, value_parser = parse_target_error)]
    error: Option<Width>,
    /// Quantity to average; default: the main quantity of the method
    #[arg(long = "of", value_name = "QUANTITY")]
    quantity: Option<String>,
    /// Finds the least error within this wall time instead
    #[arg(long = "time", value_name = "SECONDS", conflicts_with = "error", value_parser = above_zero)]
    within: Option<f64>,
    /// Rejects plans with a longer wall time; default: one hour
    #[arg(long, value_name = "SECONDS", conflicts_with = "within", value_parser = above_zero)]
    limit: Option<f64>,
    /// Averages each run between two times instead of over its steady state
    #[arg(long, num_args = 2, value_names = ["FROM", "TO"])]
    window: Option<Vec<f64>>,
    /// Runs no trials; uses only cached measurements
    #[arg(long, conflicts_with = "patient")]
    estimate: bool,
    /// Runs trials for up to a minute instead of ten seconds
    #[arg(long)]
    patient: bool,
    /// Limit of all trials in seconds
    #[arg(long, conflicts_with_all = ["estimate", "patient"], value_parser = clap::value_parser!(u16).range(1..=3600))]
    seconds: Option<u16>,
    /// Executes one run of the plan and compares it with the estimates; asks first if it takes more than a minute
    #[arg(long)]
    analyze: bool,
    /// Executes plans of more than a minute without asking
    #[arg(long, requires = "analyze")]
    yes: bool,
    /// Writes the plan as a scene file
    #[arg(long, value_name = "FILE")]
    write: Option<PathBuf>,
    /// Overwrites an existing file
    #[arg(long, requires = "write")]
    overwrite: bool,
    /// Removes the cached measurements of all scenes on this host
    #[arg(long)]
    forget: bool,
}

/// The plan was not executed, because it takes this long (s) and `--yes` was not given.
#[derive(Debug, thiserror::Error)]
#[error("the plan was not executed: one run takes about {}\n  help: add --yes to execute it", seconds(*.0))]
struct LongRun(f64);

impl Reported for LongRun {
    fn class(&self) -> ErrorClass {
        ErrorClass::Usage
    }
}

/// Longest plan that is executed without confirmation (s).
const LONG: f64 = 60.0;

fn above_zero(text: &str) -> Result<f64, String> {
    let is_time = |seconds: &f64| seconds.is_finite() && *seconds > 0.0;
    text.parse().ok().filter(is_time).ok_or_else(|| "expected a number of seconds above 0".to_owned())
}

/// Relative difference that is no more than rounding.
const ROUNDING: f64 = 1e-9;
/// Megabyte (bytes).
const MEGABYTE: f64 = 1e6;
/// Memory that trials may take beyond a run, since several configurations are prepared one after the other (bytes).
const MORE: f64 = 16e6;

pub(super) fn parse_target_error(text: &str) -> Result<Width, String> {
    Width::parse(text).ok_or_else(|| "expected a number above 0, or a percentage such as 1%".to_owned())
}

/// Estimate of the plan compared with the run.
#[derive(Clone, Debug, Serialize)]
struct EstimateCheck {
    what: String,
    estimated: f64,
    actual: f64,
    unit: String,
    /// True if the actual value is within the expected range.
    is_within: bool,
    /// Likely reason of a difference, and what to do.
    advice: &'static str,
}

/// Document of `--json`.
#[derive(Serialize)]
struct PlanDocument {
    #[serde(flatten)]
    plan: RunPlan,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    analyzed: Vec<EstimateCheck>,
    /// Reason for which the executed run ended early.
    #[serde(skip_serializing_if = "Option::is_none")]
    cut_off: Option<String>,
}

/// Result of executing a plan.
#[derive(Default)]
struct Analysis {
    rows: Vec<EstimateCheck>,
    cut_off: Option<String>,
}

impl ExplainVerb {
    pub(super) fn run(&self, common: &Common, methods: Methods) -> Result<(), CommandFailure> {
        let kept = PlanCache::here();
        if self.forget {
            let count = kept.forget().map_err(plan_failure)?;
            print(&format!(
                "removed {}\n",
                count_with_noun(count, "cached measurement", "cached measurements")
            ))?;
        }
        let Some(scene) = &self.scene else { return Ok(()) };
        // Checked before any trial runs.
        self.check_writable()?;
        let case = StudyCase::load(scene, &self.overrides, methods)?;
        let target = PlanTarget::of(&case, self.quantity.as_deref(), self.error).map_err(plan_failure)?;
        let target = PlanTarget { within: self.within, limit: self.limit.unwrap_or(LIMIT), ..target };
        let target = target.over(self.window.as_deref()).map_err(plan_failure)?;
        let seconds = match (self.estimate, self.patient) {
            (true, _) => 0.0,
            (_, true) => SECONDS[1],
            _ => self.seconds.map_or(SECONDS[0], f64::from),
        };
        if !common.quiet && seconds > 0.0 {
            print_message(format_args!("running trials for up to {seconds} s (cached trials are reused)"));
        }
        let notice = |error: &PlanCacheError| {
            if !common.quiet {
                warn(format_args!("trials are not cached: {error}"));
            }
        };
        let trial = TrialControl { watch: &Stopwatch::wall(), stop: signals::interruption_flag() };
        let plan = explain(&case, &target, seconds, &kept, trial, &notice).map_err(plan_failure)?;
        clear_progress();
        if !common.json {
            print_text(&page(&plan))?;
        }
        let written = self.write.as_ref().map_or(Ok(()), |file| self.write_plan(&plan, file, &case));
        if let (Some(file), Ok(()), false) = (&self.write, &written, common.quiet) {
            print_message(format_args!("written: {}", quoted::path(file)));
        }
        let (analysis, refused) = match self.analyze.then(|| self.confirm_analysis(&plan)) {
            None => (Analysis::default(), Ok(())),
            Some(Err(refusal)) => (Analysis::default(), Err(refusal)),
            Some(Ok(())) => (Self::analyze_plan(&plan, &target, &case)?, Ok(())),
        };
        let Analysis { rows, cut_off } = analysis;
        if common.json {
            print_json(&PlanDocument { plan, analyzed: rows, cut_off })?;
        } else if !rows.is_empty() {
            print(&analysis_table(&rows, cut_off.as_ref()))?;
        }
        if signals::interruption_flag().load(Ordering::SeqCst) {
            return Err(CommandFailure::Stopped(signals::ProcessEnd::Whole));
        }
        written.and(refused.map_err(CommandFailure::from))
    }

    /// Checks that the plan can be written to the file of `--write`.
    fn check_writable(&self) -> Result<(), CommandFailure> {
        let Some(file) = &self.write else { return Ok(()) };
        check_may_write(file, self.overwrite, "choose another --write, or add --overwrite to lose it")?;
        check_folder_writable(file).map_err(CommandFailure::writing(file.display().to_string()))
    }

    /// Checks that the plan may be executed; asks the user if it takes long.
    fn confirm_analysis(&self, plan: &RunPlan) -> Result<(), LongRun> {
        let likely = plan.seconds.likely;
        if likely <= LONG || self.yes {
            return Ok(());
        }
        let refusal = || Err(LongRun(likely));
        if !io::stdin().is_terminal() || !io::stderr().is_terminal() {
            return refusal();
        }
        let mut answer = String::new();
        #[expect(clippy::let_underscore_must_use, reason = "without a terminal the answer is no")]
        let _ =
            write!(io::stderr(), "one run of the plan takes about {}: execute it? [y/N] ", seconds(likely));
        #[expect(clippy::let_underscore_must_use, reason = "without an answer the answer is no")]
        let _ = io::stdin().read_line(&mut answer);
        if matches!(answer.trim(), "y" | "Y" | "yes") { Ok(()) } else { refusal() }
    }

    /// Writes the plan as a scene file; on failure the old file stays.
    fn write_plan(&self, plan: &RunPlan, file: &Path, case: &StudyCase) -> Result<(), CommandFailure> {
        let prepared = case.prepared_with(&plan.overrides)?;
        let seeds = if plan.seeds > 1 { format!(" --seeds {}", plan.seeds) } else { String::new() };
        let text = format!(
            "# Plan by stripmine explain for {}. Run it{}: stripmine run FILE{seeds}\n{}",
            plan.quantity,
            if seeds.is_empty() { "" } else { " with its seeds" },
            prepared.scene
        );
        write_atomically_new(file, &text, self.overwrite)
            .map_err(CommandFailure::writing(file.display().to_string()))
    }

    /// Executes one run of the plan and compares it with the estimates.
    fn analyze_plan(
        plan: &RunPlan,
        target: &PlanTarget,
        case: &StudyCase,
    ) -> Result<Analysis, CommandFailure> {
        let prepared = case.prepared_with(&plan.overrides)?;
        let observed = (case.quantities(), target.place);
        // An interrupted run ends early and is reported as such.
        let held = signals::hold();
        let trial = TrialControl { watch: &Stopwatch::wall(), stop: signals::interruption_flag() };
        let found: TrialSample = trial
            .sample(&prepared, observed, SampleSpan::Planned(plan.time, None))
            .map_err(CommandFailure::from)?;
        drop(held);
        if found.early_end(plan.time).is_some() {
            let cut_off = interruption([found.time, plan.time], found.seconds);
            let wall = EstimateCheck {
                what: "wall time of a run".to_owned(),
                estimated: plan.seconds.likely,
                actual: found.seconds,
                unit: "s".to_owned(),
                is_within: false,
                advice: "the run was interrupted",
            };
            return Ok(Analysis { rows: vec![wall], cut_off: Some(cut_off) });
        }
        let window = target.window.unwrap_or([0.0, f64::INFINITY]);
        let seeds = plan.seeds as f64;
        let known = if plan.is_whole { None } else { found.known() };
        let mut rows = vec![EstimateCheck {
            what: "wall time of a run".to_owned(),
            estimated: plan.seconds.likely,
            actual: found.seconds,
            unit: "s".to_owned(),
            is_within: (plan.seconds.least..=plan.seconds.most).contains(&found.seconds),
            advice: "the load of the host has changed since the trials: use --patient",
        }];
        if let Some([_, largest]) = found.deviations() {
            let most = plan.error.unwrap_or(f64::INFINITY).min(plan.expected.most * (1.0 + ROUNDING));
            rows.push(EstimateCheck {
                what: format!("largest {}", plan.quantity),
                estimated: plan.expected.most,
                actual: largest,
                unit: plan.unit.to_owned(),
                is_within: largest <= most,
                advice: "the start of the run is not among those of the trials: use --patient",
            });
        }
        for (name, estimated) in &plan.phases {
            let actual =
                found.phases.iter().find(|(phase, _)| phase == name).map(|(_, cost)| cost * found.time);
            let Some(actual) = actual else { continue };
            rows.push(EstimateCheck {
                what: format!("of it: {name}"),
                estimated: *estimated,
                actual,
                unit: "s".to_owned(),
                // Phases that take almost no time have no useful relative error.
                is_within: (actual - estimated).abs() <= 0.5 * estimated + 0.02 * found.seconds,
                advice: "phases were measured at another step or start: use --patient",
            });
        }
        rows.extend(peak().map(|peak| EstimateCheck {
            what: "memory, trials included".to_owned(),
            estimated: plan.memory as f64 / MEGABYTE,
            actual: peak as f64 / MEGABYTE,
            unit: "MB".to_owned(),
            is_within: peak as f64 <= plan.memory as f64 + MORE,
            advice: "trials need more than a run: see `scene check` for a run",
        }));
        if let (true, Some([mean, bar])) = (plan.is_whole, plan.mean) {
            let chance = plan.expected.chance * seeds.sqrt();
            rows.push(EstimateCheck {
                what: format!("mean {} over the run, minus reference", plan.quantity),
                estimated: 0.0,
                actual: found.mean_over(window) - mean,
                unit: plan.unit.to_owned(),
                is_within: (found.mean_over(window) - mean).abs()
                    <= plan.expected.bias.with_statistical_error(chance.hypot(bar)),
                advice: "bias from the step or the precision: use --patient",
            });
        }
        if let (Some(known), Some([mean, bar])) = (known, plan.mean) {
            let chance = plan.expected.chance * seeds.sqrt();
            rows.push(EstimateCheck {
                what: format!("statistical error of {} in a run (95 %), at most", plan.quantity),
                estimated: chance,
                actual: known.bar,
                unit: plan.unit.to_owned(),
                is_within: known.bar <= chance,
                advice: "trials were too short to estimate the scatter: use --patient",
            });
            let allowed = plan.expected.bias.with_statistical_error(known.bar.hypot(bar));
            rows.push(EstimateCheck {
                what: format!("mean {}, minus reference", plan.quantity),
                estimated: 0.0,
                actual: known.mean - mean,
                unit: plan.unit.to_owned(),
                is_within: (known.mean - mean).abs() <= allowed,
                advice: "bias from the step or the precision: use --patient",
            });
        }
        Ok(Analysis { rows, cut_off: None })
    }
}

/// Describes a run that was interrupted at one of two times (time), the other being its end, after some wall seconds.
fn interruption([reached, end]: [f64; 2], seconds: f64) -> String {
    let [percent, spent] = [100.0 * reached / end, seconds].map(|it| significant(it, 2));
    format!("interrupted at {percent} %, after {spent} s")
}

fn analysis_table(rows: &[EstimateCheck], cut_off: Option<&String>) -> String {
    let number = |of: fn(&EstimateCheck) -> f64| {
        move |it: &&EstimateCheck| with_unit(&significant(of(it), 3), &it.unit)
    };
    let table = FrameBuilder::of(rows)
        .text("what", |it| it.what.clone())
        .text("estimated", number(|it| it.estimated))
        .text("actual", number(|it| it.actual))
        .cell("ratio", |it| {
            let ratio = it.actual / it.estimated;
            if it.estimated == 0.0 {
                TableCell::Nothing
            } else {
                TableCell::Number(ratio, decimals(ratio, 3))
            }
        })
        .text("remark", |it| match (cut_off, it.is_within) {
            (Some(cut_off), _) => (*cut_off).clone(),
            (None, true) => String::new(),
            (None, false) => format!("outside the expected range: {}", it.advice),
        })
        .table("analyzed", "Estimates of the plan, compared with the run");
    terminal::render(&table)
}

/// Failure of a plan; stopped trials end like any interrupted command.
pub(super) fn plan_failure(error: impl Into<ExplainError>) -> CommandFailure {
    match error.into() {
        ExplainError::Stopped => CommandFailure::Stopped(signals::ProcessEnd::Whole),
        error => StudyError::Own(Box::new(error)).into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without the end of a run its wall time says nothing about the host.
    #[test]
    fn interrupted_runs_are_reported_as_such() {
        let cut_off = interruption([0.5, 50.0], 3.21);
        assert_eq!(cut_off, "interrupted at 1 %, after 3.2 s");
        let check = |is_within| EstimateCheck {
            what: "wall time of a run".to_owned(),
            estimated: 300.0,
            actual: 3.21,
            unit: "s".to_owned(),
            is_within,
            advice: "the load of the host has changed since the trials: use --patient",
        };
        let table = analysis_table(&[check(false)], Some(&cut_off));
        assert!(table.contains("interrupted at 1 %") && !table.contains("host"), "{table}");
        assert!(analysis_table(&[check(false)], None).contains("outside the expected range"));
    }
}
