//! Measurement of the mean and its statistical error, by the cheapest configuration at the longest usable step.

use super::ExplainError;
use super::findings::{HALVINGS, MeasuredConfiguration, SHARES, SceneTrials};
use crate::study::trial::{MeanEstimate, SampleSpan, TrialSample, any_number};
use serde::{Deserialize, Serialize};
use stripmine_physics::averages::AverageOutcome;
use stripmine_physics::method::ChoiceEffect;
use stripmine_physics::particles::Particles;

/// Fewest states from which runs are compared.
pub(super) const FEWEST: usize = 4;
/// Most attempts for a run that is too short, each twice as long as the last.
const ATTEMPTS: usize = 4;
/// Share of the time of the first run, which is repeated for as long as steps are shortened.
const SCOUT: f64 = 0.15;
/// Smallest ratio of the lengths of two attempts: a smaller gain is not worth a repetition.
pub(super) const LONGER: f64 = 1.5;
/// A run that fails at so many halvings of the step fails at any step.
const ALIKE: u32 = 2;
/// Factor on the predicted time of a run that should reach the end of the scene.
const BEYOND: f64 = 1.1;
/// A mean with a relative error bar above this is hardly known.
const ROUGH: f64 = 0.5;
/// Name of the check that detects positions with too little precision.
const ROUNDING: &str = "rounding";
/// Value below which a quantity has died out, in parts of its largest value.
const DEAD: f64 = 1e-3;

/// The mean, as measured.
#[derive(Serialize, Deserialize)]
pub(super) struct TrialMean {
    pub(super) known: MeanEstimate,
    /// Label of the configuration.
    pub(super) configuration: String,
    /// Wall seconds until the first step, and of a row.
    pub(super) start: f64,
    pub(super) row: f64,
    /// Wall seconds of a unit of time in the runs of the mean.
    pub(super) cost: f64,
    /// The step (time); none where the method takes none.
    pub(super) step: Option<f64>,
    /// Wall seconds of a step; NaN where the method has no time step.
    #[serde(with = "any_number")]
    pub(super) step_cost: f64,
    /// Transients of all samples: starts are equal or similar, so these differ by the noise of their detection alone.
    pub(super) transients: Vec<f64>,
    /// States along the run after the transient.
    #[serde(skip)]
    pub(super) states: Vec<Particles>,
    /// Rows of the run, with all quantities.
    #[serde(skip)]
    pub(super) rows: Vec<Vec<f64>>,
}

impl SceneTrials<'_> {
    /// Measures the mean with the cheapest configuration. Configurations that fail or raise warnings get shorter steps, or are dropped.
    pub(super) fn mean(
        &mut self,
        configurations: &mut [MeasuredConfiguration],
    ) -> Result<TrialMean, ExplainError> {
        let mut seconds = self.shares[1] * self.seconds;
        let kept_back = self.shares[2] * self.seconds;
        let mut enough = self.for_whole_run(&configurations[0]);
        self.as_it_stands = self.run_as_it_stands(configurations);
        let (mut attempt, mut halvings, mut is_scout) = (0, 0, true);
        let as_timed = configurations.to_vec();
        // The scene is undefined beyond a requested window, and beyond its own end where longer runs fail at any step.
        let mut end = self.target.window.map(|[_, end]| end);
        loop {
            super::findings::sort_by_cost(configurations);
            let best = configurations[0].clone();
            if best.dropped.is_some() {
                let tried = configurations.iter().map(|configuration| {
                    (configuration.label.clone(), configuration.dropped.clone().unwrap_or_default())
                });
                return Err(ExplainError::EveryConfigurationFails(tried.collect()));
            }
            if !is_scout {
                seconds = self.extended_to_end(&best, seconds);
            }
            let share = if is_scout { SCOUT * seconds } else { seconds };
            let span = end.map_or(SampleSpan::Seconds(share), |end| SampleSpan::Time(end, Some(share)));
            let sample = match self.sample_over(&best, best.step, span) {
                Ok(sample) => sample,
                Err(_) if halvings == ALIKE && end.is_none() && self.goes_beyond(&best, share) => {
                    configurations.clone_from_slice(&as_timed);
                    (end, halvings) = (self.case.duration(), halvings + 1);
                    continue;
                }
                Err(failure) if halvings < HALVINGS && self.left() > kept_back => {
                    self.halve_steps(configurations, &best, &failure);
                    halvings += 1;
                    continue;
                }
                Err(failure) => return Err(self.no_mean(failure, enough)),
            };
            if !sample.warnings.is_empty() && halvings < HALVINGS && self.left() > kept_back {
                let warned = format!("warning: {}", sample.warning_text());
                match sample.warnings.iter().any(|warning| warning.check == ROUNDING) {
                    // A shorter step loses more of the motion.
                    true => self.drop_precision(configurations, &best, &warned),
                    false => self.halve_steps(configurations, &best, &warned),
                }
                halvings += 1;
                continue;
            }
            self.rescale_costs(configurations, &best, &sample);
            if is_scout {
                is_scout = false;
                continue;
            }
            let mut why = sample.missing_mean_reason();
            let is_part = self.is_part_of_run(&sample);
            if is_part {
                why = "the trials end before the scene does, and close encounters may come later".to_owned();
            }
            if is_part || end.is_some() || is_changing_beyond_end(&sample) || is_hardly_known(&sample) {
                enough = self.sufficient_trial_time(&sample);
                self.whole = self.affordable_whole_time(&sample, self.left());
                if let Some(time) = self.whole {
                    return self.over_whole_runs(&best, sample, time, seconds);
                }
                why.push_str(&self.missing_whole_runs(sample.cost));
            } else if let Some(known) = sample.known() {
                return Ok(trial_mean(&best, sample, known));
            } else {
                enough = self.sufficient_trial_time(&sample);
            }
            attempt += 1;
            let longer = (2.0 * seconds).min(self.left() - kept_back);
            if attempt == ATTEMPTS || longer < LONGER * seconds {
                return Err(self.no_mean(why, enough));
            }
            seconds = longer;
        }
    }

    /// True if a sample says nothing about the rest of the run, in which close encounters may come.
    fn is_part_of_run(&self, sample: &TrialSample) -> bool {
        let has_late_encounters = self.case.entry.trials.is_some_and(|trials| trials.has_late_encounters);
        has_late_encounters && self.target.window.is_none() && !sample.reaches_scene_end
    }

    /// True if a run of some seconds extends beyond the end of the scene's own run.
    fn goes_beyond(&self, configuration: &MeasuredConfiguration, seconds: f64) -> bool {
        self.case.duration().zip(configuration.cost).is_some_and(|(time, cost)| cost * time < seconds)
    }

    /// Seconds of a sample, extended to the end of the scene's own run where that is near.
    fn extended_to_end(&self, configuration: &MeasuredConfiguration, seconds: f64) -> f64 {
        let whole = self.case.duration().zip(configuration.cost).map(|(time, cost)| BEYOND * cost * time);
        whole.filter(|&whole| seconds < whole && whole <= LONGER * seconds).unwrap_or(seconds)
    }

    fn no_mean(&self, why: String, enough: Option<f64>) -> ExplainError {
        let run = self.as_it_stands;
        ExplainError::NoMean { quantity: self.target.quantity.name, why, enough, run }
    }

    /// Measures the mean over whole runs, with states along the sample that showed the quantity changing.
    fn over_whole_runs(
        &self,
        configuration: &MeasuredConfiguration,
        sample: TrialSample,
        time: f64,
        seconds: f64,
    ) -> Result<TrialMean, ExplainError> {
        let runs =
            self.whole_runs(&configuration.overrides, configuration.step, (time, Some(&sample)), seconds);
        let known = runs.and_then(|runs| Ok((runs.known?, runs.cost)));
        let (known, cost) = known.map_err(|why| self.no_mean(why, None))?;
        Ok(TrialMean { cost, ..trial_mean(configuration, sample, known) })
    }

    /// Halves the step of every configuration with the integrator of one that failed or raised a warning.
    pub(super) fn halve_steps(
        &self,
        configurations: &mut [MeasuredConfiguration],
        of: &MeasuredConfiguration,
        why: &str,
    ) {
        let choice = self.choice(of);
        let alike = |configuration: &&mut MeasuredConfiguration| {
            configuration.dropped.is_none()
                && self.choice(configuration).agrees_on(&choice, ChoiceEffect::Order)
        };
        for configuration in configurations.iter_mut().filter(alike) {
            configuration.bound = Some(why.to_owned());
            match configuration.step {
                Some(step) if step > 0.7 * of.step.unwrap_or(step) => {
                    (configuration.step, configuration.cost) =
                        (Some(0.5 * step), configuration.cost.map(|cost| 2.0 * cost));
                    configuration.phases.iter_mut().for_each(|(_, cost)| *cost *= 2.0);
                }
                Some(_) => {}
                None => configuration.dropped = Some(why.to_owned()),
            }
        }
    }

    /// Drops every configuration with the precision and integrator of one in which particles stop moving.
    fn drop_precision(
        &self,
        configurations: &mut [MeasuredConfiguration],
        of: &MeasuredConfiguration,
        why: &str,
    ) {
        let choice = self.choice(of);
        for configuration in configurations.iter_mut() {
            let own = self.choice(configuration);
            if own.agrees_on(&choice, ChoiceEffect::Order) && own.agrees_on(&choice, ChoiceEffect::Precision)
            {
                configuration.dropped = Some(why.to_owned());
            }
        }
    }

    /// Rescales all costs by that of a run, which differs from the cost of its first stretches.
    fn rescale_costs(
        &self,
        configurations: &mut [MeasuredConfiguration],
        best: &MeasuredConfiguration,
        sample: &TrialSample,
    ) {
        let slower = sample.cost / best.cost.unwrap_or(sample.cost);
        for configuration in configurations.iter_mut() {
            configuration.cost = configuration.cost.map(|cost| slower * cost);
            match configuration.label == best.label {
                true => configuration.phases.clone_from(&sample.phases),
                false => configuration.phases.iter_mut().for_each(|(_, cost)| *cost *= slower),
            }
        }
    }

    /// Wall seconds of the scene as it stands, if known.
    pub(super) fn run_as_it_stands(&self, configurations: &[MeasuredConfiguration]) -> Option<f64> {
        let configuration =
            configurations.iter().find(|configuration| configuration.label == self.case.own.label())?;
        let longer = configuration.step.zip(self.case.step()).map_or(1.0, |(longest, own)| longest / own);
        Some(configuration.cost? * longer * self.case.duration()?)
    }

    /// Trial time in which a run is as long as the scene's own (s); none where its end is not a time, or its cost is unknown.
    fn for_whole_run(&self, configuration: &MeasuredConfiguration) -> Option<f64> {
        Some(trials_for(self.case.duration()? * configuration.cost?))
    }

    /// Trial time that is long enough for a mean (s), estimated from a sample that was too short.
    fn sufficient_trial_time(&self, sample: &TrialSample) -> Option<f64> {
        let time = match sample.outcome {
            _ if self.is_part_of_run(sample) => super::whole_runs::RUNS[0] as f64 * self.case.duration()?,
            AverageOutcome::TooShort { enough_at, .. } => enough_at,
            // The end of the change is unknown before the end of the scene's own run.
            AverageOutcome::Changing { .. } if !sample.reaches_scene_end => {
                self.case.duration()?.max(LONGER * sample.time)
            }
            // Whole runs have means of their own.
            _ if self.target.window.is_some() => super::whole_runs::RUNS[0] as f64 * self.whole_time()?,
            AverageOutcome::Changing { .. } => super::whole_runs::RUNS[0] as f64 * self.case.duration()?,
            _ => return None,
        };
        // The present trials were too short, whatever their cost per unit of time.
        Some(trials_for(sample.cost * time).max(LONGER * self.seconds))
    }
}

fn trial_mean(configuration: &MeasuredConfiguration, sample: TrialSample, known: MeanEstimate) -> TrialMean {
    let after = |states: &&(f64, Particles)| states.0 >= known.transient;
    // If hardly any state is after the transient, states before it are used too.
    let first = match sample.states.iter().filter(after).count() {
        0..FEWEST => 0,
        count => sample.states.len() - count,
    };
    TrialMean {
        known,
        configuration: configuration.label.clone(),
        start: sample.start,
        row: sample.row,
        cost: sample.cost,
        step: configuration.step,
        step_cost: sample.cost * configuration.step.unwrap_or(f64::NAN),
        transients: vec![known.transient],
        states: sample.states.into_iter().skip(first).map(|(_, state)| state).collect(),
        rows: sample.rows,
    }
}

/// True if the mean is hardly known: the run may still be in its transient.
fn is_hardly_known(sample: &TrialSample) -> bool {
    match sample.outcome {
        AverageOutcome::TooShort { estimate, .. } => {
            estimate.is_none_or(|estimate| estimate.bar > ROUGH * estimate.mean.abs())
        }
        _ => false,
    }
}

/// Trial time in which the run for the mean, doubled once, takes `seconds` (s).
fn trials_for(seconds: f64) -> f64 {
    seconds / (2.0 * SHARES[1])
}

/// True if a quantity still changes beyond the end of the scene's own run, or has died out by then: a later mean would differ.
fn is_changing_beyond_end(sample: &TrialSample) -> bool {
    if !sample.reaches_scene_end {
        return false;
    }
    let largest = sample.series.iter().fold(0.0_f64, |largest, [_, value]| largest.max(value.abs()));
    // A quantity that has died out may leave too little for a mean.
    let last = &sample.series[sample.series.len() * 3 / 4..];
    let has_died_out = !last.is_empty() && last.iter().all(|[_, value]| value.abs() < DEAD * largest);
    match sample.outcome {
        AverageOutcome::Changing { .. } => true,
        _ => {
            has_died_out || sample.known().is_some_and(|known| known.mean.abs() + known.bar < DEAD * largest)
        }
    }
}
