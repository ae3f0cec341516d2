//! Reference mean of a scene, by runs of its reference configuration at a short step, independent of the planner.

use super::super::in_unit;
use super::runs::{StartEnsemble, WHOLE, side_by_side};
use crate::study::trial::{MeanEstimate, SampleSpan, TrialSample};
use stripmine_physics::scene::{Overrides, Width};

/// Step of the reference, in parts of the scene's own.
const STEP: f64 = 0.25;
/// Most halvings of the step of a reference that fails or raises a warning.
const HALVINGS: usize = 2;
/// Largest error bar of a reference, in parts of the target error.
const ENOUGH: f64 = 1.0 / 3.0;
/// Share of the time after which the rest is predicted.
const SCOUT: f64 = 0.2;
/// Factor on the predicted length of runs: error bars are known roughly.
const LONGER: f64 = 1.3;
/// Fewest whole runs.
const FEWEST: usize = 4;
/// Number of the first start of the reference: estimates use those before.
const STARTS: usize = 10_000;

/// The reference mean.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ReferenceMean {
    /// Mean of all its runs; exactly 0 for the deviation of a conserved quantity.
    pub known: MeanEstimate,
    /// Its step (time); none where the method takes none.
    pub step: Option<f64>,
}

impl ReferenceMean {
    /// The mean, and half the width of its 95 % interval.
    pub(super) fn mean(&self) -> [f64; 2] {
        [self.known.mean, self.known.bar]
    }
}

impl StartEnsemble<'_> {
    /// Measures the reference mean to a third of an error, or as well as `seconds` of wall time allow.
    pub(crate) fn reference(&self, error: Width, seconds: f64) -> Result<ReferenceMean, String> {
        if self.target.is_kept() {
            return Ok(ReferenceMean { known: MeanEstimate::exactly(0.0), step: None });
        }
        let mut step = self.case.step().map(|own| STEP * own);
        let mut halvings = if step.is_some() { HALVINGS } else { 0 };
        loop {
            let overrides = self.reference_at(step);
            // The last attempt is accepted, warnings included.
            match self.mean_by(&overrides, error, seconds, halvings == 0) {
                Ok(known) => return Ok(ReferenceMean { known, step }),
                Err(why) if halvings == 0 => return Err(why),
                Err(_) => (halvings, step) = (halvings - 1, step.map(|step| 0.5 * step)),
            }
        }
    }

    /// Overrides of the reference at a step (time).
    fn reference_at(&self, step: Option<f64>) -> Overrides {
        let Some((trials, step)) = self.case.entry.trials.zip(step) else { return Overrides::new() };
        self.case.own.with(trials.references[0]).overrides().set(trials.step, step)
    }

    fn mean_by(
        &self,
        overrides: &Overrides,
        error: Width,
        seconds: f64,
        accepts_warnings: bool,
    ) -> Result<MeanEstimate, String> {
        let begun = self.trial.watch.now();
        let mut samples: Vec<TrialSample> = vec![];
        let mut span = SCOUT * seconds;
        loop {
            let first = STARTS + samples.len();
            let more = side_by_side(rayon::current_num_threads(), |at| {
                let prepared = self.start(overrides, first + at)?;
                self.sample(
                    &prepared,
                    self.asking.whole.map_or(SampleSpan::Seconds(span), |time| SampleSpan::Time(time, None)),
                )
            });
            for sample in more.map_err(|error| error.to_string())? {
                let sample = sample?;
                if !accepts_warnings && !sample.warnings.is_empty() {
                    return Err(format!("warning: {}", sample.warning_text()));
                }
                samples.push(sample);
            }
            let spent = self.trial.watch.now() - begun;
            let known = match self.asking.whole {
                Some(time) => {
                    let means: Vec<f64> = samples.iter().map(|sample| sample.mean_over(WHOLE)).collect();
                    MeanEstimate::of_whole_runs(&means, time)
                }
                None => joined(&samples.iter().filter_map(TrialSample::known).collect::<Vec<_>>()),
            };
            let excess = |known: &MeanEstimate| (known.bar / (ENOUGH * in_unit(error, known.mean))).powi(2);
            // The square of the error bar is inversely proportional to the time.
            let needed = known.as_ref().map_or(spent, |known| (LONGER * excess(known) - 1.0) * spent);
            span = needed.min(seconds - spent);
            let is_whole_enough = self.asking.whole.is_none() || samples.len() >= FEWEST;
            match known {
                Some(known) if is_whole_enough && (excess(&known) <= 1.0 || span <= 0.0) => return Ok(known),
                None if span <= 0.0 => return Err(samples[0].missing_mean_reason()),
                _ => span = span.max(SCOUT * seconds),
            }
        }
    }
}

/// Mean over independent runs, each weighted by its time. Where they scatter by more than their error bars, the error bar is enlarged by Birge's
/// ratio.
pub(super) fn joined(runs: &[MeanEstimate]) -> Option<MeanEstimate> {
    let first = runs.first()?;
    if runs.iter().any(|run| run.bar == 0.0) {
        return Some(*first);
    }
    let all = runs.iter().map(|run| run.span).sum::<f64>();
    let sum =
        |of: &dyn Fn(&MeanEstimate, f64) -> f64| runs.iter().map(|run| of(run, run.span / all)).sum::<f64>();
    let mean = sum(&|run, weight| weight * run.mean);
    let bar = sum(&|run, weight| (weight * run.bar).powi(2)).sqrt();
    // Error bars are about two standard errors.
    let chi_square = sum(&|run, _| (2.0 * (run.mean - mean) / run.bar).powi(2));
    let ratio = (chi_square / (runs.len() as f64 - 1.0).max(1.0)).sqrt().max(1.0);
    Some(MeanEstimate {
        mean,
        bar: ratio * bar,
        square: ratio * ratio * sum(&|run, weight| weight * run.square),
        every: sum(&|run, weight| weight * run.every),
        single: sum(&|run, weight| weight * run.single),
        span: all,
        waves: runs.iter().map(|run| run.waves).sum(),
        transient: runs.iter().map(|run| run.transient).fold(f64::INFINITY, f64::min),
        apart: sum(&|run, weight| weight * run.apart),
        freedoms: runs.iter().map(|run| run.freedoms).sum(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(mean: f64, bar: f64, span: f64) -> MeanEstimate {
        let square = bar * bar * span;
        MeanEstimate {
            bar,
            square,
            span,
            waves: 5.0,
            transient: span,
            apart: 1.0,
            freedoms: 5.0,
            ..MeanEstimate::exactly(mean)
        }
    }

    /// By hand: weights 1/4 and 3/4, error bar √(0.25² 0.4² + 0.75² 0.2²) = 0.18028; runs two error bars apart have χ² = 4 of one degree of freedom.
    #[test]
    fn runs_are_joined_by_their_time() {
        let known = joined(&[run(1.0, 0.4, 10.0), run(1.2, 0.2, 30.0)]).unwrap();
        assert!((known.mean - 1.15).abs() < 1e-12 && (known.bar - 0.180_277_56).abs() < 1e-8, "{known:?}");
        // A quarter of 0.4² 10 and three quarters of 0.2² 30.
        assert!((known.square - 1.3).abs() < 1e-12);
        assert_eq!((known.transient, known.freedoms, known.span), (10.0, 10.0, 40.0));
        let apart = joined(&[run(0.0, 0.1, 1.0), run(0.2, 0.1, 1.0)]).unwrap();
        assert!((apart.mean - 0.1).abs() < 1e-12);
        // Each is one error bar, two standard errors, from the mean: χ² = 8.
        assert!((apart.bar - 0.1 / 2f64.sqrt() * 8f64.sqrt()).abs() < 1e-12, "{apart:?}");
        assert!(joined(&[]).is_none());
    }
}
