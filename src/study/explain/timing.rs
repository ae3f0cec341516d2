//! What each way to run a scene costs, at the longest step that nothing speaks against.

use super::ExplainError;
use super::findings::{HALVINGS, NO_TIME, SHARES, Way, Work, sort};
use crate::study::{Choice, first_line};
use rayon::ThreadPoolBuilder;
use stripmine_physics::method::{Decides, StepLimit};
use stripmine_physics::number::significant;

/// The longest step that is tried, in parts of the shortest limit of theory: what lies at the limit itself fails for the fastest disc.
const OF_LIMIT: f64 = 0.9;
/// Where theory has no limit, the longest step is that many times the scene's own.
const TIMES_OWN: f64 = 4.0;
/// A way that costs this many times the best is followed no further.
const DEAR: f64 = 5.0;
/// How often each way is timed.
const ROUNDS: usize = 2;
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
        let each = SHARES[0] * self.seconds / 2.0;
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

    /// Ways with their costs, the cheapest first.
    ///
    /// Each is timed again after all the others: other programs come and go, and the faster time of both is the better one. None but the scene's own is begun after
    /// the end.
    fn timed(&self, choices: &[&Choice], seconds: f64, end: f64) -> Vec<Way> {
        let each = seconds / (ROUNDS * choices.len().max(1)) as f64;
        let is_over = || self.trial.watch.now() >= end;
        let of = |choice: &&Choice| {
            if is_over() && **choice != self.case.own {
                let dropped = Some(format!("not timed: {NO_TIME}"));
                return Way { dropped, ..untimed(choice) };
            }
            self.at_longest(choice, each)
        };
        let mut ways: Vec<Way> = choices.iter().map(of).collect();
        for _ in 1..ROUNDS {
            let limit = DEAR * least(&ways);
            for way in ways.iter_mut().filter(|way| way.cost.is_some_and(|cost| cost < limit)) {
                if is_over() {
                    break;
                }
                let again = self.prepared(&way.overrides, way.step).ok();
                let again = again.and_then(|prepared| self.trial.timed(&prepared, each).ok());
                let again = again.map(|it| it.seconds);
                way.cost = way.cost.into_iter().chain(again).reduce(f64::min);
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
        let seconds = 0.05 * self.seconds;
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

/// The cost of the cheapest.
fn least(ways: &[Way]) -> f64 {
    ways.iter().filter_map(|way| way.cost).fold(f64::INFINITY, f64::min)
}

/// Gives up those dearer than `DEAR` times the best: their results are the same.
fn give_up(ways: &mut [Way]) {
    let least = least(ways);
    for way in ways.iter_mut() {
        if let Some(cost) = way.cost.filter(|cost| *cost > DEAR * least) {
            way.dropped = Some(format!("costs {} times the cheapest", significant(cost / least, 2)));
        }
    }
    sort(ways);
}

fn bounded(limit: &StepLimit) -> String {
    format!("{}: {}", limit.name, limit.why)
}
