//! Wall time of a plan relative to the best of a grid: every integrator and precision, at several steps, with the cheapest search.

use super::super::lengths::{SAMPLES, StatisticalError};
use super::super::recommended::RunPlan;
use super::super::timing::OF_LIMIT;
use super::reference::ReferenceMean;
use super::runs::{StartEnsemble, WHOLE, side_by_side};
use super::verdict::PlanVerdict;
use crate::study::SettingChoice;
use crate::study::trial::SampleSpan;
use rayon::ThreadPoolBuilder;
use stripmine_physics::averages::{MeanWithBar, mean_of_independent};
use stripmine_physics::method::{ChoiceEffect, Prepared};
use stripmine_physics::number::significant;
use stripmine_physics::scene::Overrides;

/// Steps, in parts of the longest.
const STEPS: [f64; 4] = [1.0, 0.5, 0.25, 0.125];
/// Longest step where theory has no limit, in steps of the scene.
const TIMES_OWN: f64 = 4.0;
/// Share of the time for timing the searches.
const SEARCHES: f64 = 0.1;
/// Factor on its share of the time after which a run of a conserved quantity is stopped.
const LATE: f64 = 5.0;
/// Number of the first start of the grid.
const STARTS: usize = 20_000;

/// A configuration at a step, as measured with one thread.
#[derive(Clone, Debug)]
struct GridPoint {
    choice: SettingChoice,
    step: Option<f64>,
    /// Wall seconds of a unit of time, of a row, and of a run apart from these.
    cost: f64,
    row: f64,
    start: f64,
    /// Difference from the reference mean and its error bar, or deviation of a conserved quantity.
    off: [f64; 2],
}

/// Wall times relative to the best of the grid.
#[derive(Clone, Debug)]
pub(crate) struct RelativeCosts {
    pub(crate) plan: f64,
    /// Cost of the plan's configuration and step, run for as long as the reference requires; none where their bias exceeds the error.
    pub(crate) choice: Option<f64>,
    /// Costs of the scene's own values, of neighbour lists always, and of the scene's own integrator in f64 at its longest step; none where the error
    /// is not reached, or the method has no such configuration.
    pub(crate) baselines: [Option<f64>; 3],
    /// Best configuration of the grid, and its wall seconds.
    pub(crate) best: String,
    pub seconds: f64,
}

/// A scene with every configuration measured.
pub(crate) struct ConfigurationGrid<'g> {
    of: &'g StartEnsemble<'g>,
    reference: ReferenceMean,
    chance: StatisticalError,
    points: Vec<GridPoint>,
    /// Measurements of the plans, in their order; none where the run failed.
    plans: Vec<Option<GridPoint>>,
    /// Longest step of the scene's own integrator in f64 (time).
    limit: Option<f64>,
    /// Time with neighbour lists relative to the cheapest search; none without lists.
    lists: Option<f64>,
    /// Time with one thread relative to all threads.
    speedup: f64,
}

impl<'g> ConfigurationGrid<'g> {
    /// Measures the grid and the plans, in about `seconds` of wall time.
    pub(super) fn of(
        of: &'g StartEnsemble<'g>,
        reference: ReferenceMean,
        plans: &[&RunPlan],
        seconds: f64,
    ) -> Result<ConfigurationGrid<'g>, String> {
        let case = of.case;
        let all = SettingChoice::all(case.entry.axes);
        let (search, lists) = of.cheapest_search(&all, SEARCHES * seconds)?;
        let is_of_search = |choice: &&SettingChoice| choice.agrees_on(&search, ChoiceEffect::Cost);
        let mut asked: Vec<(SettingChoice, Overrides, Option<f64>)> = vec![];
        for choice in all.iter().filter(is_of_search) {
            let longest = of.longest(choice);
            let own = case.step().filter(|_| choice.agrees_on(&case.own, ChoiceEffect::Order));
            let steps: Vec<Option<f64>> = match longest {
                Some(longest) => STEPS.map(|part| part * longest).into_iter().chain(own).map(Some).collect(),
                None => vec![None],
            };
            asked.extend(
                steps.into_iter().map(|step| (choice.clone(), of.at(&choice.overrides(), step), step)),
            );
        }
        let of_grid = asked.len();
        asked.extend(plans.iter().map(|plan| {
            let choice = all.iter().find(|choice| choice.label() == plan.configuration).unwrap_or(&case.own);
            (choice.clone(), plan.overrides.clone(), plan.step)
        }));
        let share = seconds * rayon::current_num_threads() as f64 / asked.len() as f64;
        let measured = side_by_side(asked.len(), |at| {
            let (choice, overrides, step) = &asked[at];
            of.point(choice, *step, overrides, STARTS + at, share, &reference)
        });
        let mut points: Vec<Option<GridPoint>> =
            measured.map_err(|error| error.to_string())?.into_iter().map(Result::ok).collect();
        let plans = points.split_off(of_grid);
        let in_f64 = case.own.with(&[("precision", "f64")]);
        Ok(ConfigurationGrid {
            reference,
            chance: StatisticalError::of(&reference.known, of.asking.whole),
            points: points.into_iter().flatten().collect(),
            plans,
            limit: of.longest(&in_f64),
            lists,
            speedup: of.speedup(&search, SEARCHES * seconds)?,
            of,
        })
    }

    /// Costs of a numbered plan for an error, with the bias of its runs; none where nothing reaches the error or the plan was not measured.
    pub(crate) fn costs(
        &self,
        number: usize,
        plan: &RunPlan,
        verdict: &PlanVerdict,
        error: f64,
    ) -> Option<RelativeCosts> {
        let all: Vec<(&GridPoint, f64)> = (self.points.iter())
            .filter_map(|point| Some((point, self.seconds(point, bias(point.off), error)?)))
            .collect();
        let cheapest = |of: &dyn Fn(&GridPoint) -> bool| {
            let all = all.iter().filter(|(point, _)| of(point));
            all.min_by(|a, b| a.1.total_cmp(&b.1)).copied()
        };
        let (best, seconds) = cheapest(&|_| true)?;
        let own = &self.of.case.own;
        let is_near = |point: &GridPoint, step: Option<f64>| match (point.step, step) {
            (Some(own), Some(other)) => (own / other - 1.0).abs() < 1e-9,
            (own, other) => own.is_none() && other.is_none(),
        };
        let has_own = |point: &GridPoint, decides: ChoiceEffect| point.choice.agrees_on(own, decides);
        let of_own = cheapest(&|point| {
            has_own(point, ChoiceEffect::Order)
                && has_own(point, ChoiceEffect::Precision)
                && is_near(point, self.of.case.step())
        });
        let in_f64 = own.with(&[("precision", "f64")]);
        let at_limit = cheapest(&|point| {
            has_own(point, ChoiceEffect::Order)
                && point.choice.agrees_on(&in_f64, ChoiceEffect::Precision)
                && is_near(point, self.limit)
        });
        let planned = self.plans[number].as_ref()?;
        // The runs of the plan know the bias better than a run within a share of the grid's time.
        let known = match self.of.target.is_kept() {
            true => bias(planned.off),
            false => bias([verdict.bias.value * error, verdict.bias.bar * error]),
        };
        let needed = self.seconds(planned, known, error);
        let taken = self.as_planned(planned, plan);
        Some(RelativeCosts {
            plan: needed.map_or(taken, |needed| needed.max(taken)) / seconds,
            choice: needed.map(|needed| needed / seconds),
            baselines: [of_own.map(|(_, it)| it / seconds), self.lists, at_limit.map(|(_, it)| it / seconds)],
            best: in_words(best),
            seconds,
        })
    }

    /// Wall seconds of a plan as stated.
    fn as_planned(&self, point: &GridPoint, plan: &RunPlan) -> f64 {
        let rows = point.start + point.row * plan.rows;
        match plan.seeds {
            1 => rows + point.cost / self.speedup * plan.time,
            seeds => {
                let rounds = (seeds as f64 / rayon::current_num_threads() as f64).ceil();
                rounds * (rows + point.cost * plan.time)
            }
        }
    }

    /// Wall seconds in which a configuration reaches an error, by the rules of plans; none where its bias exceeds the error.
    fn seconds(&self, point: &GridPoint, bias: f64, error: f64) -> Option<f64> {
        let left = Some(error - bias).filter(|left| *left > 0.0)?;
        let cores = rayon::current_num_threads() as f64;
        let known = &self.reference.known;
        let rows = |time: f64| point.start + point.row * known.rows_in(time);
        let alone = |time: f64| rows(time) + point.cost / self.speedup * time;
        let one_of_several = |time: f64| rows(time) + point.cost * time;
        if self.of.target.is_kept() {
            return Some(alone(self.of.case.duration()?));
        }
        let time = self.chance.time_for(left);
        if let Some(whole) = self.of.asking.whole {
            let runs = (time / whole).ceil().max(1.0);
            return Some(if runs == 1.0 {
                alone(whole)
            } else {
                (runs / cores).ceil() * one_of_several(whole)
            });
        }
        let least = known.transient.max(SAMPLES * known.apart);
        let time = time.max(least);
        let apart = (time / cores > least).then(|| one_of_several(time / cores + known.transient));
        Some(apart.into_iter().fold(alone(time + known.transient), f64::min))
    }
}

/// Returns the expected bias from a measured difference and its bar. Noise alone is not a bias.
fn bias([off, bar]: [f64; 2]) -> f64 {
    if off.abs() > bar { off.abs() } else { (off * off - 0.25 * bar * bar).max(0.0).sqrt() }
}

/// Label of the configuration and its step.
fn in_words(point: &GridPoint) -> String {
    let step = point.step.map(|step| format!(", dt {}", significant(step, 2)));
    point.choice.label() + &step.unwrap_or_default()
}

impl StartEnsemble<'_> {
    /// Overrides of a configuration with a step (time).
    fn at(&self, overrides: &Overrides, step: Option<f64>) -> Overrides {
        match self.case.entry.trials.zip(step) {
            Some((trials, step)) => overrides.clone().set(trials.step, step),
            None => overrides.clone(),
        }
    }

    /// Longest step of a configuration that theory allows (time).
    fn longest(&self, choice: &SettingChoice) -> Option<f64> {
        let own = self.case.step()?;
        let prepared = self.case.prepared_with(&choice.overrides()).ok()?;
        let limit = prepared.step_limits.iter().map(|limit| limit.step).reduce(f64::min);
        Some(limit.map_or(TIMES_OWN * own, |limit| OF_LIMIT * limit))
    }

    /// Wall seconds of a unit of time with one thread.
    fn timed(&self, prepared: &Prepared, seconds: f64) -> Result<f64, String> {
        let pool = ThreadPoolBuilder::new().num_threads(1).build().map_err(|error| error.to_string())?;
        pool.install(|| self.trial.timed(prepared, seconds))
            .map(|cost| cost.seconds)
            .map_err(|it| it.to_string())
    }

    /// Returns the cheapest search with the scene's own integrator, precision and step, and the time with neighbour lists relative to it.
    fn cheapest_search(
        &self,
        all: &[SettingChoice],
        seconds: f64,
    ) -> Result<(SettingChoice, Option<f64>), String> {
        let own = &self.case.own;
        let is_alike = |it: &&SettingChoice| {
            it.agrees_on(own, ChoiceEffect::Order) && it.agrees_on(own, ChoiceEffect::Precision)
        };
        let searches: Vec<&SettingChoice> = all.iter().filter(is_alike).collect();
        let each = seconds / searches.len() as f64;
        let mut timed: Vec<(&SettingChoice, f64)> = searches
            .into_iter()
            .filter_map(|choice| {
                let prepared = self.case.prepared_with(&choice.overrides()).ok()?;
                Some((choice, self.timed(&prepared, each).ok()?))
            })
            .collect();
        timed.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (best, least) = timed.first().ok_or("no neighbour search can run the scene")?;
        let by_lists =
            |it: &&(&SettingChoice, f64)| it.0.settings().any(|it| it == ("search", "neighbor-list"));
        let lists = timed.iter().find(by_lists).map(|(_, cost)| cost / least);
        Ok(((*best).clone(), lists))
    }

    /// Time with one thread relative to all threads.
    fn speedup(&self, choice: &SettingChoice, seconds: f64) -> Result<f64, String> {
        let prepared = self.case.prepared_with(&choice.overrides()).map_err(|errors| errors.to_string())?;
        let all = self.trial.timed(&prepared, 0.5 * seconds).map_err(|failure| failure.to_string())?;
        Ok(self.timed(&prepared, 0.5 * seconds)? / all.seconds)
    }

    /// Measures a configuration in about `seconds`.
    fn point(
        &self,
        choice: &SettingChoice,
        step: Option<f64>,
        overrides: &Overrides,
        number: usize,
        seconds: f64,
        reference: &ReferenceMean,
    ) -> Result<GridPoint, String> {
        let prepared = self.start(overrides, number)?;
        let span = match (self.target.is_kept(), self.asking.whole) {
            (true, _) => SampleSpan::Time(
                self.case.duration().ok_or("the scene states no run time")?,
                Some(LATE * seconds),
            ),
            (_, Some(time)) => SampleSpan::Time(time, None),
            _ => SampleSpan::Seconds(seconds),
        };
        let begun = self.trial.watch.now();
        let first = self.sample(&prepared, span)?;
        if !first.warnings.is_empty() {
            return Err(first.warning_text());
        }
        let off = match (first.deviations(), self.asking.whole) {
            (Some([_, largest]), _) => [largest, 0.0],
            (_, None) => {
                let known = first.known().ok_or_else(|| first.missing_mean_reason())?;
                [known.mean - reference.known.mean, known.bar.hypot(reference.known.bar)]
            }
            (_, Some(_)) => {
                let mut means = vec![first.mean_over(WHOLE)];
                while means.len() < 2 || self.trial.watch.now() - begun < seconds {
                    let next = self.start(overrides, number + STARTS * means.len())?;
                    means.push(self.sample(&next, span)?.mean_over(WHOLE));
                }
                let MeanWithBar { value, bar } =
                    mean_of_independent(&means).ok_or("only one run finished")?;
                [value - reference.known.mean, bar.hypot(reference.known.bar)]
            }
        };
        Ok(GridPoint {
            choice: choice.clone(),
            step,
            cost: first.cost,
            row: first.row,
            start: first.start,
            off,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::runs::EstimatedMean;
    use super::*;
    use crate::study::StudyCase;
    use crate::study::explain::{PlanTarget, certified::by_trials};
    use crate::study::trial::{MeanEstimate, Stopwatch, TrialControl};
    use std::sync::atomic::AtomicBool;
    use stripmine_physics::method::METHODS;
    use stripmine_physics::scene::Width;

    #[test]
    fn noise_is_no_bias() {
        assert_eq!([bias([-0.3, 0.2]), bias([0.1, 0.4])], [0.3, 0.0]);
        assert!((bias([0.3, 0.4]) - (0.09f64 - 0.04).sqrt()).abs() < 1e-15);
    }

    /// By hand. The square of an error bar is 16 in a unit of time, known exactly; the transient is 3, so an error of 0.5 without bias takes 64 + 3,
    /// with a bias of 0.1 100 + 3. The speed of a hundred threads makes no plan of several runs cheaper.
    #[test]
    fn costs_are_relative_to_the_best_configuration() {
        let case = StudyCase::load("dense-gas", &["particles.count=100".to_owned()], METHODS).unwrap();
        let (watch, stop) = (Stopwatch::with_synthetic_time(400.0), AtomicBool::new(false));
        let trial = TrialControl { watch: &watch, stop: &stop };
        let target = PlanTarget::of(&case, Some("pressure"), Some(Width::Percent(20.0))).unwrap();
        let plan = by_trials(&case, &target, 2.0, trial).unwrap();
        let plan = RunPlan { seeds: 1, time: 100.0, is_whole: false, starts_differ: None, ..plan };
        let asking = EstimatedMean::from(&plan);
        let of = StartEnsemble { case: &case, target: &target, trial, asking };
        let known = MeanEstimate { square: 16.0, transient: 3.0, apart: 1.0, ..MeanEstimate::exactly(7.0) };
        let point = |choice: &SettingChoice, step: f64, cost: f64, off: [f64; 2]| GridPoint {
            choice: choice.clone(),
            step: Some(step),
            cost: 100.0 * cost,
            row: 0.0,
            start: 1.0,
            off,
        };
        let (own, step) = (case.own.clone(), case.step().unwrap());
        let other = own.with(&[("integrator", "velocity-verlet")]);
        let grid = |points: Vec<GridPoint>, planned: GridPoint| ConfigurationGrid {
            of: &of,
            reference: ReferenceMean { known, step: None },
            chance: StatisticalError::of(&known, None),
            points,
            plans: vec![Some(planned)],
            limit: Some(2.0 * step),
            lists: Some(1.5),
            speedup: 100.0,
        };
        let points = vec![
            point(&own, step, 0.1, [0.0, 0.0]),
            point(&own, 2.0 * step, 0.05, [0.1, 0.01]),
            // Cheaper, with a bias above the error.
            point(&other, 4.0 * step, 0.01, [0.6, 0.1]),
        ];
        let [of_own, best] = [1.0 + 0.1 * 67.0, 1.0 + 0.05 * 103.0];
        let verdict = |bias: f64| PlanVerdict::of(&[Ok(7.0 + bias), Ok(7.0 + bias)], [7.0, 0.0], 0.5);
        let costs = |cost: f64, bias: f64| {
            let found = grid(points.clone(), point(&own, 2.0 * step, cost, [0.0, 0.0]));
            found.costs(0, &plan, &verdict(bias), 0.5).unwrap()
        };
        let found = costs(0.08, 0.0);
        assert!((found.seconds - best).abs() < 1e-12 && found.best.contains("dt"), "{found:?}");
        // Planned for a time of 100, more than the 67 that are needed.
        assert!((found.plan - 9.0 / best).abs() < 1e-12, "{found:?}");
        let [by_own, lists, at_limit] = found.baselines.map(Option::unwrap);
        assert!((by_own - of_own / best).abs() < 1e-12 && (at_limit - 1.0).abs() < 1e-12 && lists == 1.5);
        // A bias of 0.2 needs a time of 16/0.09 = 177.8, more than was planned.
        let biased = costs(0.08, 0.2);
        assert!((biased.plan - (1.0 + 0.08 * (16.0 / 0.09 + 3.0)) / best).abs() < 1e-9, "{biased:?}");
        // Nothing reaches an error below every bias.
        let none = grid(points[1..].to_vec(), points[1].clone());
        assert!(none.costs(0, &plan, &verdict(0.0), 0.05).is_none());
    }
}
