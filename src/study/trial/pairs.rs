//! Paired runs: several configurations compared from common states.
//!
//! Two runs from one state stay together for some Lyapunov times, so the difference of their means over a short window scatters far less than
//! the difference of two independent means. Changing the configuration shifts a quantity at once by a, which decays with its memory τ, while
//! the bias b of the steady state builds up: d(t) = b (1 − exp(−t/τ)) + a exp(−t/τ). The mean over the second half of a window w is
//! b g + a (1 − g) with g = 1 − (2τ/w)(exp(−w/2τ) − exp(−w/τ)), so two windows determine both a and b.

use super::TrialControl;
use crate::study::first_line;
use rayon::iter::{IndexedParallelIterator, IntoParallelRefMutIterator, ParallelIterator};
use std::sync::atomic::Ordering;
use stripmine_physics::method::{
    ObservedQuantity, PhysicsFailure, QuantityKind, RunWarning, Simulation, Until,
};

/// Fewest windows: two determine a bias.
const FEWEST: usize = 2;
/// Factor on the allotted time after which runs are stopped.
const LATE: f64 = 3.0;
/// A window that shows all but this part of a bias counts as showing it whole.
const ALL: f64 = 1e-3;
/// Largest scatter of differences, relative to independent runs, at which runs count as staying together.
pub(crate) const TOGETHER: f64 = 0.2;

/// Configurations to compare, the reference first, and the states that each starts from.
pub(crate) struct PairedConfigurations<'c> {
    /// Steps between two rows, for each configuration.
    pub steps: &'c [u64],
    /// Rows of the first half of the first window. Each next window is twice as long.
    pub first: u64,
    /// Number of states.
    pub starts: usize,
    /// Starts a configuration from a state, by their numbers.
    pub begin: &'c (dyn Fn(usize, usize) -> Result<Box<dyn Simulation>, String> + Sync),
}

/// Differences from the reference over the second half of a window.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Window {
    /// Length of the window (time).
    pub time: f64,
    /// Mean less that of the reference, for each configuration after the reference and each start.
    pub(crate) differences: Vec<Vec<f64>>,
    /// Largest scatter of these, relative to independent runs.
    pub(crate) scatter: f64,
}

/// Means over windows from the same states.
#[derive(Clone, Debug)]
pub(crate) struct PairedMeans {
    /// Number of states.
    pub starts: usize,
    /// Windows, each twice as long as the one before.
    pub(crate) windows: Vec<Window>,
    /// Warnings in any run of each configuration, the reference first.
    pub warnings: Vec<Vec<RunWarning>>,
}

/// Failure of a configuration.
#[derive(Debug)]
pub(crate) struct FailedConfiguration {
    /// Index among the compared configurations.
    pub at: usize,
    pub(crate) why: String,
}

/// A run with the state of its average at the end and in the middle of a window.
struct PairedRun {
    simulation: Box<dyn Simulation>,
    rows: u64,
    /// The time, and the sum of all rows, or the last value of a quantity that grows.
    end: [f64; 2],
    middle: [f64; 2],
}

impl PairedRun {
    /// Advances to a row, which ends a window; the end of the previous window becomes its middle.
    fn advance(
        &mut self,
        (trial, is_over): (&TrialControl<'_>, &(dyn Fn() -> bool + Sync)),
        (steps, rows): (u64, u64),
        (quantity, place): (ObservedQuantity, usize),
    ) -> Result<(), PhysicsFailure> {
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

    /// Mean over the second half of the window.
    fn mean(&self, kind: QuantityKind) -> f64 {
        let [time, sum] = [0, 1].map(|at| self.end[at] - self.middle[at]);
        if kind.grows() { sum / time } else { sum / (self.rows / 2) as f64 }
    }
}

/// Runs configurations from the same states over at least two windows, each twice as long, until the next would exceed `seconds`. Runs stay together
/// in the first windows; where time is left, the last are those of independent runs.
///
/// # Errors
/// [`FailedConfiguration`] names the configuration that failed.
pub(crate) fn run_pairs(
    trial: &TrialControl<'_>,
    compared: &PairedConfigurations<'_>,
    (quantities, place): (&'static [ObservedQuantity], usize),
    seconds: f64,
) -> Result<PairedMeans, FailedConfiguration> {
    let begun = trial.watch.now();
    let quantity = (quantities[place], place);
    let begin = |at: usize, start: usize| {
        let mut simulation = (compared.begin)(at, start).map_err(|why| FailedConfiguration { at, why })?;
        let value = simulation.row()[place];
        let begun = [0.0, if quantity.0.kind.grows() { value } else { 0.0 }];
        Ok(PairedRun { simulation, rows: 0, end: begun, middle: begun })
    };
    let mut courses: Vec<Vec<PairedRun>> = (0..compared.steps.len())
        .map(|at| {
            (0..compared.starts)
                .map(|start| begin(at, start))
                .collect::<Result<Vec<_>, FailedConfiguration>>()
        })
        .collect::<Result<_, FailedConfiguration>>()?;
    let is_over = || trial.stop.load(Ordering::Relaxed) || trial.watch.now() - begun > LATE * seconds;
    let mut advance = |rows: u64| {
        courses.par_iter_mut().enumerate().try_for_each(|(at, runs)| {
            let run =
                |run: &mut PairedRun| run.advance((trial, &is_over), (compared.steps[at], rows), quantity);
            let broken = |failure: PhysicsFailure| FailedConfiguration {
                at,
                why: first_line(&failure.what_and_when()),
            };
            runs.par_iter_mut().try_for_each(run).map_err(broken)
        })?;
        let means = |runs: &Vec<PairedRun>| runs.iter().map(|run| run.mean(quantity.0.kind)).collect();
        let means: Vec<Vec<f64>> = courses.iter().map(means).collect();
        Ok(Window::of(courses[0].first().map_or(0.0, |run| run.end[0]), &means))
    };
    let (mut windows, mut rows) = (vec![], compared.first);
    advance(rows)?;
    // The next window takes as long as all before.
    while windows.len() < FEWEST || 2.0 * (trial.watch.now() - begun) <= seconds {
        rows *= 2;
        let window = advance(rows)?;
        if is_over() {
            break;
        }
        windows.push(window);
    }
    let warned = |runs: &Vec<PairedRun>| {
        let mut all: Vec<RunWarning> = vec![];
        for warning in runs.iter().flat_map(|run| run.simulation.warnings()) {
            if all.iter().all(|it| it.check != warning.check) {
                all.push(warning);
            }
        }
        all
    };
    Ok(PairedMeans { starts: compared.starts, windows, warnings: courses.iter().map(warned).collect() })
}

fn variance(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (values.len() as f64 - 1.0).max(1.0)
}

impl Window {
    /// Differences of means, for each configuration with the reference first, and each start.
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

/// Part of the steady-state bias in the mean over the second half of a window (time), for a quantity with a memory (time).
pub(crate) fn shown_part(window: f64, memory: f64) -> f64 {
    let ratio = window / memory;
    // Expansion for short windows, where the terms cancel.
    match ratio {
        _ if ratio < 1e-4 => 0.75 * ratio,
        _ if ratio.is_infinite() => 1.0,
        _ => 1.0 + 2.0 / ratio * libm::exp(-0.5 * ratio) * libm::expm1(-0.5 * ratio),
    }
}

/// Steady-state bias and immediate change `[b, a]`, from the differences over a window and the one before, each of which shows a part.
pub(crate) fn steady_bias([difference, before]: [f64; 2], [part, part_before]: [f64; 2]) -> [f64; 2] {
    let more = part - part_before;
    // A quantity without memory shows all of it at once.
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

    /// By hand: 1 − (e^{−1} − e^{−2}) = 0.767456; three quarters of the ratio for a short window; everything for a long one.
    #[test]
    fn window_shows_part_of_the_bias() {
        assert!((shown_part(2.0, 1.0) - 0.767_455_842_1).abs() < 1e-9);
        assert!((shown_part(1e-6, 1.0) - 7.5e-7).abs() < 1e-12 && shown_part(1e6, 1.0) > 0.999_99);
        assert_eq!(shown_part(1.0, 0.0), 1.0);
        assert!((shown_part(0.999e-4, 1.0) / shown_part(1.001e-4, 1.0) - 0.999 / 1.001).abs() < 1e-4);
    }

    /// By hand: differences 0.1, 0.3 have a variance of 0.02; the means 1 and 3 one of 2, and 1.1 and 3.3 one of 2.42.
    #[test]
    fn paired_differences_scatter_less() {
        let found = Window::of(1.0, &[vec![1.0, 3.0], vec![1.1, 3.3]]);
        assert!((found.scatter - f64::sqrt(0.02 / 4.42)).abs() < 1e-12, "{found:?}");
        assert!((found.differences[0][1] - 0.3).abs() < 1e-12, "{found:?}");
    }

    /// By hand: b = 3 and a = −1 over windows that show a quarter and a half: 3/4 − 3/4 = 0 and 3/2 − 1/2 = 1.
    #[test]
    fn two_windows_separate_bias_and_immediate_change() {
        assert_eq!(steady_bias([1.0, 0.0], [0.5, 0.25]), [3.0, -1.0]);
        assert_eq!(steady_bias([1.0, 0.5], [1.0, 1.0]), [1.0, 0.0]);
    }
}
