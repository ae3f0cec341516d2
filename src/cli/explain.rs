//! `stripmine explain`: which way to run a scene, which step and how long, for an error that can be borne.

use crate::console::{Common, Failure, clear_progress, print, print_json, say};
use crate::report::{Cell, Rows, terminal};
use crate::study::explain::{
    ExplainError, Kept, Plan, SECONDS, Sample, Span, Target, explain, page, sample, with_unit,
};
use crate::study::{Case, StudyError};
use clap::Args;
use serde::Serialize;
use std::path::{Path, PathBuf};
use stripmine_physics::averages::Outcome;
use stripmine_physics::memory::peak;
use stripmine_physics::method::{Methods, load};
use stripmine_physics::number::significant;
use stripmine_physics::quoted;
use stripmine_physics::scene::Width;
use stripmine_physics::signals;

/// Which integrator, step, precision, search, run length and seeds a scene needs for an error you can bear, and what that costs
#[derive(Args)]
pub(super) struct ExplainVerb {
    /// A preset's name, or a scene file
    #[arg(required_unless_present = "forget")]
    scene: Option<String>,
    /// Overrides a value; may be given several times
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE")]
    overrides: Vec<String>,
    /// The error of the mean that can be borne with a probability of 95 %, such as 1% or 0.02; without it, that of the scene's own values
    #[arg(long, value_parser = width)]
    error: Option<Width>,
    /// The quantity whose mean it is; what the method is mostly asked for by default
    #[arg(long = "of", value_name = "QUANTITY")]
    quantity: Option<String>,
    /// Wall seconds that the run may take: the plan of the least error that can be had in them
    #[arg(long = "time", value_name = "SECONDS", conflicts_with = "error", value_parser = above_zero)]
    within: Option<f64>,
    /// Runs nothing: by what is kept of the scene
    #[arg(long, conflicts_with = "patient")]
    estimate: bool,
    /// Trials of a minute in the place of some seconds
    #[arg(long)]
    patient: bool,
    /// Seconds of trials
    #[arg(long, conflicts_with_all = ["estimate", "patient"], value_parser = clap::value_parser!(u16).range(1..=3600))]
    seconds: Option<u16>,
    /// Carries out the plan, and prints what was expected beside what came out
    #[arg(long)]
    analyze: bool,
    /// Writes the plan as a scene file
    #[arg(long, value_name = "FILE")]
    write: Option<PathBuf>,
    /// Removes what is kept of scenes on this host
    #[arg(long)]
    forget: bool,
}

fn above_zero(text: &str) -> Result<f64, String> {
    let is_time = |seconds: &f64| seconds.is_finite() && *seconds > 0.0;
    text.parse().ok().filter(is_time).ok_or_else(|| "a time is a number of seconds above 0".to_owned())
}

/// Bytes.
const MEGABYTE: f64 = 1e6;
/// Trials may take so much more memory than a run: several ways are prepared one after the other (bytes).
const MORE: f64 = 16e6;

fn width(text: &str) -> Result<Width, String> {
    Width::parse(text).ok_or_else(|| "an error is a number above 0, or a part such as 1%".to_owned())
}

/// A row of what was expected and came out.
#[derive(Clone, Debug, Serialize)]
struct Compared {
    what: String,
    estimated: f64,
    actual: f64,
    unit: String,
    /// Whether it lies within what was expected.
    is_within: bool,
    /// What to measure again, where it does not.
    advice: &'static str,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Said {
    #[serde(flatten)]
    plan: Plan,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    analyzed: Vec<Compared>,
}

impl ExplainVerb {
    pub(super) fn run(&self, common: &Common, methods: Methods) -> Result<(), Failure> {
        let kept = Kept::here();
        if self.forget {
            let count = kept.forget().map_err(failed)?;
            print(&format!("removed: {count}\n"))?;
        }
        let Some(scene) = &self.scene else { return Ok(()) };
        let case = Case::load(scene, &self.overrides, methods)?;
        let target = Target::of(&case, self.quantity.as_deref(), self.error).map_err(failed)?;
        let target = Target { within: self.within, ..target };
        let seconds = match (self.estimate, self.patient) {
            (true, _) => 0.0,
            (_, true) => SECONDS[1],
            _ => self.seconds.map_or(SECONDS[0], f64::from),
        };
        if !common.quiet && seconds > 0.0 {
            say(format_args!("trials of about {seconds} s, unless they are kept"));
        }
        let plan = explain(&case, &target, seconds, &kept, signals::asked()).map_err(failed)?;
        clear_progress();
        if let Some(file) = &self.write {
            self.written(&plan, file, scene, methods)?;
            if !common.quiet {
                say(format_args!("written: {}", quoted::path(file)));
            }
        }
        let analyzed = if self.analyze { self.analyzed(&plan, &target, scene, methods)? } else { vec![] };
        if common.json {
            return print_json(&Said { plan, analyzed });
        }
        print(&page(&plan))?;
        if analyzed.is_empty() { Ok(()) } else { print(&table(&analyzed)) }
    }

    /// The overrides of the plan.
    fn overrides(&self, plan: &Plan) -> Vec<String> {
        [&self.overrides[..], &plan.overrides].concat()
    }

    fn written(&self, plan: &Plan, file: &Path, scene: &str, methods: Methods) -> Result<(), Failure> {
        let (prepared, _) = load(scene, &self.overrides(plan), methods)?;
        let seeds = if plan.seeds > 1 { format!(" --seeds {}", plan.seeds) } else { String::new() };
        let text = format!(
            "# By stripmine explain, for {}: run it with{} stripmine run FILE{seeds}\n{}",
            plan.quantity,
            if seeds.is_empty() { "" } else { " its seeds:" },
            prepared.scene
        );
        std::fs::write(file, text).map_err(Failure::writing("the plan"))
    }

    /// Carries out one run of the plan.
    fn analyzed(
        &self,
        plan: &Plan,
        target: &Target,
        scene: &str,
        methods: Methods,
    ) -> Result<Vec<Compared>, Failure> {
        let (prepared, entry) = load(scene, &self.overrides(plan), methods)?;
        let observed = (entry.quantities, target.place);
        let found: Sample = sample(&prepared, observed, Span::Time(plan.time, None), signals::asked())
            .map_err(Failure::from)?;
        let seeds = plan.seeds as f64;
        let known = if plan.is_whole { None } else { found.known() };
        let mut rows = vec![Compared {
            what: "wall time of a run".to_owned(),
            estimated: plan.seconds.likely,
            actual: found.seconds,
            unit: "s".to_owned(),
            is_within: (plan.seconds.least..=plan.seconds.most).contains(&found.seconds),
            advice: "the host was busier or idler than in the trials: --patient",
        }];
        if let Outcome::Kept { farthest, .. } = found.outcome {
            rows.push(Compared {
                what: format!("{}, at its farthest", plan.quantity),
                estimated: plan.expected.most,
                actual: farthest,
                unit: plan.unit.to_owned(),
                is_within: farthest <= plan.error.unwrap_or(f64::INFINITY),
                advice: "two steps did not tell the law: --patient",
            });
        }
        for (name, estimated) in &plan.phases {
            let actual =
                found.phases.iter().find(|(phase, _)| phase == name).map(|(_, cost)| cost * found.time);
            let Some(actual) = actual else { continue };
            rows.push(Compared {
                what: format!("of it: {name}"),
                estimated: *estimated,
                actual,
                unit: "s".to_owned(),
                // What takes next to nothing is not foreseen as a part of itself.
                is_within: (actual - estimated).abs() <= 0.5 * estimated + 0.02 * found.seconds,
                advice: "the phases of another step or start: --patient",
            });
        }
        rows.extend(peak().map(|peak| Compared {
            what: "memory, of trials too".to_owned(),
            estimated: plan.memory as f64 / MEGABYTE,
            actual: peak as f64 / MEGABYTE,
            unit: "MB".to_owned(),
            is_within: peak as f64 <= plan.memory as f64 + MORE,
            advice: "trials took more than a run: see scene check for that of a run",
        }));
        if let (true, Some([mean, bar])) = (plan.is_whole, plan.mean) {
            let chance = plan.expected.chance * seeds.sqrt();
            rows.push(Compared {
                what: format!("{} over the whole run, less that of the reference", plan.quantity),
                estimated: 0.0,
                actual: found.whole_mean() - mean,
                unit: plan.unit.to_owned(),
                is_within: (found.whole_mean() - mean).abs() <= plan.expected.bias.with(chance.hypot(bar)),
                advice: "the step or the digits take it off: --patient",
            });
        }
        if let (Some(known), Some([mean, bar])) = (known, plan.mean) {
            let chance = plan.expected.chance * seeds.sqrt();
            rows.push(Compared {
                what: format!("chance of {} in a run (95 %)", plan.quantity),
                estimated: chance,
                actual: known.bar,
                unit: plan.unit.to_owned(),
                is_within: known.bar <= 1.5 * chance,
                advice: "the scatter was hardly known: --patient",
            });
            let allowed = plan.expected.bias.with(known.bar.hypot(bar));
            rows.push(Compared {
                what: format!("{} less that of the reference", plan.quantity),
                estimated: 0.0,
                actual: known.mean - mean,
                unit: plan.unit.to_owned(),
                is_within: (known.mean - mean).abs() <= allowed,
                advice: "the step or the digits take it off: --patient",
            });
        }
        Ok(rows)
    }
}

fn table(rows: &[Compared]) -> String {
    let number =
        |of: fn(&Compared) -> f64| move |it: &&Compared| with_unit(&significant(of(it), 3), &it.unit);
    let table = Rows::of(rows)
        .text("what", |it| it.what.clone())
        .text("estimated", number(|it| it.estimated))
        .text("actual", number(|it| it.actual))
        .cell("ratio", |it| {
            if it.estimated == 0.0 { Cell::Nothing } else { Cell::Number(it.actual / it.estimated, 2) }
        })
        .text("remark", |it| {
            if it.is_within { String::new() } else { format!("outside of what was expected: {}", it.advice) }
        })
        .table("analyzed", "Expected and come out");
    terminal::render(&table)
}

fn failed(error: impl Into<ExplainError>) -> Failure {
    StudyError::Own(Box::new(error.into())).into()
}
