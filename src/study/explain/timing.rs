//! Cost of each configuration of a scene, at its longest usable step.

use super::findings::{HALVINGS, MeasuredConfiguration, NO_TIME, SceneTrials, sort_by_cost};
use super::{ExplainError, is_of_few};
use crate::study::{SettingChoice, first_line};
use rayon::ThreadPoolBuilder;
use stripmine_physics::method::{ChoiceEffect, StepLimit};
use stripmine_physics::number::significant;

/// Longest step tried, in parts of the smallest theoretical limit: at the limit itself the fastest disc fails.
pub(super) const OF_LIMIT: f64 = 0.9;
/// Longest step where theory has no limit, in steps of the scene.
const TIMES_OWN: f64 = 4.0;
/// Cost, relative to the cheapest, above which a configuration is dropped.
const EXPENSIVE: f64 = 5.0;
/// Most rounds of a race, and the first round in which times may tie.
const ROUNDS: usize = 5;
const TIE_FROM: usize = 3;
/// Factor by which the best must lead to end a race.
const LEAD: f64 = 1.25;
/// Share of the trial time for timing one thread, and all threads.
pub(super) const OF_ONE_THREAD: f64 = 0.02;
/// Factor for preparing and starting, which may take as long as the timing itself; nothing is timed beyond it.
const OVERHEAD: f64 = 2.0;

impl SceneTrials<'_> {
    /// Times every configuration at its longest step, and sorts them by cost.
    ///
    /// The cheapest search or engine is determined with the scene's own integrator and precision, as results are the same; then integrators and
    /// precisions are timed with it.
    pub(super) fn timed_configurations(&self) -> Result<Vec<MeasuredConfiguration>, ExplainError> {
        let all = SettingChoice::all(self.case.entry.axes);
        let own = &self.case.own;
        let of_own_arithmetic = |choice: &&SettingChoice| {
            choice.agrees_on(own, ChoiceEffect::Order) && choice.agrees_on(own, ChoiceEffect::Precision)
        };
        let mut searches: Vec<&SettingChoice> = all.iter().filter(of_own_arithmetic).collect();
        // The scene's own is timed first, whatever it costs.
        searches.sort_by_key(|choice| *choice != own);
        let each = self.shares[0] * self.seconds / 2.0;
        let end = |share: f64| self.end.min(self.trial.watch.now() + OVERHEAD * share);
        let mut configurations = self.timed(&searches, each, end(each));
        drop_expensive(&mut configurations);
        let every_one_fails = |configurations: &[MeasuredConfiguration]| {
            let all = configurations.iter();
            let tried = all.map(|it| (it.label.clone(), it.dropped.clone().unwrap_or_default()));
            let is_failure = configurations.iter().all(|configuration| configuration.cost.is_none());
            is_failure.then(|| ExplainError::EveryConfigurationFails(tried.collect()))
        };
        // Where its own integrator loses the orbits of few bodies, another may not.
        if let Some(error) = every_one_fails(&configurations).filter(|_| !is_of_few(self.case)) {
            return Err(error);
        }
        let best = configurations.iter().find(|configuration| configuration.cost.is_some());
        let best =
            best.and_then(|best| all.iter().find(|choice| choice.label() == best.label)).unwrap_or(own);
        let others: Vec<&SettingChoice> = all
            .iter()
            .filter(|choice| choice.agrees_on(best, ChoiceEffect::Cost) && !of_own_arithmetic(choice))
            .collect();
        configurations.extend(self.timed(&others, each, end(each)));
        if let Some(error) = every_one_fails(&configurations) {
            return Err(error);
        }
        sort_by_cost(&mut configurations);
        self.tune_skin(&mut configurations, each);
        Ok(configurations)
    }

    /// Times configurations in a race: all are timed, then the better half again for twice as long each, and so on until the best leads or their
    /// times overlap. After the deadline none but the scene's own is begun.
    ///
    /// The smallest of several times counts, as other programs disturb the others.
    fn timed(&self, choices: &[&SettingChoice], seconds: f64, end: f64) -> Vec<MeasuredConfiguration> {
        let mut each = seconds / (2 * choices.len().max(1)) as f64;
        let is_over = || self.trial.watch.now() >= end;
        let of = |choice: &&SettingChoice| {
            if is_over() && **choice != self.case.own {
                let dropped = Some(format!("not timed: {NO_TIME}"));
                return MeasuredConfiguration { dropped, ..untimed_configuration(choice) };
            }
            self.at_longest(choice, each)
        };
        let mut configurations: Vec<MeasuredConfiguration> = choices.iter().map(of).collect();
        let mut race = Race::of(&configurations);
        for _ in 1..ROUNDS {
            race.halve();
            if race.is_decided() {
                break;
            }
            each *= 2.0;
            for (at, times) in &mut race.racing {
                if is_over() {
                    break;
                }
                let again = self.prepared(&configurations[*at].overrides, configurations[*at].step).ok();
                times.extend(again.and_then(|it| self.trial.timed(&it, each).ok()).map(|it| it.seconds));
                configurations[*at].cost = times.iter().copied().reduce(f64::min);
            }
        }
        sort_by_cost(&mut configurations);
        configurations
    }

    /// Times a configuration at the longest step that theory allows and at which it runs.
    fn at_longest(&self, choice: &SettingChoice, seconds: f64) -> MeasuredConfiguration {
        let mut configuration = untimed_configuration(choice);
        let own_step = self.case.step();
        let prepared = match self.prepared(&configuration.overrides, None) {
            Ok(prepared) => prepared,
            Err(why) => {
                configuration.dropped = Some(format!("refused: {why}"));
                return configuration;
            }
        };
        let limit = prepared.step_limits.iter().min_by(|a, b| a.step.total_cmp(&b.step));
        let longest = own_step.map(|own| match limit {
            _ if self.is_adaptive(choice) => own,
            None => TIMES_OWN * own,
            Some(limit) => OF_LIMIT * limit.step,
        });
        configuration.bound = limit.map(bounded);
        let mut step = longest;
        for _ in 0..HALVINGS {
            let tried =
                self.prepared(&configuration.overrides, step).map_err(|why| format!("refused: {why}"));
            let tried = tried.and_then(|prepared| {
                self.trial.timed(&prepared, seconds).map_err(|failure| first_line(&failure.what_and_when()))
            });
            match tried {
                Ok(cost) => {
                    (configuration.cost, configuration.step, configuration.dropped) =
                        (Some(cost.seconds), step, None);
                    configuration.phases = cost.phases;
                    return configuration;
                }
                Err(why) => configuration.dropped = Some(why),
            }
            let Some(shorter) = step.map(|step| 0.5 * step) else { break };
            configuration.bound = configuration.dropped.clone();
            step = Some(shorter);
        }
        configuration
    }

    /// True if the steps of a configuration adapt, so that its step is an interval of output.
    pub(super) fn is_adaptive(&self, choice: &SettingChoice) -> bool {
        let (trials, scheme) = (self.case.entry.trials, choice.scheme());
        trials.zip(scheme).is_some_and(|(trials, scheme)| trials.adaptive.contains(&scheme.name))
    }

    /// Ratio of the cost with one thread to that with all threads.
    pub(super) fn one_thread(&self, configuration: &MeasuredConfiguration) -> f64 {
        let threads = rayon::current_num_threads();
        let seconds = OF_ONE_THREAD * self.seconds;
        let measured = || {
            if self.left() < 2.0 * seconds {
                return None;
            }
            let prepared = self.prepared(&configuration.overrides, configuration.step).ok()?;
            let all = self.trial.timed(&prepared, seconds).ok()?.seconds;
            let pool = ThreadPoolBuilder::new().num_threads(1).build().ok()?;
            Some(pool.install(|| self.trial.timed(&prepared, seconds)).ok()?.seconds / all)
        };
        // If unknown, several runs side by side are assumed to gain nothing.
        let unknown = threads as f64;
        if threads == 1 { 1.0 } else { measured().unwrap_or(unknown) }
    }
}

/// Configurations in a race, by index, each with its times.
struct Race {
    racing: Vec<(usize, Vec<f64>)>,
}

impl Race {
    fn of(configurations: &[MeasuredConfiguration]) -> Race {
        let timed = configurations
            .iter()
            .enumerate()
            .filter_map(|(at, configuration)| Some((at, vec![configuration.cost?])));
        Race { racing: timed.collect() }
    }

    /// Keeps the faster half, and all others within the lead of the best.
    fn halve(&mut self) {
        self.racing.sort_by(|a, b| least(&a.1).total_cmp(&least(&b.1)));
        let half = self.racing.len().div_ceil(2);
        let best = self.racing.first().map_or(f64::INFINITY, |(_, times)| least(times));
        let mut rank = 0;
        self.racing.retain(|(_, times)| {
            rank += 1;
            rank <= half || least(times) < LEAD * best
        });
    }

    /// True if the best leads, or the second is as good within the range of the best's two smallest times.
    fn is_decided(&self) -> bool {
        let [(_, best), (_, second), ..] = self.racing.as_slice() else { return true };
        let is_tie = || {
            let above = best.iter().copied().filter(|it| *it > least(best));
            best.len() >= TIE_FROM && least(second) <= above.fold(f64::INFINITY, f64::min)
        };
        least(second) > LEAD * least(best) || is_tie()
    }
}

fn least(times: &[f64]) -> f64 {
    times.iter().copied().fold(f64::INFINITY, f64::min)
}

/// A configuration without measurements.
fn untimed_configuration(choice: &SettingChoice) -> MeasuredConfiguration {
    MeasuredConfiguration {
        label: choice.label(),
        settings: choice.settings().map(|(axis, name)| (axis.to_owned(), name.to_owned())).collect(),
        overrides: choice.overrides(),
        cost: None,
        step: None,
        bound: None,
        skin: None,
        phases: vec![],
        bias: None,
        drift: None,
        dropped: None,
    }
}

/// Drops configurations that cost more than `EXPENSIVE` times the cheapest: their results are the same.
fn drop_expensive(configurations: &mut [MeasuredConfiguration]) {
    let costs: Vec<f64> = configurations.iter().filter_map(|configuration| configuration.cost).collect();
    let cheapest = least(&costs);
    for configuration in configurations.iter_mut() {
        if let Some(cost) = configuration.cost.filter(|cost| *cost > EXPENSIVE * cheapest) {
            configuration.dropped =
                Some(format!("costs {} times the cheapest", significant(cost / cheapest, 2)));
        }
    }
    sort_by_cost(configurations);
}

/// Describes a limit in words.
pub(super) fn bounded(limit: &StepLimit) -> String {
    format!("{}: {}", limit.name, limit.why)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn race(times: &[&[f64]]) -> Race {
        Race { racing: times.iter().map(|times| times.to_vec()).enumerate().collect() }
    }

    /// By hand: of 1, 1.2, 2 and 4 the faster half is 1 and 1.2; of 1, 1.2, 1.24, 1.3 and 4 three are kept, and no other is within a quarter of the
    /// best.
    #[test]
    fn race_keeps_the_faster_half() {
        let places = |mut race: Race| {
            race.halve();
            race.racing.into_iter().map(|(at, _)| at).collect::<Vec<_>>()
        };
        assert_eq!(places(race(&[&[4.0], &[1.0], &[2.0], &[1.2]])), [1, 3]);
        assert_eq!(places(race(&[&[1.3], &[1.2], &[4.0], &[1.0], &[1.24]])), [3, 1, 4]);
        assert_eq!(places(race(&[&[1.0], &[1.1], &[1.2], &[1.24]])), [0, 1, 2, 3]);
    }

    /// Decided by a lead of a quarter, or, from three times on, where the second is no slower than the best's second-best time.
    #[test]
    fn race_ends_by_lead_or_tie() {
        for (times, is_decided) in [
            (vec![&[1.0][..], &[1.26][..]], true),
            (vec![&[1.0][..], &[1.2][..]], false),
            (vec![&[1.0, 1.3][..], &[1.2, 1.2][..]], false),
            (vec![&[1.0, 1.3, 1.25][..], &[1.2, 1.3, 1.2][..]], true),
            (vec![&[1.0, 1.05, 1.1][..], &[1.2, 1.2, 1.2][..]], false),
            (vec![&[1.0][..]], true),
        ] {
            assert_eq!(race(&times).is_decided(), is_decided, "{times:?}");
        }
    }
}
