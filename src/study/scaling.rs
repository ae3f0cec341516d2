//! Scaling of one bench over ranks and threads: the speedup of each phase, and its serial part.

use serde_json::{Map, Value};
use std::collections::BTreeSet;
use std::time::Instant;
use stripmine_physics::method::throughput::{MeasurementError, Throughput, ThroughputRequest, ThroughputRun};
use stripmine_physics::ranks;

/// Names of the whole step, of the rest outside its phases, and of the work outside steps: the start, a row of observables, all particles, and the
/// contents of a checkpoint.
pub(crate) const WHOLE: &str = "whole step";
const REST: &str = "in no phase";
const BESIDE: [&str; 4] = ["start", "row", "particles", "snapshot"];

/// A bench on several numbers of threads.
#[derive(Clone, Debug)]
pub(crate) struct Scaling {
    pub what: &'static str,
    /// Particles that move.
    pub particles: usize,
    /// Steps or events of each repeat.
    pub steps: u64,
    pub(crate) repeats: usize,
    /// Precision, integrator and other settings.
    pub settings: Map<String, Value>,
    /// True if the final state is bit-identical on all of them.
    pub(crate) same_bits: bool,
    /// Results by rising total number of threads.
    pub(crate) by_threads: Vec<ThreadResult>,
    /// Phases of the step, the most expensive first, then the work outside steps.
    pub phases: Vec<Phase>,
}

/// Number of ranks, and threads of each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ThreadLayout {
    pub ranks: usize,
    pub threads: usize,
}

impl ThreadLayout {
    /// Total number of threads.
    pub(crate) fn all(self) -> usize {
        self.ranks * self.threads
    }
}

/// Result of the bench on some ranks and threads.
#[derive(Clone, Debug)]
pub(crate) struct ThreadResult {
    pub(crate) crew: ThreadLayout,
    /// Work per second: best repeat, and median.
    pub rate: [f64; 2],
    /// Best rate over that of the fewest threads.
    pub(crate) gain: f64,
}

/// A phase on all numbers of threads.
#[derive(Clone, Debug)]
pub(crate) struct Phase {
    pub name: String,
    /// Nanoseconds per particle and step in the best repeat; per particle for work outside steps.
    pub(crate) nanoseconds: Vec<f64>,
    /// True for work outside steps.
    pub(crate) is_beside: bool,
    /// Serial part by Amdahl's law, from the fewest and the most threads; below 0 where the speedup exceeds the number of threads. None for a single
    /// number of threads, or where nothing was measured.
    pub(crate) serial: Option<f64>,
}

/// Measures the scaling. Repeats alternate, so that other programs disturb all numbers of threads alike.
///
/// # Errors
/// [`MeasurementError`] if the scene is invalid or fails, or threads cannot be started.
pub(crate) fn scaling(
    measurement: &dyn Fn() -> Result<ThroughputRequest, MeasurementError>,
    crews: &[ThreadLayout],
    progress: impl Fn(f64) + Sync,
) -> Result<Scaling, MeasurementError> {
    let mut crews = crews.to_vec();
    crews.sort_by_key(|crew| (crew.all(), crew.ranks));
    crews.dedup();
    let mut running = vec![];
    for &crew in &crews {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(crew.threads).build();
        let pool = pool.map_err(MeasurementError::Threads)?;
        let ThroughputRequest { bench, prepared, steps, repeats } = measurement()?;
        let begun = Instant::now();
        let begin = || {
            ranks::with_backend(ranks::RankBackend::Threads(crew.ranks), || {
                ThroughputRun::begin(bench, prepared, steps)
            })
        };
        let run = pool.install(begin)?;
        running.push((pool, run, repeats, begun.elapsed().as_secs_f64()));
    }
    let repeats = running.first().map_or(0, |(_, _, repeats, _)| *repeats);
    for repeat in 0..repeats {
        for (pool, run, ..) in &mut running {
            pool.install(|| run.repeat())?;
        }
        progress((repeat + 1) as f64 / repeats as f64);
    }
    let measured = running.into_iter().map(|(pool, run, ..)| {
        pool.install(|| {
            let beside = run.overhead_seconds();
            Ok((run.measured()?, beside))
        })
    });
    Ok(scaling_results(&crews, measured.collect::<Result<_, MeasurementError>>()?))
}

fn scaling_results(crews: &[ThreadLayout], measured: Vec<(Throughput, [f64; 4])>) -> Scaling {
    let (results, beside): (Vec<Throughput>, Vec<[f64; 4]>) = measured.into_iter().unzip();
    let threads: Vec<usize> = crews.iter().map(|crew| crew.all()).collect();
    let first = &results[0];
    let each = |it: &Throughput, seconds: f64| 1e9 * seconds / (it.particles as f64 * it.steps as f64);
    let phase = |name: &str, is_beside: bool, nanoseconds: Vec<f64>| Phase {
        name: name.replace('_', " "),
        serial: serial(&threads, &nanoseconds),
        nanoseconds,
        is_beside,
    };
    let of =
        |name: &str| results.iter().map(|it| each(it, it.phases.get(name).copied().unwrap_or(0.0))).collect();
    // Several ranks have phases that one rank lacks.
    let most =
        |name: &str| results.iter().filter_map(|it| it.phases.get(name)).fold(0.0_f64, |a, b| a.max(*b));
    let names: BTreeSet<&str> = results.iter().flat_map(|it| it.phases.keys().copied()).collect();
    let mut names: Vec<&str> = names.into_iter().collect();
    names.sort_by(|a, b| most(b).total_cmp(&most(a)));
    let mut phases = vec![phase(WHOLE, false, results.iter().map(|it| each(it, it.seconds)).collect())];
    phases.extend(names.iter().map(|name| phase(name, false, of(name))));
    let rest = |it: &Throughput| each(it, (it.seconds - it.phases.values().sum::<f64>()).max(0.0));
    phases.push(phase(REST, false, results.iter().map(rest).collect()));
    for (at, name) in BESIDE.iter().enumerate() {
        let once = beside.iter().map(|it| 1e9 * it[at] / first.particles as f64);
        phases.push(phase(name, true, once.collect()));
    }
    let by_threads = crews.iter().zip(&results).map(|(&crew, it)| ThreadResult {
        crew,
        rate: [it.rate, it.median_rate],
        gain: it.rate / first.rate,
    });
    Scaling {
        what: first.what,
        particles: first.particles,
        steps: first.steps,
        repeats: first.repeats,
        settings: first.settings.clone(),
        same_bits: results.iter().all(|it| it.checksum == first.checksum),
        by_threads: by_threads.collect(),
        phases,
    }
}

/// Serial part s of a time, where t(n) ∝ s + (1 − s)/n, from the fewest and the most threads.
fn serial(threads: &[usize], times: &[f64]) -> Option<f64> {
    let ([a, .., b], [first, .., last]) = (threads, times) else { return None };
    let ([a, b], ratio) = ([a, b].map(|&count| 1.0 / count as f64), last / first);
    (ratio.is_finite() && a != b).then(|| (b - ratio * a) / (ratio * (1.0 - a) - (1.0 - b)))
}

impl Scaling {
    /// Predicted speedup of a number of threads over one by Amdahl's law; none where the serial part is unknown.
    pub(crate) fn predicted_speedup(&self, threads: usize) -> Option<f64> {
        let serial = self.phases.iter().find(|phase| phase.name == WHOLE)?.serial?.max(0.0);
        Some(1.0 / (serial + (1.0 - serial) / threads as f64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn serial_part_follows_amdahls_law() {
        let time = |serial: f64, threads: f64| 7.0 * (serial + (1.0 - serial) / threads);
        for part in [0.0, 0.1, 1.0] {
            for counts in [[1, 2], [1, 16], [2, 8]] {
                let found = serial(&counts, &counts.map(|count| time(part, count as f64))).unwrap();
                assert!((found - part).abs() < 1e-12, "{part} {counts:?}: {found}");
            }
        }
        // Slightly more than twice as fast on two threads: a negative serial part.
        assert!(serial(&[1, 2], &[2.0, 0.9]).unwrap() < 0.0);
        assert_eq!((serial(&[1], &[2.0]), serial(&[1, 2], &[0.0, 0.0])), (None, None));
    }
}
