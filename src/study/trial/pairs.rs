//! Pairs of runs: several configurations from common states, compared.
//!
//! Two runs from one state stay together for some Lyapunov times, so that the difference of their means over a short window scatters far less than
//! the difference of two independent means. The change of the configuration moves a quantity at once by a, which it forgets with its memory τ, and in the
//! course of that to its bias b in the steady state: d(t) = b (1 − exp(−t/τ)) + a exp(−t/τ). The mean over the second half of a window w is
//! b g + a (1 − g) with g = 1 − (2τ/w)(exp(−w/2τ) − exp(−w/τ)), so that two windows tell both a and b.

use super::Trial;
use crate::study::first_line;
use rayon::iter::{IndexedParallelIterator, IntoParallelRefMutIterator, ParallelIterator};
use std::sync::atomic::Ordering;
use stripmine_physics::method::{Failure, Kind, Quantity, RunWarning, Simulation, Until};

/// Windows at least: two tell a bias.
const FEWEST: usize = 2;
/// Runs end where they take this many times as long as they should.
const LATE: f64 = 3.0;
/// A window that shows a bias but for this part shows it whole.
const ALL: f64 = 1e-3;
/// Runs stay together where differences scatter by no more than this part of those of independent runs.
pub(crate) const TOGETHER: f64 = 0.2;

/// Configurations that are compared, the first of them the reference, and the states that each starts from.
pub(crate) struct Compared<'c> {
    /// For each configuration its steps between two rows.
    pub steps: &'c [u64],
    /// Rows of the first half of the first window. Each next window is twice as long.
    pub first: u64,
    /// How many states there are.
    pub starts: usize,
    /// Begins a configuration from a state, by their numbers.
    pub begin: &'c (dyn Fn(usize, usize) -> Result<Box<dyn Simulation>, String> + Sync),
}

/// Differences from the reference over the second half of a window.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Window {
    /// Its length (time).
    pub time: f64,
    /// For each configuration after the reference and each start the mean less that of the reference.
    pub(crate) differences: Vec<Vec<f64>>,
    /// The largest scatter of these over that of independent runs.
    pub(crate) scatter: f64,
}

/// Means over windows from the same states.
#[derive(Clone, Debug)]
pub(crate) struct Paired {
    /// States.
    pub starts: usize,
    /// Windows, each twice as long as the one before.
    pub(crate) windows: Vec<Window>,
    /// For each configuration, the first of them the reference: what checks warned of in any of its runs.
    pub warnings: Vec<Vec<RunWarning>>,
}

/// A configuration that broke.
#[derive(Debug)]
pub(crate) struct Broken {
    /// Its place among those compared.
    pub at: usize,
    pub(crate) why: String,
}

/// A run with what it knows of a quantity at the end of a window, and at its middle.
struct Course {
    simulation: Box<dyn Simulation>,
    rows: u64,
    /// The time, and the sum of all rows, or the last value of a quantity that is counted.
    end: [f64; 2],
    middle: [f64; 2],
}

impl Course {
    /// Goes on to a row, which ends a window; the end of the one before is its middle.
    fn advance(
        &mut self,
        (trial, is_over): (&Trial<'_>, &(dyn Fn() -> bool + Sync)),
        (steps, rows): (u64, u64),
        (quantity, place): (Quantity, usize),
    ) -> Result<(), Failure> {
        self.middle = self.end;
        while self.rows < rows && !is_over() {
            self.rows += 1;
            let end = Until::Steps(self.rows * steps);
            trial.watch.during(self.simulation.as_mut(), |it| it.advance(&[end], trial.stop))?;
            let value = self.simulation.row()[place];
            let sum = if quantity.kind.grows() { value } else { self.end[1] + value };
            self.end = [self.simulation.clock().time, sum];
        }
        Ok(())
    }

    /// The mean over the second half of the window.
    fn mean(&self, kind: Kind) -> f64 {
        let [time, sum] = [0, 1].map(|at| self.end[at] - self.middle[at]);
        if kind.grows() { sum / time } else { sum / (self.rows / 2) as f64 }
    }
}

/// Runs configurations from the same states over at least two windows that grow until the next would end after some seconds: those in which runs
/// stay together, and, where time is left, those of independent runs.
///
/// # Errors
/// [`Broken`] names the configuration that broke.
pub(crate) fn pairs(
    trial: &Trial<'_>,
    compared: &Compared<'_>,
    (quantities, place): (&'static [Quantity], usize),
    seconds: f64,
) -> Result<Paired, Broken> {
    let begun = trial.watch.now();
    let quantity = (quantities[place], place);
    let begin = |at: usize, start: usize| {
        let mut simulation = (compared.begin)(at, start).map_err(|why| Broken { at, why })?;
        let value = simulation.row()[place];
        let begun = [0.0, if quantity.0.kind.grows() { value } else { 0.0 }];
        Ok(Course { simulation, rows: 0, end: begun, middle: begun })
    };
    let mut courses: Vec<Vec<Course>> = (0..compared.steps.len())
        .map(|at| (0..compared.starts).map(|start| begin(at, start)).collect::<Result<Vec<_>, Broken>>())
        .collect::<Result<_, Broken>>()?;
    let is_over = || trial.stop.load(Ordering::Relaxed) || trial.watch.now() - begun > LATE * seconds;
    let mut advance = |rows: u64| {
        courses.par_iter_mut().enumerate().try_for_each(|(at, runs)| {
            let run = |run: &mut Course| run.advance((trial, &is_over), (compared.steps[at], rows), quantity);
            let broken = |failure: Failure| Broken { at, why: first_line(&failure.what()) };
            runs.par_iter_mut().try_for_each(run).map_err(broken)
        })?;
        let means = |runs: &Vec<Course>| runs.iter().map(|run| run.mean(quantity.0.kind)).collect();
        let means: Vec<Vec<f64>> = courses.iter().map(means).collect();
        Ok(Window::of(courses[0].first().map_or(0.0, |run| run.end[0]), &means))
    };
    let (mut windows, mut rows) = (vec![], compared.first);
    advance(rows)?;
    // The next takes as long as all so far.
    while windows.len() < FEWEST || 2.0 * (trial.watch.now() - begun) <= seconds {
        rows *= 2;
        let window = advance(rows)?;
        if is_over() {
            break;
        }
        windows.push(window);
    }
    let warned = |runs: &Vec<Course>| {
        let mut all: Vec<RunWarning> = vec![];
        for warning in runs.iter().flat_map(|run| run.simulation.warnings()) {
            if all.iter().all(|it| it.check != warning.check) {
                all.push(warning);
            }
        }
        all
    };
    Ok(Paired { starts: compared.starts, windows, warnings: courses.iter().map(warned).collect() })
}

fn variance(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (values.len() as f64 - 1.0).max(1.0)
}

impl Window {
    /// Of means for each configuration, the reference first, and each start.
    fn of(time: f64, means: &[Vec<f64>]) -> Window {
        let reference = &means[0];
        let less = |own: &Vec<f64>| own.iter().zip(reference).map(|(own, other)| own - other).collect();
        let differences: Vec<Vec<f64>> = means[1..].iter().map(less).collect();
        let scatters = differences.iter().zip(&means[1..]).map(|(pairs, own)| {
            let independent = variance(own) + variance(reference);
            if independent > 0.0 { (variance(pairs) / independent).sqrt() } else { 0.0 }
        });
        Window { time, scatter: scatters.fold(0.0, f64::max), differences }
    }
}

/// The part of the bias of a steady state that the mean over the second half of a window (time) has, for a quantity with a memory (time).
pub(crate) fn part(window: f64, memory: f64) -> f64 {
    let ratio = window / memory;
    // The expansion for short windows, whose terms cancel.
    match ratio {
        _ if ratio < 1e-4 => 0.75 * ratio,
        _ if ratio.is_infinite() => 1.0,
        _ => 1.0 + 2.0 / ratio * libm::exp(-0.5 * ratio) * libm::expm1(-0.5 * ratio),
    }
}

/// The bias in the steady state and the change at once, by differences over a window and over the one before, of which each shows a part: `[b, a]`.
pub(crate) fn steady([difference, before]: [f64; 2], [part, part_before]: [f64; 2]) -> [f64; 2] {
    let more = part - part_before;
    // A quantity without a memory shows all at once.
    if 1.0 - part < ALL {
        return [difference, 0.0];
    }
    [
        (difference * (1.0 - part_before) - before * (1.0 - part)) / more,
        (before * part - difference * part_before) / more,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: 1 − (e^{−1} − e^{−2}) = 0.767456; three quarters of the ratio for a window that is short; all of it for one that is long.
    #[test]
    fn a_window_has_a_part_of_the_difference() {
        assert!((part(2.0, 1.0) - 0.767_455_842_1).abs() < 1e-9);
        assert!((part(1e-6, 1.0) - 7.5e-7).abs() < 1e-12 && part(1e6, 1.0) > 0.999_99);
        assert_eq!(part(1.0, 0.0), 1.0);
        assert!((part(0.999e-4, 1.0) / part(1.001e-4, 1.0) - 0.999 / 1.001).abs() < 1e-4);
    }

    /// By hand: differences 0.1, 0.3 have a variance of 0.02; the means 1 and 3 one of 2, and 1.1 and 3.3 one of 2.42.
    #[test]
    fn a_difference_scatters_less_where_runs_stay_together() {
        let found = Window::of(1.0, &[vec![1.0, 3.0], vec![1.1, 3.3]]);
        assert!((found.scatter - f64::sqrt(0.02 / 4.42)).abs() < 1e-12, "{found:?}");
        assert!((found.differences[0][1] - 0.3).abs() < 1e-12, "{found:?}");
    }

    /// By hand: b = 3 and a = −1 over windows that show a quarter and a half: 3/4 − 3/4 = 0 and 3/2 − 1/2 = 1.
    #[test]
    fn two_windows_tell_the_bias_and_the_change_at_once() {
        assert_eq!(steady([1.0, 0.0], [0.5, 0.25]), [3.0, -1.0]);
        assert_eq!(steady([1.0, 0.5], [1.0, 1.0]), [1.0, 0.0]);
    }
}
