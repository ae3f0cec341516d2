//! Measures the deviation of conserved quantities over whole runs, step by step: long steps are cheap and come first.

use super::ExplainError;
use super::findings::{Findings, MeasuredConfiguration, MissingRun, NO_TIME, SceneTrials, sort_by_cost};
use super::plan::in_unit;
use crate::results::run_in_parallel;
use crate::study::rounded;
use crate::study::trial::{MeanEstimate, SampleSpan, any_number};
use serde::{Deserialize, Serialize};
use stripmine_physics::averages::{AverageOutcome, student};
use stripmine_physics::method::ChoiceEffect;

/// Longest step tried, in steps of the scene.
const LONGEST: f64 = 64.0;
/// Independent starts of a scene with a seed.
const STARTS: u64 = 6;
/// Factor on the deviation of one start where there is no time for several.
const MARGIN: f64 = 2.0;
/// Two-sided confidence whose upper end is that of 95 % one-sided.
const TWO_SIDED: f64 = 0.9;
/// Target error where none is given and the scene's own is unknown.
pub(super) const WANTED: f64 = 1e-3;

/// A run to the end of the scene.
#[derive(Serialize, Deserialize)]
struct DeviationRun {
    #[serde(with = "any_number")]
    farthest: f64,
    costs: Option<RunCosts>,
}

/// Wall seconds until the first step, of a row, and of a unit of time, in total and in each phase.
#[derive(Serialize, Deserialize)]
struct RunCosts {
    start: f64,
    row: f64,
    unit: f64,
    phases: Vec<(String, f64)>,
}

impl SceneTrials<'_> {
    /// Measures the deviation over whole runs, one after the other. The next run is of the configuration expected to reach the error most cheaply, as
    /// long as one may be cheaper than the best found.
    ///
    /// A part of a run says nothing about the rest: bodies may have a close encounter late.
    pub(super) fn measure_deviations(
        &self,
        mut configurations: Vec<MeasuredConfiguration>,
    ) -> Result<Findings, ExplainError> {
        let unknown = || ExplainError::NoMean {
            quantity: self.target.quantity.name,
            why: "the scene states no run time, or its method has no time step".to_owned(),
            enough: None,
            run: None,
        };
        let (time, own) = self.case.duration().zip(self.case.step()).ok_or_else(unknown)?;
        let (mut start, mut row) = (0.0, 0.0);
        // Without a target error the plan has to match the scene as it stands, which is run first.
        let wanted = match self.target.error {
            Some(width) => in_unit(width, 1.0),
            None => self.deviation_as_it_stands(&configurations, [time, own]).unwrap_or(WANTED),
        };
        while let Some((at, step)) = self.next_run(&configurations, [time, own], wanted) {
            let key = format!("whole run|{}|{step}", configurations[at].label);
            let Ok(run) = self.journal.recall(
                &key,
                |_| true,
                || self.whole_run(&configurations[at], step, [time, wanted]),
            ) else {
                break;
            };
            let configuration = &mut configurations[at];
            configuration.drift.get_or_insert_default().add(step, run.farthest);
            if let Some(costs) = run.costs {
                (start, row) = (costs.start, costs.row);
                (configuration.step, configuration.cost, configuration.phases) =
                    (Some(step), Some(costs.unit), costs.phases);
            }
        }
        self.own_run(&mut configurations, [time, own]);
        for configuration in configurations.iter_mut().filter(|configuration| configuration.dropped.is_none())
        {
            let why = match &configuration.drift {
                None => "no run of it was expected to be the cheapest, or none fitted into the trial time",
                Some(drift) if drift.least().is_infinite() => {
                    "its runs fail at every step that could be cheaper"
                }
                Some(_) => continue,
            };
            configuration.dropped = Some(why.to_owned());
        }
        if configurations.iter().all(|configuration| configuration.dropped.is_some()) {
            let cheapest = configurations
                .iter()
                .filter_map(|configuration| Some(configuration.cost? * configuration.step?))
                .fold(f64::INFINITY, f64::min);
            return Err(ExplainError::NoMean {
                quantity: self.target.quantity.name,
                why: "no run reached the end of the scene within the trial time".to_owned(),
                enough: Some(2.0 * cheapest / own * time).filter(|seconds| seconds.is_finite()),
                run: self.run_as_it_stands(&configurations),
            });
        }
        sort_by_cost(&mut configurations);
        self.unless_stopped(Findings {
            configurations,
            mean: MeanEstimate::exactly(0.0),
            mean_configuration: String::new(),
            whole: None,
            starts_differ: None,
            start,
            row,
            one_thread: 1.0,
            threads: rayon::current_num_threads(),
            without: vec![],
        })
    }

    /// Adds the deviation of the scene as it stands to its own configuration: its user knows its values, and no plan may be worse.
    fn own_run(&self, configurations: &mut [MeasuredConfiguration], of_scene: [f64; 2]) {
        let label = self.case.own.label();
        let farthest = self.deviation_as_it_stands(configurations, of_scene);
        let configuration = configurations.iter_mut().find(|configuration| configuration.label == label);
        if let (Some(configuration), Some(farthest)) = (configuration, farthest) {
            let drift = configuration.drift.get_or_insert_default();
            if drift.at(of_scene[1]).is_none() {
                drift.add(of_scene[1], farthest);
            }
        }
    }

    /// Deviation in a run of the scene as it stands; none where no time is left for it.
    fn deviation_as_it_stands(
        &self,
        configurations: &[MeasuredConfiguration],
        [time, own]: [f64; 2],
    ) -> Option<f64> {
        let label = self.case.own.label();
        let configuration = configurations.iter().find(|configuration| configuration.label == label)?;
        if let Some(known) = configuration.drift.as_ref().and_then(|drift| drift.at(own)) {
            return Some(known);
        }
        if configuration.cost? * configuration.step? / own * time > self.left() {
            return None;
        }
        let key = format!("as it stands|{label}|{own}");
        let run = || self.whole_run(configuration, own, [time, f64::INFINITY]);
        self.journal.recall(&key, |_| true, run).ok().map(|run| run.farthest)
    }

    /// Runs the whole scene and returns the deviation. If that is within `wanted` and starts are random, more starts are run, and the bound for
    /// another start with 95 % confidence is returned.
    fn whole_run(
        &self,
        configuration: &MeasuredConfiguration,
        step: f64,
        [time, wanted]: [f64; 2],
    ) -> Result<DeviationRun, MissingRun> {
        let first = self.run_of_start(configuration, step, time, 0)?;
        if self.case.prepared.seed.is_none() || first.farthest > wanted {
            return Ok(first);
        }
        let others: Vec<u64> = (1..STARTS).collect();
        let others: Result<Vec<DeviationRun>, MissingRun> =
            run_in_parallel(&others, |&number| self.run_of_start(configuration, step, time, number));
        let Ok(others) = others else {
            return Ok(DeviationRun { farthest: MARGIN * first.farthest, ..first });
        };
        let all: Vec<f64> = others.iter().chain([&first]).map(|it| it.farthest).collect();
        Ok(DeviationRun { farthest: deviation_bound(&all), ..first })
    }

    /// Runs a numbered start; a run that fails has an infinite deviation.
    fn run_of_start(
        &self,
        configuration: &MeasuredConfiguration,
        step: f64,
        time: f64,
        number: u64,
    ) -> Result<DeviationRun, MissingRun> {
        let left = self.left();
        if left == 0.0 {
            return Err(MissingRun(NO_TIME.to_owned()));
        }
        let observed = (self.case.entry.quantities, self.target.place);
        let sample =
            self.another_start(&configuration.overrides, Some(step), number).ok().and_then(|prepared| {
                self.trial.sample(&prepared, observed, SampleSpan::Time(time, Some(left))).ok()
            });
        let sample = match sample {
            Some(sample) => sample,
            None if self.left() == 0.0 => return Err(MissingRun(NO_TIME.to_owned())),
            None => return Ok(DeviationRun { farthest: f64::INFINITY, costs: None }),
        };
        let farthest = match sample.outcome {
            AverageOutcome::Kept { farthest, .. } => farthest,
            _ => f64::INFINITY,
        };
        let costs = RunCosts {
            start: sample.start,
            row: sample.row,
            unit: sample.cost,
            phases: sample.phases.clone(),
        };
        sample
            .early_end(time)
            .map_or(Ok(DeviationRun { farthest, costs: Some(costs) }), |why| Err(MissingRun(why)))
    }

    /// Returns index and step of the run that is expected to reach the error most cheaply; none where no time is left for it.
    fn next_run(
        &self,
        configurations: &[MeasuredConfiguration],
        [time, own]: [f64; 2],
        wanted: f64,
    ) -> Option<(usize, f64)> {
        let seconds = |configuration: &MeasuredConfiguration, step: f64| {
            Some(configuration.cost? * configuration.step? / step * time)
        };
        let reached = |configuration: &MeasuredConfiguration| {
            seconds(configuration, configuration.drift.as_ref()?.step_for(wanted)?.step)
        };
        let best = configurations.iter().filter_map(reached).fold(f64::INFINITY, f64::min);
        // Among configurations that differ in cost alone, only the cheapest is tried.
        let is_more_expensive = |configuration: &MeasuredConfiguration, other: &MeasuredConfiguration| {
            let [own, others] = [configuration, other].map(|it| self.choice(it));
            let is_alike = own.agrees_on(&others, ChoiceEffect::Order)
                && own.agrees_on(&others, ChoiceEffect::Precision);
            let cost = |it: &MeasuredConfiguration| Some(it.cost? * it.step?);
            other.dropped.is_none()
                && is_alike
                && cost(other).zip(cost(configuration)).is_some_and(|(b, a)| b < a)
        };
        let is_cheapest = |configuration: &MeasuredConfiguration| {
            configuration.drift.is_some()
                || !configurations.iter().any(|other| is_more_expensive(configuration, other))
        };
        let is_tried = |configuration: &MeasuredConfiguration| {
            configuration.dropped.is_none() && is_cheapest(configuration)
        };
        // Rounding is far below the error of a step: lower precisions begin at the step at which the highest precision reaches the error.
        let finest = self.case.own.with(self.case.entry.trials?.references[0]);
        let of_finest = |configuration: &MeasuredConfiguration| {
            let own = self.choice(configuration);
            let leads = |other: &&MeasuredConfiguration| {
                let other_choice = self.choice(other);
                let is_finest = other_choice.agrees_on(&finest, ChoiceEffect::Precision);
                is_tried(other) && is_finest && other_choice.agrees_on(&own, ChoiceEffect::Order)
            };
            configurations.iter().find(leads).filter(|leader| leader.label != configuration.label)
        };
        let first = |configuration: &MeasuredConfiguration| match of_finest(configuration) {
            Some(leader) => Some(leader.drift.as_ref()?.step_for(wanted)?.step),
            None if self.is_adaptive(&self.choice(configuration)) => Some(own),
            None => Some(rounded(LONGEST * own, 4)),
        };
        let is_settled = |configuration: &MeasuredConfiguration| {
            configuration.drift.is_some() && self.is_adaptive(&self.choice(configuration))
        };
        let runs = configurations
            .iter()
            .enumerate()
            .filter(|(_, configuration)| is_tried(configuration) && !is_settled(configuration))
            .filter_map(|(at, configuration)| {
                let step = configuration
                    .drift
                    .as_ref()
                    .map_or_else(|| first(configuration), |drift| drift.next_step(wanted))?;
                let enough = configuration.drift.as_ref().and_then(|drift| drift.expected_step(wanted));
                let [now, expected] =
                    [step, enough.unwrap_or(step).min(step)].map(|step| seconds(configuration, step));
                Some((at, step, now?, expected?))
            });
        let fits = |run: &(usize, f64, f64, f64)| run.3 < best && run.2 < best && run.2 <= self.left();
        let next = runs.filter(fits).min_by(|a, b| a.3.total_cmp(&b.3))?;
        Some((next.0, next.1))
    }
}

/// Returns the upper bound of the deviation of another start with 95 % confidence. Logarithms are assumed normally distributed: the next is
/// below their mean plus t s √(1 + 1/n), with the one-sided t of Student's distribution.
fn deviation_bound(all: &[f64]) -> f64 {
    let largest = all.iter().copied().fold(0.0, f64::max);
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    let count = all.len() as f64;
    let logarithms: Vec<f64> = all.iter().map(|&it| libm::log(it.max(f64::MIN_POSITIVE))).collect();
    let mean = logarithms.iter().sum::<f64>() / count;
    let variance = logarithms.iter().map(|it| (it - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let factor = student(TWO_SIDED, all.len() - 1) * (1.0 + 1.0 / count).sqrt();
    largest.max(libm::exp(mean + factor * variance.sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: t of 5 degrees of freedom is 2.015 (one-sided, 95 %); logarithms 0 and 1, three of each, have the mean 0.5 and the standard deviation 0.5477.
    #[test]
    fn deviation_bound_follows_from_scatter() {
        let all = [0.0, 1.0, 0.0, 1.0, 0.0, 1.0].map(libm::exp);
        let expected = 0.5 + 0.5477 * 2.015 * f64::sqrt(7.0 / 6.0);
        assert!((libm::log(deviation_bound(&all)) - expected).abs() < 1e-3);
        assert_eq!(deviation_bound(&[2.0; 6]), 2.0);
        assert_eq!(
            [deviation_bound(&[0.0; 6]), deviation_bound(&[1.0, f64::INFINITY])],
            [0.0, f64::INFINITY]
        );
    }
}
