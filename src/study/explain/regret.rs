//! How good plans are: each beside the best that trials of several times as long know, carried out, and held against the error that was asked for.

use super::as_it_stands::AS_IT_STANDS;
use super::bias::Off;
use super::findings::Findings;
use super::plan::way_of;
use super::recommended::{LeftOut, Plan};
use super::seen::{planned, seen};
use super::{Target, in_unit};
use crate::results::{Journal, Meter, Progress};
use crate::study::trial::{ROWS, Sample, Span, Stopwatch, Trial};
use crate::study::{Case, StudyError, first_line};
use rayon::ThreadPoolBuilder;
use std::sync::atomic::AtomicBool;
use std::thread;
use stripmine_physics::averages::Outcome;
use stripmine_physics::method::METHODS;
use stripmine_physics::scene::{SEED, Width};

/// Plans that would take longer are not carried out (s).
const LONGEST: f64 = 20.0;

/// A scene and what is asked of it.
#[derive(Clone, Copy, Debug)]
pub struct Asked {
    /// The preset.
    pub preset: &'static str,
    /// What differs from it.
    pub overrides: &'static [&'static str],
    /// The quantity.
    pub quantity: &'static str,
    /// The error of its mean, or of its value where it should be kept.
    pub error: &'static str,
}

/// Seconds of trials: those of a plan, and those of the best that is known.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Of a plan.
    pub plan: f64,
    /// Of the best.
    pub best: f64,
}

/// What became of a plan.
#[derive(Clone, Debug)]
pub struct Judged {
    /// The scene.
    pub scene: String,
    /// The quantity.
    pub quantity: &'static str,
    /// What was asked for, in the quantity's unit.
    pub error: f64,
    /// What came out less what the best reference has, and half the width of the interval of 95 % of the latter.
    pub off: Option<[f64; 2]>,
    /// Whether that is the error that was asked for, or less.
    pub is_met: bool,
    /// Wall seconds: foreseen, and taken.
    pub seconds: Option<[f64; 2]>,
    /// Cost over that of the best, by what the longer trials know: as planned, or what its way and step take for the error, whichever is more. The
    /// first alone would praise a run that is too short.
    pub regret: Option<f64>,
    /// The same of three baselines: lists always, the scene's own step, f64 by the scene's own integrator at the longest step; none where they do
    /// not come to the error.
    pub baselines: [Option<f64>; 3],
    /// What was recommended.
    pub recommended: String,
    /// What would have been the best.
    pub best: String,
    /// What the scene may be modelled without.
    pub left_out: Vec<LeftOut>,
    /// Why there is no plan.
    pub failed: Option<String>,
}

/// Judges plans for some scenes.
///
/// # Errors
/// [`StudyError`] if a scene is bad.
pub fn judged(asked: &[Asked], effort: Effort, progress: Progress<'_>) -> Result<Vec<Judged>, StudyError> {
    let meter = Meter::new(asked.len() as f64, progress);
    let mut all = vec![];
    for it in asked {
        all.push(judge(it, effort)?);
        meter.add(1.0);
    }
    Ok(all)
}

fn judge(asked: &Asked, effort: Effort) -> Result<Judged, StudyError> {
    let overrides: Vec<String> = asked.overrides.iter().map(|&text| text.to_owned()).collect();
    let case = Case::load(asked.preset, &overrides, METHODS)?;
    let own = |error: super::ExplainError| StudyError::Own(Box::new(error));
    let target = Target::of(&case, Some(asked.quantity), Width::parse(asked.error)).map_err(own)?;
    let mut judged = Judged {
        scene: case.arguments(),
        quantity: target.quantity.name,
        error: f64::NAN,
        off: None,
        is_met: false,
        seconds: None,
        regret: None,
        baselines: [None; 3],
        recommended: String::new(),
        best: String::new(),
        left_out: vec![],
        failed: None,
    };
    let (watch, never) = (Stopwatch::wall(), AtomicBool::new(false));
    let trial = Trial { watch: &watch, stop: &never };
    let by_trials = |seconds: f64| -> Result<(Findings, Plan), String> {
        let found = seen(&case, &target, seconds, trial, (&|_| {}, &Journal::none()))
            .map_err(|error| error.to_string())?;
        let made = planned(&case, &target, &found, "").map_err(|unreached| unreached.to_string())?;
        Ok((found, made))
    };
    let (found, made) = match by_trials(effort.plan) {
        Ok(both) => both,
        Err(why) => {
            judged.failed = Some(why);
            return Ok(judged);
        }
    };
    judged.recommended = said(&made);
    judged.error = made.error.unwrap_or(f64::NAN);
    let (known, best) = match by_trials(effort.best) {
        Ok(both) => both,
        Err(_) => (found, made.clone()),
    };
    judged.best = said(&best);
    if let Some([mean, _]) = best.mean {
        judged.error = target.error.map_or(f64::NAN, |width| in_unit(width, mean));
    }
    let cheapest = best.seconds.likely;
    let ratios = [
        cost_of(&made, &known).map(|cost| cost / cheapest),
        cost_for(&made, &known, judged.error)
            .zip(cost_for(&best, &known, judged.error))
            .map(|(own, best)| own / best),
    ];
    judged.regret = ratios.into_iter().flatten().reduce(f64::max);
    judged.left_out.clone_from(&best.left_out);
    judged.baselines = baselines(&case, &target, &known).map(|cost| Some(cost? / cheapest));
    if made.seconds.likely > LONGEST {
        judged.failed = Some(format!("not carried out: it would take {:.0} s", made.seconds.likely));
        return Ok(judged);
    }
    match carried_out(&case, &target, &made, trial) {
        Ok((value, seconds)) => {
            let [mean, bar] = best.mean.unwrap_or([0.0; 2]);
            judged.off = Some([value - mean, bar]);
            judged.is_met = (value - mean).abs() <= judged.error + bar;
            judged.seconds = Some([made.seconds.likely, seconds]);
        }
        Err(why) => judged.failed = Some(why),
    }
    Ok(judged)
}

/// What a plan costs by other findings (wall seconds); none where these do not know its way.
fn cost_of(plan: &Plan, findings: &Findings) -> Option<f64> {
    let way = way_of(plan, findings)?;
    let cost = way.cost? * way.step.zip(plan.step).map_or(1.0, |(longest, step)| longest / step);
    let threads = if plan.seeds > 1 { findings.one_thread } else { 1.0 };
    Some(findings.start + ROWS[1] * findings.row + cost * threads * plan.time)
}

/// What the way and the step of a plan take for an error by other findings (wall seconds), however long it would run; none where these do not know the
/// way, or say that its step does not come to the error.
fn cost_for(plan: &Plan, findings: &Findings, error: f64) -> Option<f64> {
    let way = way_of(plan, findings)?;
    let part = way.step.zip(plan.step).map_or(1.0, |(longest, step)| step / longest);
    let bias = way.bias.zip(plan.step).map_or(Off::default(), |(bias, step)| bias.at(step));
    let chance = bias.leaves(error)?;
    Some(way.cost? / part * (findings.chance().time_for(chance) + findings.mean.transient))
}

/// A plan in a line.
fn said(plan: &Plan) -> String {
    let chosen = |what: &str| plan.decisions.iter().find(|it| it.what == what).map(|it| it.chosen.as_str());
    let names = [
        AS_IT_STANDS,
        "integrator",
        "precision",
        "search",
        "engine",
        "execution",
        "dt",
        "run length",
        "seeds",
    ];
    let named = names.into_iter().filter_map(|name| Some((name, chosen(name)?)));
    let words = named.map(|(name, chosen)| match name {
        "dt" => format!("dt {chosen}"),
        "run length" => format!("time {chosen}"),
        "seeds" => format!("seeds {chosen}"),
        _ => chosen.to_owned(),
    });
    words.collect::<Vec<_>>().join(", ")
}

/// Seconds by lists, by the scene's own step and way, and by the scene's own integrator in f64 at the longest step.
fn baselines(case: &Case, target: &Target, findings: &Findings) -> [Option<f64>; 3] {
    let of = |ways: Vec<super::findings::Way>| {
        let only = Findings { ways, ..findings.clone() };
        (!only.ways.is_empty())
            .then(|| planned(case, target, &only, "").ok())
            .flatten()
            .map(|it| it.seconds.likely)
    };
    let has = |way: &super::findings::Way, axis: &str, name: &str| {
        way.settings.iter().any(|setting| setting.0 == axis && setting.1 == name)
    };
    let own: Vec<(&str, &str)> = case.own.settings().collect();
    let is_own = |way: &&super::findings::Way| own.iter().all(|(axis, name)| has(way, axis, name));
    let lists = findings.ways.iter().filter(|way| has(way, "search", "neighbor-list")).cloned().collect();
    let as_it_is = findings.ways.iter().filter(is_own).cloned().map(|mut way| {
        // Its own step is the only one.
        if let (Some(own), Some(longest)) = (case.step(), way.step) {
            way.cost = way.cost.map(|cost| cost * longest / own);
            way.step = Some(own);
        }
        way
    });
    let own_integrator = own.iter().find(|(axis, _)| *axis == "integrator").map(|(_, name)| *name);
    let at_limit = findings.ways.iter().filter(|way| {
        own_integrator.is_none_or(|name| has(way, "integrator", name)) && has(way, "precision", "f64")
    });
    [of(lists), of(as_it_is.collect()), of(at_limit.cloned().collect())]
}

/// Carries out a plan, its seeds side by side: the mean, or how far what should be kept went, and wall seconds.
fn carried_out(case: &Case, target: &Target, plan: &Plan, trial: Trial<'_>) -> Result<(f64, f64), String> {
    let observed = (case.entry.quantities, target.place);
    let one = |seed: u64| -> Result<Sample, String> {
        let all = plan.overrides.clone();
        let all = if case.prepared.seed.is_some() { all.set(&SEED, seed) } else { all };
        let prepared = case.prepared_with(&all).map_err(|errors| errors.to_string())?;
        let found = trial
            .sample(&prepared, observed, Span::Time(plan.time, Some(5.0 * LONGEST)))
            .map_err(|failure| first_line(&failure.what()))?;
        match found.cut_off(plan.time) {
            Some(why) => Err(why),
            None => Ok(found),
        }
    };
    // Another seed than that of the trials, where starts are alike.
    let own = case.prepared.seed.unwrap_or_default();
    let first = if plan.starts_differ.is_some() { own } else { own + 1000 };
    let samples: Result<Vec<Sample>, String> = if plan.seeds == 1 {
        one(first).map(|sample| vec![sample])
    } else {
        thread::scope(|scope| {
            let runs: Vec<_> = (0..plan.seeds)
                .map(|number| {
                    scope.spawn(move || {
                        let pool = ThreadPoolBuilder::new().num_threads(1).build();
                        pool.map_err(|error| error.to_string())?.install(|| one(first + number))
                    })
                })
                .collect();
            runs.into_iter()
                .map(|run| run.join().unwrap_or_else(|_| Err("a thread broke".to_owned())))
                .collect()
        })
    };
    let samples = samples?;
    let seconds = samples.iter().map(|sample| sample.seconds).fold(0.0, f64::max);
    let values = samples.iter().map(|sample| match sample.outcome {
        Outcome::Kept { farthest, .. } => Ok(farthest),
        _ if plan.is_whole => Ok(sample.mean_over([0.0, f64::INFINITY])),
        _ => sample.known().map(|known| known.mean).ok_or_else(|| sample.without_mean()),
    });
    let values: Vec<f64> = values.collect::<Result<_, String>>()?;
    Ok((values.iter().sum::<f64>() / values.len() as f64, seconds))
}
