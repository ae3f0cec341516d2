//! Bias of the steps of each integrator, by runs from the same states.

use super::bias::{Bias, Seen};
use super::findings::{HALVINGS, SHARES, Way, Work, sort};
use super::mean::Mean;
use crate::study::trial::{Compared, ENOUGH, Paired, pairs, part};
use crate::study::{Choice, first_line};
use stripmine_physics::method::{Decides, Prepared, Purpose};

/// States from which runs are compared, at least.
const FEWEST: usize = 4;
/// Integrators whose means are compared.
const COMPARED: usize = 3;
/// The step of the reference in parts of the shortest that is compared, and steps of each integrator in parts of its longest.
const REFERENCE: f64 = 0.25;
const STEPS: [f64; 2] = [1.0, 0.5];
/// Rows are this many of the longest steps apart.
const APART: f64 = 8.0;
/// Windows that are weighed, in parts of the longest in which runs stay together: shorter ones have hardly any contacts in them.
const SHORTER: f64 = 0.125;
/// Errors of means fall with a power of the step between these: contacts have kinks.
const POWERS: [f64; 2] = [1.0, 2.0];

/// Configurations that are compared, the reference first, each with its step.
struct Cases {
    /// Integrators, by the place of their cheapest configuration.
    firsts: Vec<usize>,
    prepared: Vec<(Prepared, f64)>,
    /// Time between rows (time).
    spacing: f64,
    /// The choice of the reference.
    reference: Choice,
}

impl Work<'_> {
    /// The bias of the cheapest configuration of each integrator, and of all that differ from it in digits or search alone: rounding is far below
    /// what can be seen of a mean.
    pub(super) fn biases(&self, ways: &mut [Way], mean: &Mean) {
        if self.case.entry.trials.is_none() {
            return;
        }
        let seconds = SHARES[2] * self.seconds;
        for _ in 0..=HALVINGS {
            let Some(cases) = self.cases(ways) else { break };
            match self.paired(&cases, mean, seconds) {
                Err(None) => break,
                Err(Some((at, why))) => {
                    // The reference has the shortest step of all: its configuration cannot be run.
                    let Some(first) = at.checked_sub(1).map(|at| cases.firsts[at / STEPS.len()]) else {
                        break;
                    };
                    self.shorten(ways, &ways[first].clone(), &why);
                }
                Ok(paired) => {
                    let warned = |first: usize| {
                        let all = &paired.warnings[1 + first * STEPS.len()];
                        all.first().map(|warning| format!("warned of: {}", warning.message))
                    };
                    let (at, why) = match (0..cases.firsts.len()).find_map(|at| Some((at, warned(at)?))) {
                        Some(found) if self.left() > 0.0 => found,
                        _ => {
                            self.assign(ways, &cases, &paired, mean);
                            break;
                        }
                    };
                    self.shorten(ways, &ways[cases.firsts[at]].clone(), &why);
                }
            }
        }
        for way in ways.iter_mut().filter(|way| way.bias.is_none() && way.step.is_some()) {
            way.dropped.get_or_insert_with(|| "its means were not compared".to_owned());
        }
        sort(ways);
    }

    /// Configurations to compare; none where one cannot be prepared.
    fn cases(&self, ways: &[Way]) -> Option<Cases> {
        let mut firsts: Vec<usize> = vec![];
        for (at, way) in ways.iter().enumerate().filter(|(_, way)| way.dropped.is_none()) {
            let own = self.choice(way);
            let is_another = firsts.iter().all(|&it| !self.choice(&ways[it]).agrees(&own, Decides::Order));
            // The scene's own is always among them: the error of its own values is said.
            let is_own = own.agrees(&self.case.own, Decides::Order);
            if is_another && (firsts.len() < COMPARED || is_own) {
                firsts.push(at);
            }
        }
        let trials = self.case.entry.trials?;
        let steps = |at: &usize| ways[*at].step;
        let longest = firsts.iter().filter_map(steps).reduce(f64::max)?;
        let shortest = firsts.iter().filter_map(steps).reduce(f64::min)?;
        let reference = self.choice(&ways[*firsts.first()?]).with(trials.references[0]);
        let spacing = APART * longest;
        let of_firsts = firsts.iter().flat_map(|&at| {
            STEPS.map(|part| (ways[at].overrides.clone(), part * ways[at].step.unwrap_or(longest)))
        });
        let of_reference = (reference.overrides().collect::<Vec<String>>(), REFERENCE * shortest);
        let (overrides, steps): (Vec<Vec<String>>, Vec<f64>) =
            std::iter::once(of_reference).chain(of_firsts).unzip();
        let prepared = overrides.iter().zip(steps).map(|(overrides, step)| {
            let even = spacing / (spacing / step).ceil();
            Some((self.prepared(overrides, Some(even)).ok()?, even))
        });
        let prepared = prepared.collect::<Option<Vec<_>>>()?;
        Some(Cases { firsts, prepared, spacing, reference })
    }

    /// Runs of all cases from the same states; no reason where there are too few of these, else the case that broke and why.
    fn paired(&self, cases: &Cases, mean: &Mean, seconds: f64) -> Result<Paired, Option<(usize, String)>> {
        let steps: Vec<u64> =
            cases.prepared.iter().map(|(_, step)| (cases.spacing / step).round() as u64).collect();
        let begin = |case: usize, start: usize| {
            let prepared = cases.prepared[case].0.model.started_from(mean.states[start].clone());
            prepared.start(Purpose::Run).map_err(|failure| first_line(&failure.what()))
        };
        if mean.states.len() < FEWEST {
            return Err(None);
        }
        let compared = Compared { steps: &steps, starts: mean.states.len(), begin: &begin };
        let observed = (self.case.entry.quantities, self.target.place);
        pairs(&self.trial, &compared, observed, seconds.min(self.left()))
            .map_err(|broken| Some((broken.at, broken.why)))
    }

    /// The biases that paired runs show.
    fn assign(&self, ways: &mut [Way], cases: &Cases, paired: &Paired, mean: &Mean) {
        // A run that changes all along remembers all of it.
        let memory = self.whole.unwrap_or(0.5 * mean.known.apart);
        let run = self.whole.map_or(1.0, |time| part(time, memory));
        for (number, &first) in cases.firsts.iter().enumerate() {
            let choice = self.choice(&ways[first]);
            let power = self.power(&choice);
            let is_of_reference = choice.agrees(&cases.reference, Decides::Order);
            let places: Vec<usize> = (0..STEPS.len()).map(|at| 1 + number * STEPS.len() + at).collect();
            let longest =
                paired.windows.iter().rev().find(|it| it.scatter() <= ENOUGH).or(paired.windows.first());
            let shortest = SHORTER * longest.map_or(0.0, |window| window.time);
            let bias = paired.windows.iter().filter(|window| window.time >= shortest).map(|window| {
                let seen: Vec<Seen> = places
                    .iter()
                    .map(|&at| {
                        let difference = window.differences[at - 1];
                        Seen {
                            step: cases.prepared[at].1,
                            reference: if is_of_reference { cases.prepared[0].1 } else { 0.0 },
                            difference: [difference.value, difference.bar],
                        }
                    })
                    .collect();
                Bias::of(&seen, power, window.time, part(window.time, memory) / run, paired.starts)
            });
            // The window that tells most: longer ones show more of the bias, and scatter more.
            let best = bias.min_by(|a, b| a.bar.total_cmp(&b.bar));
            for way in ways.iter_mut().filter(|way| self.choice(way).agrees(&choice, Decides::Order)) {
                way.bias = best;
            }
        }
    }

    /// The power of the step with which errors of means fall: that of theory for positions, within [`POWERS`].
    fn power(&self, choice: &Choice) -> f64 {
        self.theory(choice).map_or(POWERS[1], |order| order.clamp(POWERS[0], POWERS[1]))
    }

    /// The power of the step with which errors of positions fall by theory.
    pub(super) fn theory(&self, choice: &Choice) -> Option<f64> {
        let (trials, scheme) = self.case.entry.trials.zip(choice.scheme())?;
        Some((trials.theory)(&self.case.values, &self.case.prepared, scheme)?.order)
    }
}
