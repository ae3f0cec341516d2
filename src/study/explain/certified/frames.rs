//! Frames of judged plans.

use super::grid::RelativeCosts;
use super::scenes::SceneClass;
use super::verdict::{MissCause, PlanVerdict};
use super::{CarriedPlan, JudgedPlan, TestedPlans};
use crate::frame::{FrameBuilder, ResultFrame, TableCell};
use crate::results::FinishedItem;
use crate::statistics::{quantile, wilson};

/// Largest factor between predicted and actual time that counts as correct.
const TIME: f64 = 1.5;
/// Names of the baselines that plans are compared with, in order.
const BASELINES: [&str; 3] = ["the scene's own values", "always lists", "f64 at the limit of stability"];
/// Number of points of a curve, and the largest error drawn (in parts of the target error).
const PARTS: (u32, f64) = (40, 2.0);

/// Returns the frames of judged plans.
pub(crate) fn made(certified: &TestedPlans) -> FinishedItem {
    let plans = &certified.plans;
    let frames =
        [within(plans), table(plans), costs(plans), errors(plans), cost_curves(plans), summary(certified)];
    FinishedItem::of(frames).with_seeds([1, 1001, 11001, 21001])
}

impl JudgedPlan {
    fn carried(&self) -> Option<&CarriedPlan> {
        self.outcome.as_ref().ok()
    }

    /// The verdict, if it is decided.
    fn decided(&self) -> Option<&PlanVerdict> {
        self.carried()?.verdict.as_ref().filter(|verdict| verdict.is_decided)
    }

    /// Returns the outcome in one word.
    fn outcome_word(&self) -> &'static str {
        match (&self.outcome, self.decided()) {
            (Err(_), _) => "refused",
            (Ok(_), None) => "undecided",
            (Ok(_), Some(_)) => "judged",
        }
    }
}

/// Judged plans of one class, or of all.
struct PlanGroup<'j> {
    name: &'static str,
    plans: Vec<&'j JudgedPlan>,
}

impl PlanGroup<'_> {
    fn plans_that(&self, fate: &str) -> usize {
        self.plans.iter().filter(|it| it.outcome_word() == fate).count()
    }

    fn runs(&self, count: impl Fn(&PlanVerdict) -> usize) -> usize {
        self.plans.iter().filter_map(|it| it.decided()).map(count).sum()
    }

    /// Share of the runs within the error, with its interval; none without runs.
    fn share(&self) -> Option<[f64; 3]> {
        let runs = self.runs(|it| it.runs);
        let within = self.runs(|it| it.within);
        let [lowest, highest] = wilson(within, runs);
        (runs > 0).then(|| [within as f64 / runs as f64, lowest, highest])
    }
}

/// Runs within the error, and causes of misses, for each class and for all.
fn within(plans: &[JudgedPlan]) -> ResultFrame {
    let all = PlanGroup { name: "all", plans: plans.iter().collect() };
    let of_class = |class: SceneClass| PlanGroup {
        name: class.name(),
        plans: plans.iter().filter(|it| it.class == class).collect(),
    };
    let classes = SceneClass::ALL.into_iter().map(of_class).filter(|of| !of.plans.is_empty());
    let part = |at: usize| move |of: &PlanGroup<'_>| Some(of.share()?[at]);
    FrameBuilder::of(classes.chain([all]))
        .text("class", |of| of.name)
        .count("plans asked for", |of| of.plans.len())
        .count("refused", |of| of.plans_that("refused"))
        .count("undecided", |of| of.plans_that("undecided"))
        .count("runs", |of| of.runs(|it| it.runs))
        .count("within the error", |of| of.runs(|it| it.within))
        .number("share within", 3, part(0))
        .number("lower end (95 %)", 3, part(1))
        .number("upper end (95 %)", 3, part(2))
        .count("missed by bias", |of| of.runs(|it| it.missed_by(MissCause::Bias)))
        .count("missed by statistics", |of| of.runs(|it| it.missed_by(MissCause::Statistics)))
        .count("broken", |of| of.runs(|it| it.broken))
        .frame("within", "Runs within the target error")
}

/// Reason why a plan was refused or is undecided; otherwise the cause of its misses.
fn because(it: &JudgedPlan) -> String {
    match (&it.outcome, it.decided()) {
        (Err(why), _) => why.clone(),
        (Ok(CarriedPlan { reference: Err(why), .. }), _) => format!("no reference: {why}"),
        (Ok(_), None) => "the error bar of the reference exceeds a third of the error".to_owned(),
        (Ok(_), Some(verdict)) if verdict.within + verdict.broken < verdict.runs => {
            verdict.cause.word().to_owned()
        }
        _ => String::new(),
    }
}

fn count(of: Option<usize>) -> TableCell {
    of.map_or(TableCell::Nothing, |of| TableCell::Count(of as u64))
}

fn table(plans: &[JudgedPlan]) -> ResultFrame {
    let verdict = |it: &&JudgedPlan| it.carried().and_then(|it| it.verdict.clone());
    let reference = |it: &&JudgedPlan| it.carried().and_then(|it| it.reference.as_ref().ok().copied());
    let seconds =
        |at: usize| move |it: &&JudgedPlan| it.carried().map(|it| it.seconds[at]).filter(|it| it.is_finite());
    FrameBuilder::of(plans)
        .text("class", |it| it.class.name())
        .text("scene", |it| it.scene.clone())
        .text("quantity", |it| it.quantity)
        .text("asked", |it| it.asked)
        .text("outcome", |it| it.outcome_word())
        .text("because", |it| because(it))
        .cell("runs", |it| count(it.decided().map(|it| it.runs)))
        .cell("within", |it| count(it.decided().map(|it| it.within)))
        .number("bias over the error", 2, move |it| Some(verdict(it)?.bias.value))
        .number("± (95 %)", 2, move |it| Some(verdict(it)?.bias.bar))
        .number("scatter over the error", 2, move |it| verdict(it)?.scatter)
        .short("error", |it| Some(it.carried()?.error))
        .short("reference", move |it| Some(reference(it)?.known.mean))
        .short("± (95 %) of the reference", move |it| Some(reference(it)?.known.bar))
        .short("step of the reference", move |it| reference(it)?.step)
        .short("foreseen (s)", seconds(0))
        .short("taken (s)", seconds(1))
        .number("trials (s)", 1, |it| it.trials)
        .text("plan", |it| it.carried().map_or(String::new(), |it| it.plan.clone()))
        .frame("plans", "Plans that were carried out")
}

/// A plan with its costs relative to the best of a grid.
type ComparedPlan<'j> = (&'j JudgedPlan, &'j CarriedPlan, &'j RelativeCosts);

fn compared(plans: &[JudgedPlan]) -> Vec<ComparedPlan<'_>> {
    let of = |it| {
        let carried = JudgedPlan::carried(it)?;
        Some((it, carried, carried.costs.as_ref()?))
    };
    plans.iter().filter_map(of).collect()
}

fn costs(plans: &[JudgedPlan]) -> ResultFrame {
    let baseline = |at: usize| move |(.., costs): &ComparedPlan<'_>| costs.baselines[at];
    FrameBuilder::of(compared(plans))
        .text("scene", |(it, ..)| it.scene.clone())
        .text("class", |(it, ..)| it.class.name())
        .text("quantity", |(it, ..)| it.quantity)
        .text("asked", |(it, ..)| it.asked)
        .number("plan", 2, |(.., costs)| costs.plan)
        .number("its configuration and step alone", 2, |(.., costs)| costs.choice)
        .number(BASELINES[0], 2, baseline(0))
        .number(BASELINES[1], 2, baseline(1))
        .number(BASELINES[2], 2, baseline(2))
        .number("plan over the scene's own values", 2, |(.., costs)| Some(costs.plan / costs.baselines[0]?))
        .short("best (s)", |(.., costs)| costs.seconds)
        .text("the best", |(.., costs)| costs.best.clone())
        .text("the plan", |(_, carried, _)| carried.plan.clone())
        .frame("costs", "Wall time over that of the best of the grid, for the same error")
}

/// Share of runs whose error is at most a given part of the target.
fn errors(plans: &[JudgedPlan]) -> ResultFrame {
    let of_class = |class: SceneClass| {
        let decided = plans.iter().filter(|it| it.class == class).filter_map(JudgedPlan::decided);
        let mut all: Vec<f64> = decided.flat_map(|it| it.errors.iter().copied()).collect();
        all.sort_by(f64::total_cmp);
        let (steps, last) = PARTS;
        let point = move |step: u32| {
            let part = last * f64::from(step) / f64::from(steps);
            let below = all.partition_point(|error| *error <= part);
            (class.name(), part, 100.0 * below as f64 / all.len() as f64)
        };
        (0..=steps).map(point).filter(|(.., share)| share.is_finite()).collect::<Vec<_>>()
    };
    FrameBuilder::of(SceneClass::ALL.into_iter().flat_map(of_class))
        .text("class", |(class, ..)| *class)
        .number("error over the one asked for", 3, |(_, part, _)| *part)
        .number("runs with at most that (%)", 2, |(.., share)| *share)
        .frame("errors", "Errors of runs relative to the target error")
}

/// Returns the share of plans over their largest cost relative to the best. A curve ends below 100 % where some plans do not reach the error.
fn cost_curves(plans: &[JudgedPlan]) -> ResultFrame {
    let compared = compared(plans);
    let curve = |name: &'static str, of: &dyn Fn(&RelativeCosts) -> Option<f64>| {
        let mut ratios: Vec<f64> = compared.iter().filter_map(|(.., costs)| of(costs)).collect();
        ratios.sort_by(f64::total_cmp);
        let points = ratios.into_iter().zip(1_u32..);
        let all = compared.len() as f64;
        points.map(|(ratio, count)| (name, ratio, 100.0 * f64::from(count) / all)).collect::<Vec<_>>()
    };
    let plans = curve("plans", &|it| Some(it.plan));
    let baselines = BASELINES.iter().enumerate().map(|(at, name)| curve(name, &move |it| it.baselines[at]));
    FrameBuilder::of(std::iter::once(plans).chain(baselines).flatten())
        .text("configuration", |(name, ..)| *name)
        .number("wall time over that of the best", 3, |(_, ratio, _)| *ratio)
        .number("plans that cost at most that (%)", 1, |(.., share)| *share)
        .frame("cost-curves", "Plans by wall time over the best")
}

fn summary(certified: &TestedPlans) -> ResultFrame {
    let (plans, effort) = (&certified.plans, certified.effort);
    let times: Vec<[f64; 2]> = plans.iter().filter_map(|it| Some(it.carried()?.seconds)).collect();
    let timely = times.iter().filter(|[foreseen, taken]| (taken / foreseen).max(foreseen / taken) <= TIME);
    let timely = timely.count();
    let mut costs: Vec<f64> = compared(plans).iter().map(|(.., costs)| costs.plan).collect();
    costs.sort_by(f64::total_cmp);
    FrameBuilder::of([()])
        .count("plans", |()| plans.len())
        .count("carried out", |()| times.len())
        .count("within the time foreseen", |()| timely)
        .number("share within the time foreseen", 3, |()| timely as f64 / times.len() as f64)
        .number("median cost over the best", 3, |()| quantile(&costs, 0.5))
        .count("runs of a plan", |()| effort.estimates)
        .number("trials of a plan (s)", 1, |()| effort.trials[0])
        .number("longer trials (s)", 1, |()| effort.trials[1])
        .number("most that a plan may take (s)", 1, |()| effort.limit)
        .number("most that a reference takes (s)", 1, |()| effort.reference)
        .number("grid (s)", 1, |()| effort.grid)
        .frame("summary", "Plans in numbers")
}
