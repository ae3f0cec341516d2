//! What the means of all ways are held against.

use super::ExplainError;
use super::bias::{Bias, REFERENCE};
use super::findings::{FIRST, Findings, SHARES, Way, Work};
use super::sample::{Known, Sample};
use super::whole::{RUNS, Warned};
use stripmine_physics::averages::Outcome;
use stripmine_physics::number::significant;
use stripmine_physics::scene::SEED;

/// Starts differ where their means are as many bars apart: about three standard errors.
const SURE: f64 = 1.5;

/// How often the reference is looked for, each time for longer.
const ATTEMPTS: usize = 4;
/// Another attempt is made where it may be this many times as long as the one before, at least.
pub(super) const LONGER: f64 = 1.5;

/// The reference, as measured.
pub(super) struct Reference {
    /// Its way, and its step (time).
    pub(super) way: String,
    pub(super) step: Option<f64>,
    pub(super) known: Known,
    pub(super) start: f64,
    pub(super) row: f64,
    pub(super) cost: f64,
    pub(super) phases: Vec<(String, f64)>,
    /// Transients of all samples: the start is the same, or alike, and they differ by the noise of what finds them.
    pub(super) transients: Vec<f64>,
}

impl Work<'_> {
    /// The most accurate integrator in full digits by the cheapest search, at a part of its longest step; for a method without steps the cheapest
    /// way itself.
    pub(super) fn reference(&mut self, ways: &[Way]) -> Result<Reference, ExplainError> {
        let best = self.choice(&ways[0]);
        let choice = match self.case.entry.trials {
            Some(trials) => best.with(trials.references[0]),
            None => best,
        };
        let known = ways.iter().find(|way| way.label == choice.label() && way.cost.is_some());
        let mut way = known.unwrap_or(&ways[0]).clone();
        let mut step = way.step.map(|step| REFERENCE * step);
        let mut seconds = SHARES[1] * self.seconds;
        let kept_back = SHARES[2] * self.seconds;
        let (mut why, mut enough) = (String::new(), self.for_whole_run(&way, step));
        for attempt in 0..ATTEMPTS {
            let spare = self.left() - kept_back;
            if attempt > 0 {
                let Some(longer) = longer(seconds, spare) else { break };
                seconds = longer;
            }
            match self.measured(&way, step, seconds, Warned::GoesOn) {
                // What changes all along is asked for over the whole run.
                Ok((sample, _)) if self.whole.is_none() && changes(&sample) => {
                    (why, enough) = (no_mean(&sample), self.enough(&sample));
                    self.whole = self.whole_in(sample.cost, self.left() - kept_back);
                    if self.whole.is_none() {
                        why.push_str(&self.too_dear(sample.cost));
                    }
                }
                Ok((sample, known)) => match known {
                    Some(known) => {
                        return Ok(Reference {
                            way: way.label,
                            step,
                            known,
                            start: sample.start,
                            row: sample.row,
                            cost: sample.cost,
                            phases: sample.phases,
                            transients: vec![known.transient],
                        });
                    }
                    None => (why, enough) = (no_mean(&sample), self.enough(&sample)),
                },
                Err(failure) => {
                    why = failure;
                    way = ways[0].clone();
                    step = step.map(|step| 0.5 * step);
                }
            }
        }
        Err(ExplainError::NoMean { quantity: self.target.quantity.name, why, enough })
    }

    /// Seconds of trials whose reference is as long as the scene's own run; none where its end is no time, or nothing is known of the cost.
    fn for_whole_run(&self, way: &Way, step: Option<f64>) -> Option<f64> {
        let slower = way.step.zip(step).map_or(1.0, |(longest, step)| longest / step);
        Some(trials_for(self.case.duration()? * way.cost? * slower))
    }

    /// Seconds of trials whose reference is long enough for a mean, by a sample that was too short.
    fn enough(&self, sample: &Sample) -> Option<f64> {
        let time = match sample.outcome {
            Outcome::TooShort { enough_at, .. } => enough_at,
            // Where it will have become stationary is not known before the end of the scene's own run.
            Outcome::Changing { .. } if !sample.comes_beyond_end => {
                self.case.duration()?.max(LONGER * sample.time)
            }
            // Whole runs have means of their own.
            Outcome::Changing { .. } => RUNS[0] as f64 * self.case.duration()?,
            _ => return None,
        };
        // These were not enough, whatever a unit of time cost in them.
        Some(trials_for(sample.cost * time).max(LONGER * self.seconds / FIRST))
    }

    /// The mean of another start less that of the reference, where that is beyond both bars.
    pub(super) fn starts_differ(&self, way: &Way, reference: &mut Reference) -> Option<f64> {
        // Of whole runs each has another.
        let seed = self.case.prepared.seed.filter(|_| self.whole.is_none())?;
        let another =
            Way { overrides: way.overrides.clone().set(&SEED, seed.wrapping_add(1)), ..way.clone() };
        let sample =
            self.sampled(&another, way.step.map(|step| 0.5 * step), SHARES[4] * self.seconds).ok()?;
        let known = sample.known()?;
        reference.transients.push(known.transient);
        let difference = known.mean - reference.known.mean;
        (difference.abs() > SURE * known.bar.hypot(reference.known.bar)).then_some(difference)
    }
}

/// Seconds of trials in which an attempt is as long as this (s): its share of the time before it is known what trials do not tell, once doubled.
fn trials_for(seconds: f64) -> f64 {
    seconds / (2.0 * SHARES[1] * FIRST)
}

/// Seconds of an attempt after one of so many: twice as many, as far as these can be spared; none where that is hardly more.
fn longer(before: f64, spare: f64) -> Option<f64> {
    Some((2.0 * before).min(spare)).filter(|seconds| *seconds >= LONGER * before)
}

/// Where the bar of a bias makes a plan dearer than this many times what it would be without, and by more than the trials take, it is seen again.
const WORTH: f64 = 1.5;

/// Looks again at the bias of a way and at the reference, for the time that is left, where a plan is dear only for what is not known of it; false where it is
/// not, or nothing better came of it.
pub(super) fn refined(work: &Work<'_>, findings: &mut Findings, way: &str, seconds: [f64; 2]) -> bool {
    let [with_bar, without] = seconds;
    if with_bar < WORTH * without || with_bar - without < work.seconds {
        return false;
    }
    let Some(at) = findings.ways.iter().position(|it| it.label == way) else { return false };
    let (way, Some(before)) = (findings.ways[at].clone(), findings.ways[at].bias) else { return false };
    let of_reference = findings.ways.iter().find(|it| it.label == findings.reference_way).cloned();
    let of_reference = of_reference.unwrap_or_else(|| way.clone());
    let half = 0.5 * work.left();
    let known =
        |way: &Way, step| work.measured(way, step, half, Warned::GoesOn).ok().and_then(|(_, known)| known);
    let again = known(&of_reference, findings.reference_step);
    let reference = again.filter(|it| it.bar < findings.reference.bar).unwrap_or(findings.reference);
    let Some(own) = known(&way, Some(before.step)) else { return false };
    let bias = Bias::of(before.step, &own, &reference, before.power);
    if bias.bar >= before.bar {
        return false;
    }
    findings.reference = Known { transient: findings.reference.transient.min(own.transient), ..reference };
    let is_alike = |other: &&mut Way| other.bias == Some(before);
    findings.ways.iter_mut().filter(is_alike).for_each(|other| other.bias = Some(bias));
    true
}

/// Whether a quantity still changes beyond the end of the scene's own run, or has died out by then: what comes to another mean later has that, and a
/// plan runs for so long.
fn changes(sample: &Sample) -> bool {
    if !sample.comes_beyond_end {
        return false;
    }
    let largest = sample.series.iter().fold(0.0_f64, |largest, [_, value]| largest.max(value.abs()));
    // Too little of what has died out may be left for a mean.
    let last = &sample.series[sample.series.len() * 3 / 4..];
    let has_died_out = !last.is_empty() && last.iter().all(|[_, value]| value.abs() < DEAD * largest);
    match sample.outcome {
        Outcome::Changing { .. } => true,
        _ => {
            has_died_out || sample.known().is_some_and(|known| known.mean.abs() + known.bar < DEAD * largest)
        }
    }
}

/// What is left of a quantity that has died out, in parts of its largest value.
const DEAD: f64 = 1e-3;

/// Why a sample has no mean.
pub(super) fn no_mean(sample: &Sample) -> String {
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
