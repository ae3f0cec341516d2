//! Measures the deviation of conserved quantities over whole runs, step by step: long steps are cheap and come first.

use super::drift::{DeviationRun, RunCosts};
use super::findings::{Findings, MeasuredConfiguration, MissingRun, NO_TIME, SceneTrials, sort_by_cost};
use super::plan::{in_unit, overrides};
use super::recommended::LikelyRange;
use super::{ExplainError, PlanTarget, is_of_few};
use crate::results::run_in_parallel;
use crate::study::trial::{MeanEstimate, SampleSpan};
use crate::study::{StudyCase, first_line, rounded};
use stripmine_physics::averages::student;
use stripmine_physics::method::{ChoiceEffect, Prepared};
use stripmine_physics::scene::Overrides;

/// Longest step tried, in steps of the scene.
const LONGEST: f64 = 64.0;
/// Independent starts of a scene with a seed.
const STARTS: u64 = 6;
/// Factor on the deviation of one start where there is no time for several.
const MARGIN: f64 = 2.0;
/// Two-sided confidence whose upper end is that of 95 % one-sided.
const TWO_SIDED: f64 = 0.9;
/// Target error where none is given and the scene's own is unknown.
const WANTED: f64 = 1e-3;

/// Share of the trial time up to which the scene as it stands is run first, even if a target error is given.
const FIRST: f64 = 0.1;

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
        let most = match self.target.error {
            None => f64::INFINITY,
            Some(_) if is_of_few(self.case) => FIRST * self.seconds,
            Some(_) => 0.0,
        };
        let mut own_run = self.run_of_scene(&configurations, time, most);
        let wanted = wanted(self.case, self.target, own_run.as_ref());
        self.take_up_adaptive(&mut configurations, own_run.as_ref(), own);
        let reaching = own_run.as_ref().filter(|run| run.deviation.most <= wanted);
        let of_scene = reaching.and_then(|run| Some(run.costs.as_ref()?.unit * time));
        let known = (wanted, of_scene.unwrap_or(f64::INFINITY));
        while let Some((at, step)) = self.next_run(&configurations, [time, own], known) {
            let key = format!("whole run|{}|{step}", configurations[at].label);
            let Ok(run) = self.journal.recall(
                &key,
                |_| true,
                || {
                    let start = |number| self.planned_start(&configurations[at], step, number);
                    self.whole_run(&start, time, wanted)
                },
            ) else {
                break;
            };
            let configuration = &mut configurations[at];
            configuration.drift.get_or_insert_default().add(step, run.deviation);
            if let Some(costs) = run.costs {
                (start, row) = (costs.start, costs.row);
                (configuration.step, configuration.cost, configuration.phases) =
                    (Some(step), Some(costs.unit), costs.phases);
            }
        }
        own_run = own_run.or_else(|| self.run_of_scene(&configurations, time, f64::INFINITY));
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
        let is_finished = own_run.as_ref().is_some_and(|run| run.deviation.most.is_finite());
        if !is_finished && configurations.iter().all(|configuration| configuration.dropped.is_some()) {
            let of_scene = own_run.filter(|run| !run.faults.is_empty());
            let of_scene =
                of_scene.map_or(String::new(), |run| format!("; as it stands it fails: {}", run.faults));
            let cheapest = configurations
                .iter()
                .filter_map(|configuration| Some(configuration.cost? * configuration.step?))
                .fold(f64::INFINITY, f64::min);
            return Err(ExplainError::NoMean {
                quantity: self.target.quantity.name,
                why: format!("no run reached the end of the scene within the trial time{of_scene}"),
                enough: Some(2.0 * cheapest / own * time).filter(|seconds| seconds.is_finite()),
                run: self.run_as_it_stands(&configurations),
            });
        }
        sort_by_cost(&mut configurations);
        self.unless_stopped(Findings {
            configurations,
            own_run,
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

    /// Runs the scene as it stands: its user knows its values, and no plan may be worse. None where that takes longer than `most` (s) or the time left.
    fn run_of_scene(
        &self,
        configurations: &[MeasuredConfiguration],
        time: f64,
        most: f64,
    ) -> Option<DeviationRun> {
        // A scene that fails within the timing has no cost, and fails at once.
        let takes = self.run_as_it_stands(configurations).unwrap_or(0.0);
        if takes > self.left() || takes >= most {
            return None;
        }
        let run = || {
            self.whole_run(&|number| self.another_start(&Overrides::new(), None, number), time, f64::INFINITY)
        };
        self.journal.recall("as it stands", |_| true, run).ok()
    }

    /// Gives the run of the scene as it stands to its own configuration, if its steps adapt: there is no other step to try.
    fn take_up_adaptive(
        &self,
        configurations: &mut [MeasuredConfiguration],
        own_run: Option<&DeviationRun>,
        own: f64,
    ) {
        let of_own = configurations.iter_mut().find(|it| it.label == self.case.own.label());
        let Some((configuration, run)) = of_own.zip(own_run) else { return };
        let Some(costs) = run.costs.as_ref().filter(|_| self.is_adaptive(&self.case.own)) else { return };
        configuration.drift.get_or_insert_default().add(own, run.deviation);
        (configuration.step, configuration.cost, configuration.phases) =
            (Some(own), Some(costs.unit), costs.phases.clone());
    }

    /// Prepares a numbered start of the run that a plan with this step prints: bodies are few enough to be judged at its own rows and at every step.
    fn planned_start(
        &self,
        configuration: &MeasuredConfiguration,
        step: f64,
        number: u64,
    ) -> Result<Prepared, String> {
        if is_of_few(self.case) {
            let planned = overrides(self.case, configuration, Some(step), (None, 0.0));
            return self.another_start(&planned, None, number);
        }
        self.another_start(&configuration.overrides, Some(step), number)
    }

    /// Runs the whole scene from `start`, by the number of the start, and returns the deviation. If that is within `wanted` and starts are random, more
    /// starts are run, and the bound for another start with 95 % confidence is returned.
    fn whole_run(
        &self,
        start: &(dyn Fn(u64) -> Result<Prepared, String> + Sync),
        time: f64,
        wanted: f64,
    ) -> Result<DeviationRun, MissingRun> {
        let first = self.run_of_start(start(0), time)?;
        if self.case.prepared.seed.is_none() || first.deviation.most > wanted {
            return Ok(first);
        }
        let others: Vec<u64> = (1..STARTS).collect();
        let others: Result<Vec<DeviationRun>, MissingRun> =
            run_in_parallel(&others, |&number| self.run_of_start(start(number), time));
        let Ok(others) = others else {
            let deviation = LikelyRange { most: MARGIN * first.deviation.most, ..first.deviation };
            return Ok(DeviationRun { deviation, ..first });
        };
        let all: Vec<LikelyRange> = others.iter().chain([&first]).map(|it| it.deviation).collect();
        Ok(DeviationRun { deviation: deviation_of_starts(&all), ..first })
    }

    /// Runs a start to its end; a run that fails has an infinite deviation.
    fn run_of_start(&self, start: Result<Prepared, String>, time: f64) -> Result<DeviationRun, MissingRun> {
        let left = self.left();
        if left == 0.0 {
            return Err(MissingRun(NO_TIME.to_owned()));
        }
        let observed = (self.case.quantities(), self.target.place);
        let span = if is_of_few(self.case) { SampleSpan::Planned } else { SampleSpan::Time };
        let sample = start.and_then(|prepared| {
            let sample = self.trial.sample(&prepared, observed, span(time, Some(left)));
            sample.map_err(|failure| first_line(&failure.what_and_when()))
        });
        let failed = |faults: String| DeviationRun {
            deviation: LikelyRange::exactly(f64::INFINITY),
            costs: None,
            faults,
        };
        let sample = match sample {
            Ok(sample) => sample,
            Err(_) if self.left() == 0.0 => return Err(MissingRun(NO_TIME.to_owned())),
            Err(why) => return Ok(failed(why)),
        };
        if let Some(why) = sample.early_end(time) {
            return Err(MissingRun(why));
        }
        let Some([least, most]) = sample.deviations() else {
            return Ok(failed(sample.missing_mean_reason()));
        };
        let (start, row, unit, faults) = (sample.start, sample.row, sample.cost, sample.warning_text());
        let costs = RunCosts { start, row, unit, phases: sample.phases };
        Ok(DeviationRun { deviation: LikelyRange { least, likely: most, most }, costs: Some(costs), faults })
    }

    /// Returns index and step of the run that is expected to reach the error most cheaply; none where no time is left for it, or where the scene as it
    /// stands, which takes `of_scene` (s), is cheaper.
    fn next_run(
        &self,
        configurations: &[MeasuredConfiguration],
        [time, own]: [f64; 2],
        (wanted, of_scene): (f64, f64),
    ) -> Option<(usize, f64)> {
        let seconds = |configuration: &MeasuredConfiguration, step: f64| {
            Some(configuration.cost? * configuration.step? / step * time)
        };
        let reached = |configuration: &MeasuredConfiguration| {
            seconds(configuration, configuration.drift.as_ref()?.step_for(wanted)?.step)
        };
        let best = configurations.iter().filter_map(reached).fold(of_scene, f64::min);
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

/// Returns the error that a plan has to reach: the requested one, or that of the scene as it stands, unless its run fails, or warns of few bodies.
pub(super) fn wanted(case: &StudyCase, target: &PlanTarget, own_run: Option<&DeviationRun>) -> f64 {
    let is_example = |run: &&DeviationRun| run.faults.is_empty() || !is_of_few(case);
    let of_scene =
        || own_run.filter(is_example).map(|run| run.deviation.most).filter(|most| most.is_finite());
    target.error.map(|width| in_unit(width, 1.0)).or_else(of_scene).unwrap_or(WANTED)
}

/// Returns the deviation of another start from those of some starts: the smallest, the typical one, and the bound with 95 % confidence.
fn deviation_of_starts(all: &[LikelyRange]) -> LikelyRange {
    let largest: Vec<f64> = all.iter().map(|it| it.most).collect();
    let typical =
        largest.iter().map(|&it| libm::log(it.max(f64::MIN_POSITIVE))).sum::<f64>() / all.len() as f64;
    LikelyRange {
        least: all.iter().map(|it| it.least).fold(f64::INFINITY, f64::min),
        likely: libm::exp(typical),
        most: deviation_bound(&largest),
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
