//! Means over whole runs, for quantities that never become stationary: a hopper that empties, a gas that cools. Runs from slightly displaced
//! starts give the statistical error of such a mean.

use super::findings::{MeasuredConfiguration, MissingRun, NO_TIME, SceneTrials};
use crate::results::run_in_parallel;
use crate::study::first_line;
use crate::study::state::displaced;
use crate::study::trial::{MeanEstimate, SampleSpan, TrialSample, any_number};
use serde::{Deserialize, Serialize};
use stripmine_physics::method::Prepared;
use stripmine_physics::number::significant;
use stripmine_physics::particles::Particles;
use stripmine_physics::scene::{Overrides, SEED};

/// Fewest and most whole runs.
pub(super) const RUNS: [usize; 2] = [3, 16];
/// Displacement of particles where a start has nothing random (in parts of the largest radius, or of the box for points): far
/// above rounding, and far too small to matter before collisions have amplified it.
const DISPLACED: f64 = 1e-7;

/// A mean with its cost.
pub(super) struct MeasuredMean {
    /// The mean, or the reason why there is none.
    pub(super) known: Result<MeanEstimate, String>,
    /// Wall seconds of a unit of time.
    pub(super) cost: f64,
}

/// Mean of a whole run, and wall seconds of a unit of time.
#[derive(Clone, Copy, Serialize, Deserialize)]
struct WholeRunMean {
    #[serde(with = "any_number")]
    mean: f64,
    cost: f64,
}

impl SceneTrials<'_> {
    /// Time of a whole run: to the end of the requested window, or the scene's own (time).
    pub(super) fn whole_time(&self) -> Option<f64> {
        self.target.window.map(|[_, end]| end).or_else(|| self.case.duration())
    }

    /// Returns the time of a whole run if enough whole runs, besides the sample, fit into `seconds` at the sample's cost.
    pub(super) fn affordable_whole_time(&self, sample: &TrialSample, seconds: f64) -> Option<f64> {
        self.whole_time().filter(|&time| {
            let more = RUNS[0] - usize::from(sample.early_end(time).is_none());
            more.div_ceil(rayon::current_num_threads()) as f64 * sample.cost * time <= seconds
        })
    }

    /// Describes the whole runs that did not fit into the trial time.
    pub(super) fn missing_whole_runs(&self, cost: f64) -> String {
        self.whole_time().map_or(String::new(), |time| {
            format!(
                "; a mean over the whole run needs {} runs of about {} s",
                RUNS[0],
                significant(cost * time, 2)
            )
        })
    }

    /// Measures the mean after the transient, or over whole runs, and the cost of a unit of time.
    pub(super) fn measure_mean(
        &self,
        configuration: &MeasuredConfiguration,
        step: Option<f64>,
        seconds: f64,
    ) -> Result<MeasuredMean, String> {
        match self.whole {
            Some(time) => self.whole_runs(&configuration.overrides, step, (time, None), seconds),
            None => self.sample_over(configuration, step, SampleSpan::Seconds(seconds)).map(|sample| {
                MeasuredMean {
                    known: sample.known().ok_or_else(|| sample.missing_mean_reason()),
                    cost: sample.cost,
                }
            }),
        }
    }

    /// Measures whole runs from several starts, as many at once as there are threads, for about `seconds`. A sample of the same configuration from
    /// the scene's own start is the first, if it is long enough.
    pub(super) fn whole_runs(
        &self,
        overrides: &Overrides,
        step: Option<f64>,
        (time, first): (f64, Option<&TrialSample>),
        seconds: f64,
    ) -> Result<MeasuredMean, String> {
        let begun = self.trial.watch.now();
        let at_once = rayon::current_num_threads().min(RUNS[1]);
        let observed = (self.case.quantities(), self.target.place);
        let from = self.target.window.map_or(0.0, |[from, _]| from);
        let whole = |sample: &TrialSample| {
            let run = WholeRunMean { mean: sample.mean_over([from, time]), cost: sample.cost };
            sample.early_end(time).map_or(Ok(run), Err)
        };
        let one = |number: usize| {
            let key = format!("whole run|{}|{step:?}|{time}|{number}", overrides.texts().join(" "));
            let run = self.journal.recall(
                &key,
                |_| true,
                || {
                    let prepared = self.another_start(overrides, step, number as u64).map_err(MissingRun)?;
                    let left = self.left();
                    if left == 0.0 {
                        return Err(MissingRun(NO_TIME.to_owned()));
                    }
                    let sample = self.trial.sample(&prepared, observed, SampleSpan::Time(time, Some(left)));
                    let sample =
                        sample.map_err(|failure| MissingRun(first_line(&failure.what_and_when())))?;
                    whole(&sample).map_err(MissingRun)
                },
            );
            run.map_err(|MissingRun(why)| why)
        };
        let mut samples: Vec<WholeRunMean> = first.and_then(|it| whole(it).ok()).into_iter().collect();
        let known_before = samples.len();
        loop {
            let next: Vec<usize> = (samples.len()..samples.len() + at_once).collect();
            let more: Result<Vec<WholeRunMean>, String> = run_in_parallel(&next, |&number| one(number));
            match more {
                Ok(more) => samples.extend(more),
                Err(why) if samples.len() < RUNS[0] => return Err(why),
                Err(_) => break,
            }
            let spent = self.trial.watch.now() - begun;
            let rounds = (samples.len() - known_before) / at_once;
            let is_over = spent * (rounds + 1) as f64 / rounds as f64 > seconds;
            if samples.len() >= RUNS[1] || samples.len() >= RUNS[0] && is_over {
                break;
            }
        }
        let means: Vec<f64> = samples.iter().map(|it| it.mean).collect();
        let count = means.len() as f64;
        Ok(MeasuredMean {
            known: MeanEstimate::of_whole_runs(&means, time)
                .ok_or_else(|| "only one run finished".to_owned()),
            cost: samples.iter().map(|sample| sample.cost).sum::<f64>() / count,
        })
    }

    /// Prepares the scene from a numbered start; number 0 is its own.
    pub(super) fn another_start(
        &self,
        overrides: &Overrides,
        step: Option<f64>,
        number: u64,
    ) -> Result<Prepared, String> {
        match self.case.prepared.seed {
            Some(seed) => self.prepared(&overrides.clone().set(&SEED, seed.wrapping_add(number)), step),
            None if number == 0 => self.prepared(overrides, step),
            None => {
                let prepared = self.prepared(overrides, step)?;
                Ok(prepared.model.started_from(displaced_start(&prepared, number)))
            }
        }
    }
}

/// Particles of a numbered start, each displaced slightly.
pub(super) fn displaced_start(prepared: &Prepared, number: u64) -> Particles {
    let largest = prepared.particles().radii().map_or(0.0, |[_, largest]| largest);
    let scale = if largest > 0.0 { largest } else { prepared.domain.length(0) };
    displaced(prepared.particles(), &prepared.domain, |place, _| {
        // Irregular directions, different for each start.
        let angle = 2.399_963_229_728_653 * ((place + 1) as f64 * number as f64);
        [libm::cos(angle), libm::sin(angle)].map(|part| DISPLACED * scale * part)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_physics::method::{METHODS, load};

    /// Every grain moves by 10⁻⁷ of the largest radius, walls do not move, and each start differs.
    #[test]
    fn displaced_starts_differ_slightly() {
        let (prepared, _) = load("shaken-box", &[], METHODS).unwrap();
        let starts = [1, 2].map(|number| displaced_start(&prepared, number));
        let before = prepared.particles();
        let [_, largest] = before.radii().unwrap();
        for (number, start) in starts.iter().enumerate() {
            for (at, (own, now)) in before.all().iter().zip(start.all()).enumerate() {
                let displacement = prepared.domain.displacement(now.planar_position(), own.planar_position());
                let expected = if at < before.grain_count() { DISPLACED * largest } else { 0.0 };
                assert!(
                    (displacement[0].hypot(displacement[1]) - expected).abs() < 1e-3 * DISPLACED * largest,
                    "{number}, {at}"
                );
            }
        }
        let same = starts[0].all().iter().zip(starts[1].all()).filter(|(a, b)| a.position == b.position);
        assert_eq!(same.count(), before.len() - before.grain_count());
    }
}
