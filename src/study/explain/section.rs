//! The page of plans, judged.

use super::recommended::{LeftOut, Need};
use super::regret::{Effort, Judged};
use crate::console::Failure;
use crate::report::figure::{Axis, Chart, Figure, Series, Style};
use crate::report::{Cell, Rows, Section, Table, Verdict};
use crate::results::Made;
use crate::statistics::quantile;
use stripmine_physics::number::{counted, significant};

/// What the item is called.
pub const NAME: &str = "plans";
/// Scenes in which the error is to be reached, at least.
const MET: f64 = 0.95;
/// Scenes in which the cost is to be at most `COST` times the best.
const CHEAP: f64 = 0.9;
const COST: f64 = 1.25;
/// No scene may cost more than this times the best.
const WORST: f64 = 3.0;
/// Time is to be foreseen within this factor.
const TIME: f64 = 1.5;
/// What plans are held against, in the order of the baselines.
const BASELINES: [&str; 3] = ["always lists", "the scene's own values", "f64 at the limit of stability"];
/// Scenes that are explained.
const EXPLAINED: usize = 3;

/// The page, and `again`, the command that makes it.
///
/// # Errors
/// If the dataset is none that JSON can hold.
pub fn made(judged: &[Judged], effort: Effort, again: String) -> Result<Made, Failure> {
    Ok(Made::new(section(judged, effort, again), &judged)?.with_tables([choices(judged), left_out(judged)]))
}

fn share(judged: &[Judged], is_so: impl Fn(&Judged) -> Option<bool>) -> (usize, usize) {
    let all: Vec<bool> = judged.iter().filter_map(is_so).collect();
    (all.iter().filter(|is_so| **is_so).count(), all.len())
}

fn section(judged: &[Judged], effort: Effort, again: String) -> Section {
    let planned: Vec<&Judged> = judged.iter().filter(|it| it.seconds.is_some()).collect();
    let met = share(judged, |it| it.seconds.map(|_| it.is_met));
    let cheap = share(judged, |it| Some(it.regret? <= COST));
    let timely = share(judged, |it| {
        let [foreseen, taken] = it.seconds?;
        Some((taken / foreseen).max(foreseen / taken) <= TIME)
    });
    let worst = judged.iter().filter_map(|it| it.regret).fold(0.0, f64::max);
    let is_reached = |(some, all): (usize, usize), wanted: f64| some as f64 >= wanted * all as f64;
    let all_met =
        is_reached(met, MET) && is_reached(cheap, CHEAP) && worst <= WORST && is_reached(timely, CHEAP);
    let without = judged.len() - planned.len();
    Section::new(NAME, "Plans: the way, the step and the time for an error")
        .asks("Does `explain` choose a way to run a scene that reaches the error, as cheaply as it can be done?")
        .expects(format!(
            "Our aim: the error is reached in {} % of the scenes, at no more than {COST} times the cost of the best that is known in {} %, never \
             above {WORST:.0}; time foreseen within a factor of {TIME}.",
            100.0 * MET,
            100.0 * CHEAP
        ))
        .answers(format!(
            "Of {} plans {} reach their error, {} of {} cost at most {COST} times the best (the worst {} times), and {} of {} take the time foreseen \
             within a factor of {TIME}{}.",
            met.1,
            met.0,
            cheap.0,
            cheap.1,
            significant(worst, 2),
            timely.0,
            timely.1,
            if without > 0 { format!("; for {} there is no plan", counted(without, "scene", "scenes")) } else { String::new() }
        ))
        .verdict(Verdict::aim(all_met))
        .details([format!(
            "Plans by trials of {} s, the best by trials of {} s. {}",
            effort.plan,
            effort.best,
            explained(judged)
        )])
        .figures([figure(judged)])
        .tables([table(judged), saved(judged)])
        .again(again)
        .seeds([1, 1000])
        .depends_on_host()
}

/// The scenes whose plans cost most beside the best.
fn explained(judged: &[Judged]) -> String {
    let mut worst: Vec<&Judged> = judged.iter().filter(|it| it.regret.is_some()).collect();
    worst.sort_by(|a, b| b.regret.unwrap_or(0.0).total_cmp(&a.regret.unwrap_or(0.0)));
    let words = worst.iter().take(EXPLAINED).map(|it| {
        format!(
            "{}, {}: {} times; {} in the place of {}.",
            it.scene.replace(" --set ", ", "),
            it.quantity,
            significant(it.regret.unwrap_or(f64::NAN), 2),
            it.recommended,
            it.best
        )
    });
    format!("The dearest beside the best: {}", words.collect::<Vec<_>>().join(" "))
}

/// The share of scenes whose cost is at most so many times the best.
fn figure(judged: &[Judged]) -> Figure {
    let curve = |name: &str, style: Style, hue: usize, of: &dyn Fn(&Judged) -> Option<f64>| {
        // The same scenes for every curve: those that have a plan to compare. A curve that does not reach the error in some ends
        // below 100 %.
        let compared = || judged.iter().filter(|it| it.regret.is_some());
        let mut ratios: Vec<f64> = compared().filter_map(of).map(|ratio| ratio.max(0.1)).collect();
        ratios.sort_by(f64::total_cmp);
        let all = compared().count().max(1) as f64;
        let points =
            ratios.iter().zip(1_u32..).map(|(&ratio, count)| (ratio, 100.0 * f64::from(count) / all));
        Series::new(name, style, hue, points.collect::<Vec<_>>())
    };
    let baselines = BASELINES
        .iter()
        .enumerate()
        .map(|(at, name)| curve(name, Style::Line, at + 1, &move |it: &Judged| it.baselines[at]));
    Chart::of(
        Axis::logarithmic("wall time over that of the best, for the same error", None),
        Axis::linear("scenes at most so dear", Some("%")),
    )
    .with([curve("plans", Style::Joined, 0, &|it: &Judged| it.regret)])
    .with(baselines.collect::<Vec<_>>())
    .figure("regret", "How much dearer than the best")
    .caption("A curve that ends below 100 %: in the other scenes that way does not come to the error. Below 1: the best is known to its own trials only.")
}

fn table(judged: &[Judged]) -> Table {
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
        .table("plans", "Plans, carried out")
        .note(format!(
            "Cost over the best: by what the longer trials know, as planned or what the way and the step take for the error, whichever is more. Median {}.",
            significant(median(judged), 3)
        ))
}

/// What one scene may be modelled without.
struct Twin<'j> {
    judged: &'j Judged,
    twin: &'j LeftOut,
}

fn twins(judged: &[Judged]) -> Vec<Twin<'_>> {
    judged.iter().flat_map(|judged| judged.left_out.iter().map(move |twin| Twin { judged, twin })).collect()
}

/// What each of them saves, over all scenes that have it.
fn saved(judged: &[Judged]) -> Table {
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
        .table("saved", "What scenes may be modelled without, and what that saves of the wall time")
        .note("The rest is not decided: differences are within their bars, or could not be compared. Scene by scene: left-out.csv.".to_owned())
}

/// The same scene by scene.
fn left_out(judged: &[Judged]) -> Table {
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
        .table("left-out", "What the scenes may be modelled without")
}

fn median(judged: &[Judged]) -> f64 {
    let mut all: Vec<f64> = judged.iter().filter_map(|it| it.regret).collect();
    all.sort_by(f64::total_cmp);
    quantile(&all, 0.5).unwrap_or(f64::NAN)
}

fn choices(judged: &[Judged]) -> Table {
    Rows::of(judged)
        .text("scene", |it| it.scene.clone())
        .text("quantity", |it| it.quantity)
        .text("recommended", |it| it.recommended.clone())
        .text("the best", |it| it.best.clone())
        .text("no plan, for", |it| it.failed.clone().unwrap_or_default())
        .table("choices", "What was recommended")
}
