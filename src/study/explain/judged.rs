//! Plans, judged, as frames.

use super::recommended::{LeftOut, Need};
use super::regret::{Effort, Judged};
use crate::frame::{Cell, Frame, Rows};
use crate::results::Made;
use crate::statistics::quantile;

/// Factor within which time is to be foreseen.
const TIME: f64 = 1.5;
/// Configurations that plans are compared with, in the order of the baselines.
const BASELINES: [&str; 3] = ["always lists", "the scene's own values", "f64 at the limit of stability"];

/// The frames of judged plans.
pub fn made(judged: &[Judged], effort: Effort) -> Made {
    let frames = [
        table(judged),
        saved(judged),
        choices(judged),
        left_out(judged),
        curves(judged),
        summary(judged, effort),
    ];
    Made::of(frames).with_seeds([1, 1000])
}

fn summary(judged: &[Judged], effort: Effort) -> Frame {
    let times: Vec<[f64; 2]> = judged.iter().filter_map(|it| it.seconds).collect();
    let timely = times.iter().filter(|[foreseen, taken]| (taken / foreseen).max(foreseen / taken) <= TIME);
    let timely = timely.count();
    let mut regret: Vec<f64> = judged.iter().filter_map(|it| it.regret).collect();
    regret.sort_by(f64::total_cmp);
    Rows::of([()])
        .count("scenes", |()| judged.len())
        .count("scenes without a plan", |()| judged.len() - times.len())
        .count("plans within the time foreseen", |()| timely)
        .number("share within the time foreseen", 3, |()| timely as f64 / times.len() as f64)
        .number("median cost over the best", 3, |()| quantile(&regret, 0.5))
        .number("trials of a plan (s)", 1, |()| effort.plan)
        .number("trials of the best (s)", 1, |()| effort.best)
        .frame("summary", "Plans in numbers")
}

/// Share of scenes whose cost is at most so many times the best: the same scenes for every curve, those that have a plan to compare. A
/// curve that does not reach the error in some ends below 100 %.
fn curves(judged: &[Judged]) -> Frame {
    let compared: Vec<&Judged> = judged.iter().filter(|it| it.regret.is_some()).collect();
    let curve = |name: &'static str, of: &dyn Fn(&Judged) -> Option<f64>| {
        let mut ratios: Vec<f64> =
            compared.iter().filter_map(|it| of(it)).map(|ratio| ratio.max(0.1)).collect();
        ratios.sort_by(f64::total_cmp);
        let all = compared.len().max(1) as f64;
        let points = ratios.into_iter().zip(1_u32..);
        points.map(|(ratio, count)| (name, ratio, 100.0 * f64::from(count) / all)).collect::<Vec<_>>()
    };
    let plans = curve("plans", &|it: &Judged| it.regret);
    let baselines = BASELINES.iter().enumerate().map(|(at, name)| curve(name, &move |it| it.baselines[at]));
    Rows::of(std::iter::once(plans).chain(baselines).flatten())
        .text("configuration", |(name, ..)| *name)
        .number("wall time over that of the best", 3, |(_, ratio, _)| *ratio)
        .number("scenes that cost at most that (%)", 1, |(.., share)| *share)
        .frame("cost-curves", "Scenes by cost over the best")
}

fn table(judged: &[Judged]) -> Frame {
    let baseline = |at: usize| move |it: &&Judged| it.baselines[at].map_or(Cell::Nothing, Cell::Short);
    Rows::of(judged)
        .text("scene", |it| it.scene.clone())
        .text("quantity", |it| it.quantity)
        .cell("error asked", |it| if it.error.is_finite() { Cell::Short(it.error) } else { Cell::Nothing })
        .cell("off", |it| it.off.map_or(Cell::Nothing, |[off, _]| Cell::Short(off)))
        .cell("± (95 %) of the reference", |it| it.off.map_or(Cell::Nothing, |[_, bar]| Cell::Short(bar)))
        .text("reached", |it| match (it.seconds, it.is_met) {
            (None, _) => "",
            (_, true) => "yes",
            (_, false) => "no",
        })
        .cell("cost over the best", |it| it.regret.map_or(Cell::Nothing, |it| Cell::Number(it, 2)))
        .cell(BASELINES[0], baseline(0))
        .cell(BASELINES[1], baseline(1))
        .cell(BASELINES[2], baseline(2))
        .cell("foreseen (s)", |it| it.seconds.map_or(Cell::Nothing, |[foreseen, _]| Cell::Short(foreseen)))
        .cell("taken (s)", |it| it.seconds.map_or(Cell::Nothing, |[_, taken]| Cell::Short(taken)))
        .frame("plans", "Plans, carried out")
}

/// A feature that one scene may be modelled without.
struct Twin<'j> {
    judged: &'j Judged,
    twin: &'j LeftOut,
}

fn twins(judged: &[Judged]) -> Vec<Twin<'_>> {
    judged.iter().flat_map(|judged| judged.left_out.iter().map(move |twin| Twin { judged, twin })).collect()
}

/// Saving by each feature that may be left out, over all scenes that have it.
fn saved(judged: &[Judged]) -> Frame {
    let twins = twins(judged);
    let mut names: Vec<&str> = twins.iter().map(|it| it.twin.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    let of = |name: &str| -> Vec<&LeftOut> {
        twins.iter().map(|it| it.twin).filter(|it| it.name == name).collect()
    };
    let count = |name: &str, need: Need| of(name).iter().filter(|it| it.need == need).count() as f64;
    let saving = |name: &str| {
        let mut all: Vec<f64> = of(name).iter().filter_map(|it| Some(100.0 * (1.0 - it.cost?))).collect();
        all.sort_by(f64::total_cmp);
        quantile(&all, 0.5)
    };
    Rows::of(&names)
        .text("without", |name| (*name).to_owned())
        .cell("scenes", |name| Cell::Number(of(name).len() as f64, 0))
        .cell("not needed for the error", |name| Cell::Number(count(name, Need::No), 0))
        .cell("needed", |name| Cell::Number(count(name, Need::Yes), 0))
        .cell("saves, median (%)", |name| saving(name).map_or(Cell::Nothing, |it| Cell::Number(it, 0)))
        .frame("saved", "What scenes may be modelled without, and what that saves of the wall time")
}

/// Savings scene by scene.
fn left_out(judged: &[Judged]) -> Frame {
    let twins = twins(judged);
    Rows::of(&twins)
        .text("scene", |it| it.judged.scene.clone())
        .text("quantity", |it| it.judged.quantity)
        .cell("error asked", |it| {
            if it.judged.error.is_finite() { Cell::Short(it.judged.error) } else { Cell::Nothing }
        })
        .text("without", |it| it.twin.name.clone())
        .cell("wall time over that with it", |it| it.twin.cost.map_or(Cell::Nothing, Cell::Short))
        .cell("change of the mean", |it| {
            it.twin.change.map_or(Cell::Nothing, |[change, _]| Cell::Short(change))
        })
        .cell("± (95 %)", |it| it.twin.change.map_or(Cell::Nothing, |[_, bar]| Cell::Short(bar)))
        .text("needed", |it| it.twin.need.word())
        .frame("left-out", "What the scenes may be modelled without")
}

fn choices(judged: &[Judged]) -> Frame {
    Rows::of(judged)
        .text("scene", |it| it.scene.clone())
        .text("quantity", |it| it.quantity)
        .text("recommended", |it| it.recommended.clone())
        .text("the best", |it| it.best.clone())
        .text("no plan, for", |it| it.failed.clone().unwrap_or_default())
        .frame("choices", "What was recommended")
}
