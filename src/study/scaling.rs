//! One bench on several numbers of ranks and threads: what each phase gains, and which part of it does not.

use serde_json::{Map, Value};
use std::collections::BTreeSet;
use std::time::Instant;
use stripmine_physics::method::throughput::{Measurement, MeasurementError, Throughput, TimedRun};
use stripmine_physics::ranks;

/// The name of the whole step among its phases, of what is in no phase, and of what is done beside steps: the start, a row of observables, all particles
/// as they stand, what a checkpoint keeps.
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
    /// Repeats, in turn.
    pub(crate) repeats: usize,
    /// How: precision, integrator and the like.
    pub settings: Map<String, Value>,
    /// True if the final state has the same bits on all of them.
    pub(crate) same_bits: bool,
    /// By rising number of threads in all.
    pub(crate) by_threads: Vec<OfThreads>,
    /// Each phase of the step, the dearest first, then what is done beside steps.
    pub phases: Vec<Phase>,
}

/// How many ranks, and threads of each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Crew {
    pub ranks: usize,
    /// Threads of each.
    pub threads: usize,
}

impl Crew {
    /// Threads in all.
    pub(crate) fn all(self) -> usize {
        self.ranks * self.threads
    }
}

/// The bench on some ranks and threads.
#[derive(Clone, Debug)]
pub(crate) struct OfThreads {
    /// How many.
    pub(crate) crew: Crew,
    /// Work in a second: the best repeat, and the median one.
    pub rate: [f64; 2],
    /// The best rate over that of the fewest threads.
    pub(crate) gain: f64,
}

/// A phase on all numbers of threads.
#[derive(Clone, Debug)]
pub(crate) struct Phase {
    pub name: String,
    /// Nanoseconds of a particle and step, of the best repeat, or of a particle, once, for what is done beside steps.
    pub(crate) nanoseconds: Vec<f64>,
    /// True if it is done beside steps.
    pub(crate) is_beside: bool,
    /// The part of it that does not gain by threads, by Amdahl's law from the fewest and the most threads; below 0 where it gains more than there are
    /// threads. None where there is one number of them, or nothing to be seen.
    pub(crate) serial: Option<f64>,
}

/// Measures; repeats are made in turn, so that other programs meet all numbers of threads alike.
///
/// # Errors
/// [`MeasurementError`] if the scene is bad or breaks while running, or there are no threads.
pub(crate) fn scaling(
    measurement: &dyn Fn() -> Result<Measurement, MeasurementError>,
    crews: &[Crew],
    progress: impl Fn(f64) + Sync,
) -> Result<Scaling, MeasurementError> {
    let mut crews = crews.to_vec();
    crews.sort_by_key(|crew| (crew.all(), crew.ranks));
    crews.dedup();
    let mut running = vec![];
    for &crew in &crews {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(crew.threads).build();
        let pool = pool.map_err(MeasurementError::Threads)?;
        let Measurement { bench, prepared, equilibration, steps, repeats } = measurement()?;
        let begun = Instant::now();
        let begin = || {
            ranks::over(ranks::Crew::Threads(crew.ranks), || {
                TimedRun::begin(bench, prepared, equilibration, steps)
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
            let beside = run.beside();
            Ok((run.measured()?, beside))
        })
    });
    Ok(told(&crews, measured.collect::<Result<_, MeasurementError>>()?))
}

fn told(crews: &[Crew], measured: Vec<(Throughput, [f64; 4])>) -> Scaling {
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
    // Some have phases that one rank has not.
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
    let by_threads = crews.iter().zip(&results).map(|(&crew, it)| OfThreads {
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

/// The part s of a time that does not gain, where t(n) ∝ s + (1 − s)/n, from the fewest and the most threads.
fn serial(threads: &[usize], times: &[f64]) -> Option<f64> {
    let ([a, .., b], [first, .., last]) = (threads, times) else { return None };
    let ([a, b], ratio) = ([a, b].map(|&count| 1.0 / count as f64), last / first);
    (ratio.is_finite() && a != b).then(|| (b - ratio * a) / (ratio * (1.0 - a) - (1.0 - b)))
}

impl Scaling {
    /// What a number of threads would gain over one, were the parts that do not gain all that keeps it back; none where that was not seen.
    pub(crate) fn foreseen(&self, threads: usize) -> Option<f64> {
        let serial = self.phases.iter().find(|phase| phase.name == WHOLE)?.serial?.max(0.0);
        Some(1.0 / (serial + (1.0 - serial) / threads as f64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_part_that_does_not_gain_is_amdahls() {
        let time = |serial: f64, threads: f64| 7.0 * (serial + (1.0 - serial) / threads);
        for part in [0.0, 0.1, 1.0] {
            for counts in [[1, 2], [1, 16], [2, 8]] {
                let found = serial(&counts, &counts.map(|count| time(part, count as f64))).unwrap();
                assert!((found - part).abs() < 1e-12, "{part} {counts:?}: {found}");
            }
        }
        // Twice as fast on two threads and a little more: below nothing.
        assert!(serial(&[1, 2], &[2.0, 0.9]).unwrap() < 0.0);
        assert_eq!((serial(&[1], &[2.0]), serial(&[1, 2], &[0.0, 0.0])), (None, None));
    }
}
