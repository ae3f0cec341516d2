//! What is measured of a scene before anything is recommended: what each way costs, how long its step may be, what its means are.

use super::bias::{Bias, REFERENCE};
use super::drift::Drift;
use super::sample::{Known, Sample, Span, sample, timed};
use super::{ExplainError, Target};
use crate::study::{Case, Choice};
use rayon::ThreadPoolBuilder;
use serde::{Deserialize, Serialize};
use std::sync::atomic::AtomicBool;
use stripmine_physics::averages::Outcome;
use stripmine_physics::method::{Decides, Prepared, StepLimit, Twin};
use stripmine_physics::number::significant;
use stripmine_physics::scene::{Overrides, SEED};

/// The longest step that is tried, in parts of the shortest limit of theory: what lies at the limit itself fails for the fastest disc.
const OF_LIMIT: f64 = 0.9;
/// Where theory has no limit, the longest step is that many times the scene's own.
const TIMES_OWN: f64 = 4.0;
/// How often a step that fails or is warned of is halved.
pub(super) const HALVINGS: u32 = 6;
/// A way that costs this many times the best is followed no further.
const DEAR: f64 = 5.0;
/// How often each way is timed.
const ROUNDS: usize = 2;
/// Starts differ where their means are as many bars apart: about three standard errors.
const SURE: f64 = 1.5;
/// Parts of the time that is given: to time the ways, to the reference, to those that are compared with it, to what may be left out, to another
/// start.
pub(super) const SHARES: [f64; 5] = [0.15, 0.3, 0.25, 0.2, 0.1];

/// A way to run the scene, as measured.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Way {
    /// What it is called.
    pub label: String,
    /// Its settings, by axis.
    pub settings: Vec<(String, String)>,
    /// The overrides that it makes.
    pub overrides: Vec<String>,
    /// Wall seconds of a unit of time at `step`; none where it was given up.
    pub cost: Option<f64>,
    /// The longest step that nothing speaks against (time); none where the method takes none.
    pub step: Option<f64>,
    /// What bounds it, with its numbers.
    pub bound: Option<String>,
    /// What it is off by; none where it was not compared.
    pub bias: Option<Bias>,
    /// How far what should keep its value goes, where that is asked for.
    pub drift: Option<Drift>,
    /// Why it was followed no further.
    pub dropped: Option<String>,
}

/// What the scene may be modelled without.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Without {
    /// What is lacking.
    pub name: String,
    /// The mean less that with it, and its bar; none where it breaks or has no mean.
    pub difference: Option<[f64; 2]>,
    /// Cost over that with it.
    pub cost: Option<f64>,
    /// Why there is nothing to compare.
    pub failed: Option<String>,
}

/// What was measured.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Findings {
    /// Ways, the cheapest first, those that were given up last.
    pub ways: Vec<Way>,
    /// The mean by the reference.
    pub reference: Known,
    /// What the reference is: its way and its step.
    pub reference_way: String,
    /// By how much the mean of another start differs, where that is beyond both bars: what is kept of a start does not average out.
    pub starts_differ: Option<f64>,
    /// Wall seconds until the first step.
    pub start: f64,
    /// Wall seconds of a row.
    pub row: f64,
    /// Cost of one thread over that of all.
    pub one_thread: f64,
    /// Threads.
    pub threads: usize,
    /// What the scene may be modelled without.
    pub without: Vec<Without>,
}

/// A scene at work.
pub(super) struct Work<'w> {
    pub(super) case: &'w Case,
    target: &'w Target,
    pub(super) seconds: f64,
    stop: &'w AtomicBool,
}

/// Measures a scene in about some seconds.
///
/// # Errors
/// [`ExplainError`] if every trial breaks, or the quantity comes to no mean.
pub fn findings(
    case: &Case,
    target: &Target,
    seconds: f64,
    stop: &AtomicBool,
) -> Result<Findings, ExplainError> {
    let work = Work { case, target, seconds, stop };
    let mut ways = work.timed_ways()?;
    if target.is_kept() {
        return work.drifts(ways);
    }
    let mut reference = work.reference(&ways)?;
    work.compare(&mut ways, &mut reference);
    let best = &ways[0];
    let one_thread = work.one_thread(best);
    let starts_differ = work.starts_differ(best, &mut reference);
    // What finds the end of a transient errs by a part of the run that it looks at, mostly to the later side.
    reference.known.transient = reference.transients.iter().copied().fold(f64::INFINITY, f64::min);
    let without = work.without(best, &reference.known);
    Ok(Findings {
        reference: reference.known,
        reference_way: reference.label,
        starts_differ,
        start: reference.start,
        row: reference.row,
        one_thread,
        threads: rayon::current_num_threads(),
        without,
        ways,
    })
}

/// The reference, as measured.
pub(super) struct Reference {
    pub(super) label: String,
    pub(super) known: Known,
    pub(super) start: f64,
    pub(super) row: f64,
    pub(super) cost: f64,
    /// Transients of all samples: the start is the same, or alike, and they differ by the noise of what finds them.
    pub(super) transients: Vec<f64>,
}

impl Work<'_> {
    fn prepared(&self, overrides: &[String], step: Option<f64>) -> Result<Prepared, String> {
        let trials = self.case.entry.trials;
        let step = trials.zip(step).map(|(trials, step)| Overrides::new().set(trials.step, step));
        let own = Choice::own(&[], &self.case.prepared);
        let more = [overrides, step.as_deref().map_or(&[][..], |step| step)].concat();
        self.case.prepared_in(&own, &more).map_err(|errors| {
            let messages: Vec<&str> = errors.0.iter().map(|error| error.message.as_str()).collect();
            messages.join("; ")
        })
    }

    /// Every way with its cost at its longest step, the cheapest first.
    ///
    /// Which search or engine is the cheapest is measured with the scene's own integrator and digits, for results are the same; then the integrators
    /// and digits with that.
    fn timed_ways(&self) -> Result<Vec<Way>, ExplainError> {
        let all = Choice::all(self.case.entry.axes);
        let own = &self.case.own;
        let of_own_arithmetic =
            |choice: &&Choice| choice.agrees(own, Decides::Order) && choice.agrees(own, Decides::Digits);
        let searches: Vec<&Choice> = all.iter().filter(of_own_arithmetic).collect();
        let each = SHARES[0] * self.seconds / 2.0;
        let mut ways = self.timed(&searches, each);
        give_up(&mut ways);
        let Some(best) = ways.iter().position(|way| way.cost.is_some()).map(|at| ways[at].label.clone())
        else {
            let tried = ways.into_iter().map(|way| (way.label, way.dropped.unwrap_or_default()));
            return Err(ExplainError::EveryWayFails(tried.collect()));
        };
        let best = all.iter().find(|choice| choice.label() == best).unwrap_or(own);
        let others: Vec<&Choice> = all
            .iter()
            .filter(|choice| choice.agrees(best, Decides::Cost) && !of_own_arithmetic(choice))
            .collect();
        ways.extend(self.timed(&others, each));
        sort(&mut ways);
        Ok(ways)
    }

    /// Ways with their costs, the cheapest first.
    ///
    /// Each is timed again after all the others: other programs come and go, and the faster time of both is the better one.
    fn timed(&self, choices: &[&Choice], seconds: f64) -> Vec<Way> {
        let each = seconds / (ROUNDS * choices.len().max(1)) as f64;
        let mut ways: Vec<Way> = choices.iter().map(|choice| self.at_longest(choice, each)).collect();
        for _ in 1..ROUNDS {
            let limit = DEAR * least(&ways);
            for way in ways.iter_mut().filter(|way| way.cost.is_some_and(|cost| cost < limit)) {
                let again = self.prepared(&way.overrides, way.step).ok();
                let again = again.and_then(|prepared| timed(&prepared, each, self.stop).ok());
                way.cost = way.cost.into_iter().chain(again).reduce(f64::min);
            }
        }
        sort(&mut ways);
        ways
    }

    /// A way at the longest step that theory has nothing against and at which it runs.
    fn at_longest(&self, choice: &Choice, seconds: f64) -> Way {
        let overrides: Vec<String> = choice.overrides().collect();
        let settings = choice.settings().map(|(axis, name)| (axis.to_owned(), name.to_owned())).collect();
        let mut way = Way {
            label: choice.label(),
            settings,
            overrides,
            cost: None,
            step: None,
            bound: None,
            bias: None,
            drift: None,
            dropped: None,
        };
        let own_step = self.case.step();
        let prepared = match self.prepared(&way.overrides, None) {
            Ok(prepared) => prepared,
            Err(why) => {
                way.dropped = Some(format!("refused: {why}"));
                return way;
            }
        };
        let limit = prepared.step_limits.iter().min_by(|a, b| a.step.total_cmp(&b.step));
        let longest = own_step.map(|own| limit.map_or(TIMES_OWN * own, |limit| OF_LIMIT * limit.step));
        way.bound = limit.map(bounded);
        let mut step = longest;
        for _ in 0..HALVINGS {
            let tried = self.prepared(&way.overrides, step).map_err(|why| format!("refused: {why}"));
            let tried = tried.and_then(|prepared| {
                timed(&prepared, seconds, self.stop).map_err(|failure| first_line(&failure.what()))
            });
            match tried {
                Ok(cost) => {
                    (way.cost, way.step, way.dropped) = (Some(cost), step, None);
                    return way;
                }
                Err(why) => way.dropped = Some(why),
            }
            let Some(shorter) = step.map(|step| 0.5 * step) else { break };
            way.bound = way.dropped.clone();
            step = Some(shorter);
        }
        way
    }

    pub(super) fn sampled(&self, way: &Way, step: Option<f64>, seconds: f64) -> Result<Sample, String> {
        self.sampled_over(way, step, Span::Seconds(seconds))
    }

    pub(super) fn sampled_over(&self, way: &Way, step: Option<f64>, span: Span) -> Result<Sample, String> {
        let prepared = self.prepared(&way.overrides, step)?;
        let observed = (self.case.entry.quantities, self.target.place);
        sample(&prepared, observed, span, self.stop).map_err(|failure| first_line(&failure.what()))
    }

    /// The most accurate integrator in full digits by the cheapest search, at a part of its longest step; for a method without steps the cheapest
    /// way itself.
    fn reference(&self, ways: &[Way]) -> Result<Reference, ExplainError> {
        let best = self.choice(&ways[0]);
        let choice = match self.case.entry.trials {
            Some(trials) => best.with(trials.references[0]),
            None => best,
        };
        let known = ways.iter().find(|way| way.label == choice.label() && way.cost.is_some());
        let mut way = known.unwrap_or(&ways[0]).clone();
        let mut step = way.step.map(|step| REFERENCE * step);
        let mut seconds = SHARES[1] * self.seconds;
        let mut why = String::new();
        for _ in 0..3 {
            match self.sampled(&way, step, seconds) {
                Ok(sample) => match sample.known() {
                    Some(known) => {
                        let at =
                            step.map_or(String::new(), |step| format!(", step {}", significant(step, 3)));
                        return Ok(Reference {
                            label: format!("{}{at}", way.label),
                            known,
                            start: sample.start,
                            row: sample.row,
                            cost: sample.cost,
                            transients: vec![known.transient],
                        });
                    }
                    None => {
                        why = no_mean(&sample);
                        seconds *= 2.0;
                    }
                },
                Err(failure) => {
                    why = failure;
                    way = ways[0].clone();
                    step = step.map(|step| 0.5 * step);
                }
            }
        }
        Err(ExplainError::NoMean { quantity: self.target.quantity.name, why })
    }

    pub(super) fn choice(&self, way: &Way) -> Choice {
        let settings: Vec<(&str, &str)> =
            way.settings.iter().map(|(axis, name)| (axis.as_str(), name.as_str())).collect();
        self.case.own.with(&settings)
    }

    /// What one thread takes over what all of them take.
    fn one_thread(&self, way: &Way) -> f64 {
        let threads = rayon::current_num_threads();
        let seconds = 0.05 * self.seconds;
        let measured = || {
            let prepared = self.prepared(&way.overrides, way.step).ok()?;
            let all = timed(&prepared, seconds, self.stop).ok()?;
            let pool = ThreadPoolBuilder::new().num_threads(1).build().ok()?;
            Some(pool.install(|| timed(&prepared, seconds, self.stop)).ok()? / all)
        };
        if threads == 1 { 1.0 } else { measured().unwrap_or(1.0) }
    }

    /// The mean of another start less that of the reference, where that is beyond both bars.
    fn starts_differ(&self, way: &Way, reference: &mut Reference) -> Option<f64> {
        let seed = self.case.prepared.seed?;
        let another = Way {
            overrides: [&way.overrides[..], &Overrides::new().set(&SEED, seed.wrapping_add(1))].concat(),
            ..way.clone()
        };
        let sample =
            self.sampled(&another, way.step.map(|step| 0.5 * step), SHARES[4] * self.seconds).ok()?;
        let known = sample.known()?;
        reference.transients.push(known.transient);
        let difference = known.mean - reference.known.mean;
        (difference.abs() > SURE * known.bar.hypot(reference.known.bar)).then_some(difference)
    }

    /// The scene without each of what it may be modelled without.
    fn without(&self, way: &Way, reference: &Known) -> Vec<Without> {
        let twins: Vec<(&Twin, Overrides)> = self
            .case
            .entry
            .twins
            .iter()
            .filter_map(|twin| Some((twin, (twin.overrides)(&self.case.values)?)))
            .collect();
        let seconds = SHARES[3] * self.seconds / twins.len().max(1) as f64;
        let measured = |(twin, overrides): (&Twin, Overrides)| {
            let more = [&way.overrides[..], &overrides].concat();
            let of = |failed: Option<String>| Without {
                name: twin.name.to_owned(),
                difference: None,
                cost: None,
                failed,
            };
            let prepared = match self.prepared(&more, None) {
                Ok(prepared) => prepared,
                Err(why) => return of(Some(why)),
            };
            let limit = prepared.step_limits.iter().map(|limit| limit.step).reduce(f64::min);
            let step = way.step.map(|step| limit.map_or(step, |limit| OF_LIMIT * limit));
            let twin_way = Way { overrides: more, ..way.clone() };
            match self.sampled(&twin_way, step, seconds) {
                Ok(sample) => {
                    let known = sample.known();
                    Without {
                        difference: known
                            .map(|known| [known.mean - reference.mean, known.bar.hypot(reference.bar)]),
                        cost: way.cost.map(|cost| sample.cost / cost),
                        ..of(known.is_none().then(|| no_mean(&sample)))
                    }
                }
                Err(why) => of(Some(why)),
            }
        };
        twins.into_iter().map(measured).collect()
    }
}

/// The cost of the cheapest.
fn least(ways: &[Way]) -> f64 {
    ways.iter().filter_map(|way| way.cost).fold(f64::INFINITY, f64::min)
}

/// Gives up those dearer than `DEAR` times the best: their results are the same.
fn give_up(ways: &mut [Way]) {
    let least = least(ways);
    for way in ways.iter_mut() {
        if let Some(cost) = way.cost.filter(|cost| *cost > DEAR * least) {
            way.dropped = Some(format!("costs {} times the cheapest", significant(cost / least, 2)));
        }
    }
    sort(ways);
}

/// The cheapest first, those that were given up last.
pub(super) fn sort(ways: &mut [Way]) {
    let key = |way: &Way| (way.dropped.is_some(), way.cost.unwrap_or(f64::INFINITY));
    ways.sort_by(|a, b| key(a).0.cmp(&key(b).0).then(key(a).1.total_cmp(&key(b).1)));
}

fn bounded(limit: &StepLimit) -> String {
    format!("{}: {}", limit.name, limit.why)
}

/// A message without its advice, in one line.
fn first_line(message: &str) -> String {
    message.lines().next().unwrap_or_default().to_owned()
}

/// Why a sample has no mean.
fn no_mean(sample: &Sample) -> String {
    let time = significant(sample.time, 3);
    match sample.outcome {
        Outcome::Changing { first, last } => format!(
            "still changing up to a time of {time}, from {} to {}",
            significant(first, 3),
            significant(last, 3)
        ),
        Outcome::TooShort { enough_at, .. } => {
            format!("a time of {time} is too short, {} would do", significant(enough_at, 2))
        }
        _ => format!("there is none up to a time of {time}"),
    }
}
