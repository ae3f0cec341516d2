//! From what was measured to what is recommended.

use super::Target;
use super::bias::Off;
use super::findings::{Findings, Way};
use super::optimum::{Optimum, Terms, optimum};
use super::sample::ROWS;
use crate::study::Case;
use serde::Serialize;
use stripmine_physics::method::Every;
use stripmine_physics::number::significant;
use stripmine_physics::scene::{STEPS, Width};

/// A time is foreseen within this factor, beside what the scatter is known to: other programs come and go.
pub(super) const TIME_WITHIN: f64 = 1.5;
/// Rows that a mean is taken of, at least.
const FEWEST_ROWS: f64 = 100.0;
/// Independent samples that a run has at least: so many that it knows the error of its own mean.
const SAMPLES: f64 = 30.0;

/// From the least to the most, with what is likely in between.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Interval {
    /// The least.
    pub least: f64,
    /// What is likely.
    pub likely: f64,
    /// The most.
    pub most: f64,
}

/// Something that was chosen, and what stands beside it.
#[derive(Clone, Debug, Serialize)]
pub struct Decision {
    /// What about.
    pub what: String,
    /// What is recommended.
    pub chosen: String,
    /// Why.
    pub why: String,
    /// The others.
    pub beside: Vec<Beside>,
}

/// Something else that may be chosen.
#[derive(Clone, Debug, Serialize)]
pub struct Beside {
    /// What.
    pub name: String,
    /// Wall time over that of what is recommended, for the same error; none where it does not come to it.
    pub cost: Option<f64>,
    /// Why it is not recommended.
    pub why: String,
}

/// What a plan asks for and is expected to give.
#[derive(Clone, Debug, Serialize)]
pub struct Plan {
    /// The scene, as it is named on a command line.
    pub scene: String,
    /// Its method.
    pub method: &'static str,
    /// The quantity.
    pub quantity: &'static str,
    /// Its unit, empty for a pure number.
    pub unit: &'static str,
    /// Its mean by the reference, and half the width of its interval of 95 %; none of what should keep its value.
    pub mean: Option<[f64; 2]>,
    /// The error that is asked for, in the quantity's unit.
    pub error: Option<f64>,
    /// What is recommended, one after the other.
    pub decisions: Vec<Decision>,
    /// The error that is expected, in the quantity's unit.
    pub expected: Expected,
    /// Wall seconds.
    pub seconds: Interval,
    /// Bytes of a run.
    pub memory: u64,
    /// The step (time); none where the method takes none.
    pub step: Option<f64>,
    /// Time of each run, the transient in it (time).
    pub time: f64,
    /// Time of the transient (time).
    pub transient: f64,
    /// Runs with seeds of their own.
    pub seeds: u64,
    /// By how much the mean of another start differs, where that was seen.
    pub starts_differ: Option<f64>,
    /// The overrides that make the plan of the scene.
    pub overrides: Vec<String>,
    /// What the scene's own values cost and reach.
    pub own: Option<Own>,
    /// What the scene may be modelled without.
    pub left_out: Vec<LeftOut>,
    /// Where the figures come from.
    pub origin: String,
}

/// What the scene's own values cost and reach.
#[derive(Clone, Debug, Serialize)]
pub struct Own {
    /// Wall seconds.
    pub seconds: f64,
    /// The error that is expected of them, in the quantity's unit.
    pub error: Expected,
}

/// What an error is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Expected {
    /// What the step takes the mean off by.
    pub bias: Off,
    /// Half the width of the interval of 95 % of a mean of this length.
    pub chance: f64,
    /// The most that both are together with a probability of 95 %.
    pub most: f64,
}

impl Expected {
    pub(super) fn of(bias: Off, chance: f64) -> Expected {
        Expected { bias, chance, most: bias.with(chance) }
    }
}

/// What the scene may be modelled without.
#[derive(Clone, Debug, Serialize)]
pub struct LeftOut {
    /// What.
    pub name: String,
    /// What it changes of the mean, and its bar; none where it was not seen.
    pub change: Option<[f64; 2]>,
    /// Cost over that with it.
    pub cost: Option<f64>,
    /// Whether the scene needs it, in words.
    pub says: String,
}

/// A way with what it takes for the error.
pub(super) struct Weighed<'w> {
    pub(super) way: &'w Way,
    pub(super) optimum: Optimum,
}

/// What is recommended for an error in the quantity's unit.
///
/// # Errors
/// The least error that can be had, where no way comes to what is asked for.
pub fn plan(case: &Case, target: &Target, findings: &Findings, origin: &str) -> Result<Plan, f64> {
    let reference = &findings.reference;
    let own_way = findings.ways.iter().find(|way| way.label == case.own.label());
    let own = own_way.and_then(|way| own(case, way, findings));
    let error = target.error.map(|width| in_unit(width, reference.mean));
    // Without an error: as good as the scene's own values.
    let wanted = error.or(own.as_ref().map(|own| own.error.most));
    let wanted = wanted.unwrap_or(0.01 * reference.mean.abs());
    let usable = |way: &&Way| way.cost.is_some() && way.dropped.is_none();
    let mut weighed: Vec<Weighed<'_>> = findings
        .ways
        .iter()
        .filter(usable)
        .filter_map(|way| Some(Weighed { way, optimum: weigh(way, findings, wanted)? }))
        .collect();
    weighed.sort_by(|a, b| a.optimum.seconds.total_cmp(&b.optimum.seconds));
    let Some(best) = weighed.first() else {
        // Bias at the shortest step that is weighed is all that is left.
        let least = findings.ways.iter().filter(usable).filter_map(|way| Some(way.bias?.at(0.0).most()));
        return Err(least.fold(f64::INFINITY, f64::min));
    };
    let length = length(best, findings);
    let step = best.way.step.map(|step| best.optimum.part * step);
    let per_run = length.time / length.seeds as f64 + reference.transient;
    let expected = Expected::of(best.optimum.bias, (reference.square / length.time).sqrt());
    // The square of a bar is known to its degrees of freedom.
    let scatter = 1.0 + 2.0 * (2.0 / reference.freedoms.max(2.0)).sqrt();
    let seconds = Interval {
        least: length.seconds / (TIME_WITHIN * scatter),
        likely: length.seconds,
        most: length.seconds * TIME_WITHIN * scatter,
    };
    Ok(Plan {
        scene: case.arguments(),
        method: case.entry.vocabulary.keys.method,
        quantity: target.quantity.name,
        unit: target.quantity.unit,
        mean: Some([reference.mean, reference.bar]),
        error,
        decisions: decisions(case, findings, &weighed, &length, wanted),
        expected,
        seconds,
        memory: case.prepared.memory.needed * length.seeds.min(findings.threads as u64).max(1),
        step,
        time: per_run,
        transient: reference.transient,
        seeds: length.seeds,
        starts_differ: findings.starts_differ,
        overrides: overrides(case, best.way, step, Some(per_run)),
        own,
        left_out: left_out(findings, wanted, reference.mean),
        origin: origin.to_owned(),
    })
}

/// The overrides that make a plan of a scene.
pub(super) fn overrides(case: &Case, way: &Way, step: Option<f64>, time: Option<f64>) -> Vec<String> {
    let mut overrides = way.overrides.clone();
    if let (Some(trials), Some(step)) = (case.entry.trials, step) {
        overrides.push(format!("{}={}", trials.step.path(), significant(step, 4)));
    }
    let time = time.or(case.duration());
    // The length of a run is given as the scene has it, in steps or as a time.
    let Some(time) = time else { return overrides };
    overrides.push(match (case.values.gives(&STEPS), step) {
        (true, Some(step)) => format!("{}={}", STEPS.path(), (time / step).ceil()),
        _ => format!("run.time={}", significant(time, 6)),
    });
    // Its own rows, where these are enough for a mean with a bar.
    let apart = match case.prepared.schedule.rows {
        Every::Steps(steps) => step.map_or(f64::INFINITY, |step| steps as f64 * step),
        Every::Time(time) => time,
        Every::Never | Every::Seconds(_) => f64::INFINITY,
    };
    if time < FEWEST_ROWS * apart {
        let every = time / ROWS[1];
        let every = step.map_or(significant(every, 3), |step| (every / step).max(1.0).floor().to_string());
        overrides.push(format!("run.thermo_every={every}"));
    }
    overrides
}

/// What a plan costs by other findings (wall seconds); none where these do not know its way.
pub fn cost_of(plan: &Plan, findings: &Findings) -> Option<f64> {
    let is_chosen = |way: &&Way| way.overrides.iter().all(|text| plan.overrides.contains(text));
    let way = findings.ways.iter().filter(is_chosen).max_by_key(|way| way.overrides.len())?;
    let cost = way.cost? * way.step.zip(plan.step).map_or(1.0, |(longest, step)| longest / step);
    let threads = if plan.seeds > 1 { findings.one_thread } else { 1.0 };
    Some(findings.start + ROWS[1] * findings.row + cost * threads * plan.time)
}

/// An error in the quantity's unit.
pub fn in_unit(width: Width, mean: f64) -> f64 {
    match width {
        Width::Percent(percent) => 0.01 * percent * mean.abs(),
        Width::Absolute(error) => error,
    }
}

/// The cheapest step and time of a way; a way that was not compared has the bias of none, and is not weighed where others were.
fn weigh(way: &Way, findings: &Findings, wanted: f64) -> Option<Optimum> {
    let reference = &findings.reference;
    let terms = Terms { cost: way.cost?, square: reference.square, transient: reference.transient };
    match (way.step, way.bias) {
        (None, _) => optimum(terms, wanted, |_| Off::default()).filter(|it| it.part == 1.0),
        (Some(step), Some(bias)) => optimum(terms, wanted, |part| bias.at(part * step)),
        (Some(_), None) => None,
    }
}

/// How the time is spread over runs.
pub(super) struct Length {
    /// Time that is averaged over, of all runs (time).
    pub(super) time: f64,
    pub(super) seeds: u64,
    /// Wall seconds of all.
    pub(super) seconds: f64,
    pub(super) why: String,
}

fn length(best: &Weighed<'_>, findings: &Findings) -> Length {
    let transient = findings.reference.transient;
    // So that each run has a mean of its own, with a bar.
    let least = SAMPLES * findings.reference.apart;
    let time = best.optimum.time.max(transient).max(least);
    let cost = best.way.cost.unwrap_or(0.0) / best.optimum.part;
    let start = findings.start + ROWS[1] * findings.row;
    let together = start + cost * (time + transient);
    let threads = findings.threads as f64;
    if let Some(difference) = findings.starts_differ {
        let why = format!(
            "another start has a mean {} off: what a start keeps, such as its energy, does not average out in a run, and the plan is for this one",
            significant(difference, 2)
        );
        return Length { time, seeds: 1, seconds: together, why };
    }
    let apart = start + cost * findings.one_thread * (time / threads + transient);
    if findings.threads > 1 && apart < 0.95 * together && time / threads > transient.max(least) {
        return Length {
            time,
            seeds: findings.threads as u64,
            seconds: apart,
            why: format!(
                "one on each core: one thread takes {} times what {} take, and the transient ({}) is made anew by each",
                significant(findings.one_thread, 2),
                findings.threads,
                significant(transient, 2)
            ),
        };
    }
    let why = if findings.threads == 1 {
        "there is one thread".to_owned()
    } else {
        format!("the transient ({}) would be made anew by each of several", significant(transient, 2))
    };
    Length { time, seeds: 1, seconds: together, why }
}

fn own(case: &Case, way: &Way, findings: &Findings) -> Option<Own> {
    let (time, step) = (case.duration()?, case.step());
    let reference = &findings.reference;
    let cost = way.cost? * way.step.zip(step).map_or(1.0, |(longest, own)| longest / own);
    // Of the scene's own integrator, in whatever digits it was compared.
    let is_alike = |it: &&Way| {
        it.settings.iter().any(|(name, setting)| {
            name == "integrator" && way.settings.contains(&(name.clone(), setting.clone()))
        })
    };
    let bias = findings.ways.iter().filter(is_alike).find_map(|it| it.bias);
    let bias = match (bias, step) {
        (Some(bias), Some(step)) => bias.at(step),
        (None, Some(_)) => Off::exactly(f64::NAN),
        (_, None) => Off::default(),
    };
    let left = time - reference.transient;
    let chance = if left > 0.0 { (reference.square / left).sqrt() } else { f64::INFINITY };
    Some(Own { seconds: findings.start + cost * time, error: Expected::of(bias, chance) })
}

pub(super) fn decisions(
    case: &Case,
    findings: &Findings,
    weighed: &[Weighed<'_>],
    length: &Length,
    wanted: f64,
) -> Vec<Decision> {
    let best = &weighed[0];
    let mut all = vec![];
    for (axis, chosen) in &best.way.settings {
        let mut beside: Vec<Beside> = vec![];
        // Of each other setting the cheapest way that has it.
        let known = weighed.iter().map(|it| it.way);
        for way in known.chain(&findings.ways) {
            let Some((_, other)) = way.settings.iter().find(|(name, _)| name == axis) else { continue };
            if other == chosen || beside.iter().any(|it| it.name == *other) {
                continue;
            }
            let own = weighed.iter().find(|it| it.way.label == way.label);
            let differs = way.settings.iter().filter(|it| !best.way.settings.contains(it) && it.0 != *axis);
            let with: Vec<&str> = differs.map(|(_, name)| name.as_str()).collect();
            let with = if with.is_empty() { String::new() } else { format!(" (with {})", with.join(" ")) };
            beside.push(Beside {
                name: other.clone(),
                cost: own.map(|it| it.optimum.seconds / best.optimum.seconds),
                why: why_not(way, own, best) + &with,
            });
        }
        let why = match beside.iter().filter_map(|it| it.cost).reduce(f64::min) {
            Some(next) if next > 1.05 => format!("the next takes {} times as long", significant(next, 2)),
            Some(_) => "another is as cheap, within what can be timed".to_owned(),
            None if beside.is_empty() => "there is no other".to_owned(),
            None => "no other comes into question".to_owned(),
        };
        all.push(Decision { what: axis.clone(), chosen: chosen.clone(), why, beside });
    }
    if let Some(longest) = best.way.step {
        all.push(step_decision(case, best, longest, wanted));
    }
    let reference = &findings.reference;
    all.push(Decision {
        what: "run length".to_owned(),
        chosen: significant(length.time / length.seeds as f64 + reference.transient, 4),
        why: format!(
            "{} to average over for a chance of ± {}, after a transient of {}",
            significant(length.time, 3),
            significant((reference.square / length.time).sqrt(), 2),
            significant(reference.transient, 3)
        ),
        beside: vec![],
    });
    all.push(Decision {
        what: "seeds".to_owned(),
        chosen: length.seeds.to_string(),
        why: length.why.clone(),
        beside: vec![],
    });
    all
}

fn step_decision(case: &Case, best: &Weighed<'_>, longest: f64, wanted: f64) -> Decision {
    let step = best.optimum.part * longest;
    let own = case
        .step()
        .map_or(String::new(), |own| format!("{} times the scene's own; ", significant(step / own, 2)));
    let bound = best.way.bound.clone().unwrap_or_else(|| "nothing bounds it by theory".to_owned());
    let mut beside = vec![Beside {
        name: significant(longest, 3),
        cost: None,
        why: format!("the longest that nothing speaks against ({bound})"),
    }];
    if best.optimum.part == 1.0 {
        beside.clear();
    }
    let why = match best.way.bias {
        Some(bias) => format!(
            "{own}bias at most {} of the {} allowed, as {} at {} was {} ± {} off",
            significant(best.optimum.bias.most(), 2),
            significant(wanted, 2),
            best.way.label,
            significant(bias.step, 3),
            significant(bias.difference, 2),
            significant(bias.bar, 2)
        ),
        None => own,
    };
    Decision { what: "dt".to_owned(), chosen: significant(step, 4), why, beside }
}

fn why_not(way: &Way, own: Option<&Weighed<'_>>, best: &Weighed<'_>) -> String {
    if let Some(why) = &way.dropped {
        return why.clone();
    }
    let costs = |cost: f64| significant(cost / best.way.cost.unwrap_or(f64::NAN), 2);
    if let Some(drift) = way.drift.filter(|_| own.is_none()) {
        return format!("it is off by {} at half of its longest step", significant(drift.farthest[1], 2));
    }
    match (own, way.cost) {
        (Some(own), _) if own.optimum.seconds > best.optimum.seconds => "for the same error".to_owned(),
        (Some(_), _) => "as cheap".to_owned(),
        (None, Some(_)) if way.bias.is_some() => "its bias is more than the error asked for".to_owned(),
        (None, Some(cost)) => format!(
            "a unit of time costs {} times as much at its longest step; its means were not compared",
            costs(cost)
        ),
        (None, None) => "it was not timed".to_owned(),
    }
}

fn left_out(findings: &Findings, wanted: f64, mean: f64) -> Vec<LeftOut> {
    let all = findings.without.iter().map(|it| {
        let says = match (it.difference, &it.failed) {
            (Some([difference, bar]), _) if difference.abs() - bar > wanted => {
                format!(
                    "needed: without it the mean changes by {} ± {}",
                    significant(difference, 2),
                    significant(bar, 2)
                )
            }
            (Some([difference, bar]), _) if difference.abs() + bar <= wanted => format!(
                "not needed for this error: without it the mean changes by {} ± {}",
                significant(difference, 2),
                significant(bar, 2)
            ),
            (Some([difference, bar]), _) => format!(
                "not decided: the mean changes by {} ± {} ({} ± {} %)",
                significant(difference, 2),
                significant(bar, 2),
                significant(100.0 * difference / mean.abs(), 2),
                significant(100.0 * bar / mean.abs(), 2)
            ),
            (None, Some(why)) => format!("not compared: {why}"),
            (None, None) => "not compared".to_owned(),
        };
        LeftOut { name: it.name.clone(), change: it.difference, cost: it.cost, says }
    });
    all.collect()
}
