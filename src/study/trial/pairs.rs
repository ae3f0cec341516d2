//! Runs of several configurations from the same states, held against each other.
//!
//! Two runs from one state stay together for some Lyapunov times, so that the difference of their means over a short window scatters far less than
//! the difference of two independent means. A window shows the drift away from the state of the reference; a steady state has all of it that the
//! quantity's memory lets it have. With a correlation time τ the difference grows as 1 − exp(−t/τ), and its mean over a window w is the part
//! g = 1 − (τ/w)(1 − exp(−w/τ)) of that in the steady state.

use super::Trial;
use crate::study::first_line;
use rayon::iter::{IndexedParallelIterator, IntoParallelRefMutIterator, ParallelIterator};
use std::sync::atomic::Ordering;
use stripmine_physics::averages::of_independent;
use stripmine_physics::method::{Failure, Quantity, RunWarning, Simulation, Until};

/// Rows of the first window. Each next window is twice as long.
const FIRST: u64 = 4;
/// A window is long enough where differences scatter by this part of those of independent runs.
pub const ENOUGH: f64 = 0.2;

/// Configurations that are compared, the first of them the reference, and the states that each starts from.
pub struct Compared<'c> {
    /// For each configuration its steps between two rows.
    pub steps: &'c [u64],
    /// How many states there are.
    pub starts: usize,
    /// Begins a configuration from a state, by their numbers.
    pub begin: &'c (dyn Fn(usize, usize) -> Result<Box<dyn Simulation>, String> + Sync),
}

/// How a configuration differs from the reference over a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Its mean less that of the reference.
    pub value: f64,
    /// Half the width of the interval of 95 %.
    pub bar: f64,
    /// Scatter of the difference over that of two independent runs.
    pub scatter: f64,
}

/// Differences over a window.
#[derive(Clone, Debug, PartialEq)]
pub struct Window {
    /// Its length (time).
    pub time: f64,
    /// One difference for each configuration after the reference.
    pub differences: Vec<Difference>,
}

/// Means over windows from the same states.
#[derive(Clone, Debug)]
pub struct Paired {
    /// States.
    pub starts: usize,
    /// Windows, each twice as long as the one before.
    pub windows: Vec<Window>,
    /// For each configuration, the first of them the reference: what checks warned of in any of its runs.
    pub warnings: Vec<Vec<RunWarning>>,
}

/// A configuration that broke.
#[derive(Debug)]
pub struct Broken {
    /// Its place among those compared.
    pub at: usize,
    /// Why.
    pub why: String,
}

/// A run with the mean of a quantity so far.
struct Course {
    simulation: Box<dyn Simulation>,
    rows: u64,
    sum: f64,
    first: f64,
    mean: f64,
}

impl Course {
    fn advance(
        &mut self,
        trial: &Trial<'_>,
        steps: u64,
        rows: u64,
        (quantity, place): (Quantity, usize),
    ) -> Result<(), Failure> {
        while self.rows < rows {
            self.rows += 1;
            let end = Until::Steps(self.rows * steps);
            trial.watch.during(self.simulation.as_mut(), |it| it.advance(&[end], trial.stop))?;
            if trial.stop.load(Ordering::Relaxed) {
                return Ok(());
            }
            let value = self.simulation.row()[place];
            self.sum += value;
            self.mean = match quantity.kind.grows() {
                true => (value - self.first) / self.simulation.clock().time,
                false => self.sum / self.rows as f64,
            };
        }
        Ok(())
    }
}

/// Runs configurations from the same states over windows that grow until differences scatter by [`ENOUGH`], or the next would end after some seconds.
///
/// # Errors
/// [`Broken`] names the configuration that broke.
pub fn pairs(
    trial: &Trial<'_>,
    compared: &Compared<'_>,
    (quantities, place): (&'static [Quantity], usize),
    seconds: f64,
) -> Result<Paired, Broken> {
    let begun = trial.watch.now();
    let quantity = (quantities[place], place);
    let begin = |at: usize, start: usize| {
        let mut simulation = (compared.begin)(at, start).map_err(|why| Broken { at, why })?;
        let first = simulation.row()[place];
        Ok(Course { simulation, rows: 0, sum: 0.0, first, mean: f64::NAN })
    };
    let mut courses: Vec<Vec<Course>> = (0..compared.steps.len())
        .map(|at| (0..compared.starts).map(|start| begin(at, start)).collect::<Result<Vec<_>, Broken>>())
        .collect::<Result<_, Broken>>()?;
    let mut windows: Vec<Window> = vec![];
    let mut rows = FIRST;
    loop {
        courses.par_iter_mut().enumerate().try_for_each(|(at, runs)| {
            let run = |run: &mut Course| run.advance(trial, compared.steps[at], rows, quantity);
            let broken = |failure: Failure| Broken { at, why: first_line(&failure.what()) };
            runs.par_iter_mut().try_for_each(run).map_err(broken)
        })?;
        if trial.stop.load(Ordering::Relaxed) {
            break;
        }
        let means = means(&courses);
        let time = courses[0].first().map_or(0.0, |run| run.simulation.clock().time);
        let differences: Vec<Difference> = means[1..].iter().map(|own| difference(own, &means[0])).collect();
        let window = Window { time, differences };
        let largest = window.scatter();
        windows.push(window);
        // The next takes as long as all so far.
        if largest > ENOUGH || 2.0 * (trial.watch.now() - begun) > seconds {
            break;
        }
        rows *= 2;
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

/// Means so far, for each configuration and start.
fn means(courses: &[Vec<Course>]) -> Vec<Vec<f64>> {
    courses.iter().map(|runs| runs.iter().map(|run| run.mean).collect()).collect()
}

/// The difference of means from the same states, and how it scatters beside two that are independent.
fn difference(own: &[f64], reference: &[f64]) -> Difference {
    let pairs: Vec<f64> = own.iter().zip(reference).map(|(own, other)| own - other).collect();
    let [value, bar] = of_independent(&pairs).unwrap_or([f64::NAN, f64::INFINITY]);
    let independent = variance(own) + variance(reference);
    let scatter = if independent > 0.0 { (variance(&pairs) / independent).sqrt() } else { 0.0 };
    Difference { value, bar, scatter }
}

fn variance(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (values.len() as f64 - 1.0).max(1.0)
}

impl Window {
    /// The largest scatter of a difference over that of independent runs.
    pub fn scatter(&self) -> f64 {
        self.differences.iter().map(|it| it.scatter).fold(0.0, f64::max)
    }
}

/// The part of the bias of a steady state that the mean over a window (time) has, for a quantity with a memory (time).
pub fn part(window: f64, memory: f64) -> f64 {
    let ratio = window / memory;
    // The expansion for short windows, whose terms cancel.
    if ratio < 1e-4 { 0.5 * ratio } else { 1.0 + libm::expm1(-ratio) / ratio }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: 1 − (1 − e^{−2})/2 = 0.567668; half of the ratio for a window that is short; all of it for one that is long.
    #[test]
    fn a_window_has_a_part_of_the_difference() {
        assert!((part(2.0, 1.0) - 0.567_667_641_6).abs() < 1e-10);
        assert!((part(1e-6, 1.0) - 5e-7).abs() < 1e-12 && part(1e6, 1.0) > 0.999_99);
        assert_eq!(part(1.0, 0.0), 1.0);
        assert!((part(0.999e-4, 1.0) / part(1.001e-4, 1.0) - 0.999 / 1.001).abs() < 1e-4);
    }

    /// By hand: differences 0.1, 0.3 have a variance of 0.02; the means 1 and 3 one of 2, and 1.1 and 3.3 one of 2.42.
    #[test]
    fn a_difference_scatters_less_where_runs_stay_together() {
        let found = difference(&[1.1, 3.3], &[1.0, 3.0]);
        assert!((found.value - 0.2).abs() < 1e-12, "{found:?}");
        assert!((found.scatter - f64::sqrt(0.02 / 4.42)).abs() < 1e-12, "{found:?}");
    }
}
