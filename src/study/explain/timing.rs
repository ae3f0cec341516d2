//! What each way to run a scene costs, at the longest step that nothing speaks against.

use super::ExplainError;
use super::findings::{HALVINGS, NO_TIME, Way, Work, sort};
use crate::study::{Choice, first_line};
use rayon::ThreadPoolBuilder;
use stripmine_physics::method::{Decides, StepLimit};
use stripmine_physics::number::significant;

/// The longest step that is tried, in parts of the shortest limit of theory: what lies at the limit itself fails for the fastest disc.
pub(super) const OF_LIMIT: f64 = 0.9;
/// Where theory has no limit, the longest step is that many times the scene's own.
const TIMES_OWN: f64 = 4.0;
/// A way that costs this many times the best is followed no further.
const DEAR: f64 = 5.0;
/// Rounds of a race at most, and those from which on bars tell a tie.
const ROUNDS: usize = 5;
const TIE_FROM: usize = 3;
/// A race is over when the best leads by this factor.
const LEAD: f64 = 1.25;
/// Part of the time in which one thread is timed, and all of them.
pub(super) const OF_ONE_THREAD: f64 = 0.02;
/// Preparing and starting may take as long as the timing itself, and what is left after that is not timed.
const OVERHEAD: f64 = 2.0;

impl Work<'_> {
    /// Every way with its cost at its longest step, the cheapest first.
    ///
    /// Which search or engine is the cheapest is measured with the scene's own integrator and digits, for results are the same; then the integrators
    /// and digits with that.
    pub(super) fn timed_ways(&self) -> Result<Vec<Way>, ExplainError> {
        let all = Choice::all(self.case.entry.axes);
        let own = &self.case.own;
        let of_own_arithmetic =
            |choice: &&Choice| choice.agrees(own, Decides::Order) && choice.agrees(own, Decides::Digits);
        let mut searches: Vec<&Choice> = all.iter().filter(of_own_arithmetic).collect();
        // The scene's own is timed whatever that takes.
        searches.sort_by_key(|choice| *choice != own);
        let each = self.shares[0] * self.seconds / 2.0;
        let end = |share: f64| self.end.min(self.trial.watch.now() + OVERHEAD * share);
        let mut ways = self.timed(&searches, each, end(each));
        give_up(&mut ways);
        let Some(best) = ways.iter().position(|way| way.cost.is_some()).map(|at| ways[at].label.clone())
        else {
            let tried = ways.into_iter().map(|way| (way.label, way.dropped.unwrap_or_default()));
            return Err(ExplainError::EveryWayFails(tried.collect()));
        };
        let best = all.iter().find(|choice| choice.label() == best).unwrap_or(own);
        let others: Vec<&Choice> = all
            .iter()
            .filter(|choice| choice.agrees(best, Decides::Cost) && !of_own_arithmetic(choice))
            .collect();
        ways.extend(self.timed(&others, each, end(each)));
        sort(&mut ways);
        self.tune_skin(&mut ways, each);
        Ok(ways)
    }

    /// Configurations with their costs, the cheapest first, by a race: all are timed, then the better half again for twice as long each, and so on until the
    /// best leads or their bars overlap. None but the scene's own is begun after the end.
    ///
    /// Other programs come and go: of several times the least counts.
    fn timed(&self, choices: &[&Choice], seconds: f64, end: f64) -> Vec<Way> {
        let mut each = seconds / (2 * choices.len().max(1)) as f64;
        let is_over = || self.trial.watch.now() >= end;
        let of = |choice: &&Choice| {
            if is_over() && **choice != self.case.own {
                let dropped = Some(format!("not timed: {NO_TIME}"));
                return Way { dropped, ..untimed(choice) };
            }
            self.at_longest(choice, each)
        };
        let mut ways: Vec<Way> = choices.iter().map(of).collect();
        let mut race = Race::of(&ways);
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
                let again = self.prepared(&ways[*at].overrides, ways[*at].step).ok();
                times.extend(again.and_then(|it| self.trial.timed(&it, each).ok()).map(|it| it.seconds));
                ways[*at].cost = times.iter().copied().reduce(f64::min);
            }
        }
        sort(&mut ways);
        ways
    }

    /// A way at the longest step that theory has nothing against and at which it runs.
    fn at_longest(&self, choice: &Choice, seconds: f64) -> Way {
        let mut way = untimed(choice);
        let own_step = self.case.step();
        let prepared = match self.prepared(&way.overrides, None) {
            Ok(prepared) => prepared,
            Err(why) => {
                way.dropped = Some(format!("refused: {why}"));
                return way;
            }
        };
        let limit = prepared.step_limits.iter().min_by(|a, b| a.step.total_cmp(&b.step));
        let longest = own_step.map(|own| limit.map_or(TIMES_OWN * own, |limit| OF_LIMIT * limit.step));
        way.bound = limit.map(bounded);
        let mut step = longest;
        for _ in 0..HALVINGS {
            let tried = self.prepared(&way.overrides, step).map_err(|why| format!("refused: {why}"));
            let tried = tried.and_then(|prepared| {
                self.trial.timed(&prepared, seconds).map_err(|failure| first_line(&failure.what()))
            });
            match tried {
                Ok(cost) => {
                    (way.cost, way.step, way.dropped) = (Some(cost.seconds), step, None);
                    way.phases = cost.phases;
                    return way;
                }
                Err(why) => way.dropped = Some(why),
            }
            let Some(shorter) = step.map(|step| 0.5 * step) else { break };
            way.bound = way.dropped.clone();
            step = Some(shorter);
        }
        way
    }

    /// What one thread takes over what all of them take.
    pub(super) fn one_thread(&self, way: &Way) -> f64 {
        let threads = rayon::current_num_threads();
        let seconds = OF_ONE_THREAD * self.seconds;
        let measured = || {
            if self.left() < 2.0 * seconds {
                return None;
            }
            let prepared = self.prepared(&way.overrides, way.step).ok()?;
            let all = self.trial.timed(&prepared, seconds).ok()?.seconds;
            let pool = ThreadPoolBuilder::new().num_threads(1).build().ok()?;
            Some(pool.install(|| self.trial.timed(&prepared, seconds)).ok()?.seconds / all)
        };
        // Where that is not known, several runs side by side are no gain.
        let unknown = threads as f64;
        if threads == 1 { 1.0 } else { measured().unwrap_or(unknown) }
    }
}

/// Configurations that race, by their places, each with its times.
struct Race {
    racing: Vec<(usize, Vec<f64>)>,
}

impl Race {
    fn of(ways: &[Way]) -> Race {
        let timed = ways.iter().enumerate().filter_map(|(at, way)| Some((at, vec![way.cost?])));
        Race { racing: timed.collect() }
    }

    /// Leaves the better half, and all others that the best does not lead.
    fn halve(&mut self) {
        self.racing.sort_by(|a, b| least(&a.1).total_cmp(&least(&b.1)));
        let half = self.racing.len().div_ceil(2);
        let best = self.racing.first().map_or(f64::INFINITY, |(_, times)| least(times));
        let mut place = 0;
        self.racing.retain(|(_, times)| {
            place += 1;
            place <= half || least(times) < LEAD * best
        });
    }

    /// True if the best leads, or the second is as good within the range of the best's two least times.
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

/// A way of which nothing is known.
fn untimed(choice: &Choice) -> Way {
    Way {
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

/// Gives up those dearer than `DEAR` times the best: their results are the same.
fn give_up(ways: &mut [Way]) {
    let costs: Vec<f64> = ways.iter().filter_map(|way| way.cost).collect();
    let cheapest = least(&costs);
    for way in ways.iter_mut() {
        if let Some(cost) = way.cost.filter(|cost| *cost > DEAR * cheapest) {
            way.dropped = Some(format!("costs {} times the cheapest", significant(cost / cheapest, 2)));
        }
    }
    sort(ways);
}

/// A limit in words.
pub(super) fn bounded(limit: &StepLimit) -> String {
    format!("{}: {}", limit.name, limit.why)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn race(times: &[&[f64]]) -> Race {
        Race { racing: times.iter().map(|times| times.to_vec()).enumerate().collect() }
    }

    /// By hand: of 1, 1.2, 2 and 4 the half is 1 and 1.2; of 1, 1.2, 1.24, 1.3 and 4 three are the half, and none beyond is within a quarter of the best.
    #[test]
    fn the_better_half_races_on() {
        let places = |mut race: Race| {
            race.halve();
            race.racing.into_iter().map(|(at, _)| at).collect::<Vec<_>>()
        };
        assert_eq!(places(race(&[&[4.0], &[1.0], &[2.0], &[1.2]])), [1, 3]);
        assert_eq!(places(race(&[&[1.3], &[1.2], &[4.0], &[1.0], &[1.24]])), [3, 1, 4]);
        assert_eq!(places(race(&[&[1.0], &[1.1], &[1.2], &[1.24]])), [0, 1, 2, 3]);
    }

    /// Decided by a lead of a quarter, or, from three times on, where the second is no slower than the best was at its second-best.
    #[test]
    fn a_race_ends_by_a_lead_or_a_tie() {
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
