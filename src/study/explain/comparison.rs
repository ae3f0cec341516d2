//! What ways differ by: means at their longest steps, and how far what should keep its value goes.

use super::ExplainError;
use super::bias::Bias;
use super::drift::Drift;
use super::findings::{Findings, HALVINGS, SHARES, Way, Work, sort};
use super::reference::Reference;
use super::sample::{Known, Sample, Span};
use super::whole::Warned;
use crate::study::Choice;
use stripmine_physics::averages::Outcome;
use stripmine_physics::method::Decides;

/// Ways whose means are compared.
pub(super) const COMPARED: usize = 3;
/// Errors of means fall with a power of the step between these.
const POWERS: [f64; 2] = [1.0, 2.0];
/// The highest order of an integrator here.
const MOST_POWER: f64 = 8.0;

/// The check of a run that says that positions have too few digits.
const ROUNDING: &str = "rounding";

/// What came of comparing a way.
#[derive(Clone, Copy, PartialEq)]
enum Found {
    /// Its mean, at this cost over what the first stretches took.
    Cost(f64),
    /// Its digits lose motion.
    TooFewDigits,
    /// It takes no steps.
    Nothing,
}

impl Work<'_> {
    /// The means of the cheapest ways at their longest steps, held against the reference: of each integrator the one with the cheapest digits. Other digits and
    /// searches have the same bias: rounding is far below what can be seen of a mean.
    pub(super) fn compare(&self, ways: &mut [Way], reference: &mut Reference) {
        if self.case.entry.trials.is_none() {
            // The reference is the way itself.
            ways[0].cost = Some(reference.cost);
            ways[0].phases = reference.phases.clone();
            return;
        }
        let mut compared: Vec<usize> = vec![];
        for at in 0..ways.len() {
            let own = self.choice(&ways[at]);
            let is_another = compared.iter().all(|&it| !self.choice(&ways[it]).agrees(&own, Decides::Order));
            // The scene's own is always among them: what it reaches is said.
            let is_own = own.agrees(&self.case.own, Decides::Order);
            if ways[at].dropped.is_none() && is_another && (compared.len() < COMPARED || is_own) {
                compared.push(at);
            }
        }
        let seconds = SHARES[2] * self.seconds / compared.len().max(1) as f64;
        for first in compared {
            let own = self.choice(&ways[first]);
            let mut next = Some(first);
            // With the cheapest digits that hold it.
            while let Some(at) = next.take() {
                let way = &mut ways[at];
                let found = self.compared(way, reference, seconds);
                let (way, choice) = (way.clone(), self.choice(way));
                if found == Found::TooFewDigits {
                    let alike = |other: &Way| {
                        let other = self.choice(other);
                        other.agrees(&choice, Decides::Order) && other.agrees(&choice, Decides::Digits)
                    };
                    for other in ways.iter_mut().filter(|other| alike(other)) {
                        (other.dropped, other.step) = (way.dropped.clone(), way.step);
                    }
                    let has_more = |other: &Way| {
                        other.dropped.is_none() && self.choice(other).agrees(&own, Decides::Order)
                    };
                    next = ways.iter().position(has_more);
                    continue;
                }
                let Found::Cost(slower) = found else { continue };
                let alike = |other: &Way| self.choice(other).agrees(&own, Decides::Order);
                for other in ways
                    .iter_mut()
                    .filter(|other| other.label != way.label && other.dropped.is_none() && alike(other))
                {
                    let shorter = other.step.zip(way.step).map_or(1.0, |(longest, step)| longest / step);
                    other.cost = other.cost.map(|cost| slower * shorter * cost);
                    other.phases.iter_mut().for_each(|(_, cost)| *cost *= slower * shorter);
                    (other.step, other.bias) = (way.step, way.bias);
                    (other.bound, other.dropped) = (way.bound.clone(), way.dropped.clone());
                }
            }
        }
        sort(ways);
    }

    /// The mean of a way at the longest step at which it is not warned of.
    fn compared(&self, way: &mut Way, reference: &mut Reference, seconds: f64) -> Found {
        let power = self.power(&self.choice(way));
        let Some(longest) = way.step else { return Found::Nothing };
        let mut step = longest;
        // What a way takes over what the first stretches took.
        let mut slower = 1.0;
        for _ in 0..HALVINGS {
            match self.measured(way, Some(step), seconds, Warned::Stops) {
                Ok((sample, known)) if sample.warnings.is_empty() => {
                    reference.transients.extend(known.map(|known| known.transient));
                    way.step = Some(step);
                    slower = sample.cost / way.cost.unwrap_or(sample.cost);
                    way.cost = Some(sample.cost);
                    way.phases = sample.phases;
                    way.bias = known.map(|known| Bias::of(step, &known, &reference.known, power));
                    break;
                }
                Ok((sample, _)) => {
                    let why = format!("warned of: {}", sample.warned());
                    if sample.warnings.iter().any(|warning| warning.check == ROUNDING) {
                        // A shorter step loses more of it.
                        (way.dropped, way.step) = (Some(why), Some(longest));
                        return Found::TooFewDigits;
                    }
                    way.bound = Some(why);
                }
                Err(why) => way.bound = Some(why),
            }
            step *= 0.5;
            way.cost = way.cost.map(|cost| 2.0 * cost);
        }
        if way.bias.is_none() {
            let why = || Some("it has no mean in the time of a trial".to_owned());
            way.dropped = way.bound.clone().or_else(why);
        }
        Found::Cost(slower)
    }

    /// The power of the step with which errors of means fall: that of theory for positions, but no more than 2, for contacts have kinks.
    fn power(&self, choice: &Choice) -> f64 {
        self.theory(choice).map_or(POWERS[1], |order| order.clamp(POWERS[0], POWERS[1]))
    }

    /// The power of the step with which errors of positions fall by theory.
    fn theory(&self, choice: &Choice) -> Option<f64> {
        let (trials, scheme) = self.case.entry.trials.zip(choice.scheme())?;
        Some((trials.theory)(&self.case.values, &self.case.prepared, scheme)?.order)
    }

    /// How far what should keep its value goes, by the cheapest way of each integrator at two steps.
    pub(super) fn drifts(&self, mut ways: Vec<Way>) -> Result<Findings, ExplainError> {
        let usable = ways.iter().filter(|way| way.dropped.is_none()).count();
        let seconds = (1.0 - SHARES[0]) * self.seconds / (2.0 * usable.max(1) as f64);
        let span =
            self.case.duration().map_or(Span::Seconds(seconds), |time| Span::Time(time, Some(seconds)));
        let (mut start, mut row) = (0.0, 0.0);
        for way in ways.iter_mut().filter(|way| way.dropped.is_none()) {
            let (Some(longest), trials) = (way.step, self.case.entry.trials) else { continue };
            let both: Result<Vec<Sample>, String> = [1.0, 0.5]
                .into_iter()
                .map(|part| self.sampled_over(way, Some(part * longest), span))
                .collect();
            match both {
                Ok(both) => {
                    let far = |sample: &Sample| match sample.outcome {
                        Outcome::Kept { farthest, .. } => farthest,
                        _ => f64::NAN,
                    };
                    (start, row) = (both[0].start, both[0].row);
                    way.cost = Some(both[0].cost);
                    way.phases = both[0].phases.clone();
                    way.drift = Some(Drift {
                        step: longest,
                        farthest: [far(&both[0]), far(&both[1])],
                        time: both[0].time.min(both[1].time),
                        most_power: self.theory(&self.choice(way)).unwrap_or(MOST_POWER),
                        is_full: trials.is_none_or(|trials| {
                            self.choice(way)
                                .agrees(&self.case.own.with(trials.references[0]), Decides::Digits)
                        }),
                    });
                }
                Err(why) => way.dropped = Some(why),
            }
        }
        sort(&mut ways);
        let reference =
            Known { mean: 0.0, bar: 0.0, square: 0.0, transient: 0.0, apart: 0.0, freedoms: f64::INFINITY };
        let threads = rayon::current_num_threads();
        let (without, reference_way) = (vec![], String::new());
        Ok(Findings {
            ways,
            reference,
            reference_way,
            reference_step: None,
            whole: None,
            starts_differ: None,
            start,
            row,
            one_thread: 1.0,
            threads,
            without,
        })
    }
}
