//! Work whose amount depends on the data: the fast engine and the neighbour lists, on drill scenes of their own.

use super::fit::{Row, suited};
use crate::laboratory::lattice_md::study::phase_times::{
    FAST, FAST_LISTS, LISTS, PhaseTimes, Run, Sampling, phase_times,
};
use crate::model::host::{Amounts, MAKING, PhaseRate, Rates};
use crate::statistics::median;
use std::collections::BTreeMap;
use std::time::Instant;
use stripmine_physics::method::lattice_md::Checked;
use stripmine_physics::method::lattice_md::Phase;
use stripmine_physics::method::throughput::MeasurementError;
use stripmine_physics::scene::SEED;

/// NP of the drill scenes: close enough to each other that no level of memory ends unseen between two of them.
const PARTICLES: [usize; 6] = [60, 220, 900, 3300, 11_000, 32_000];
/// ρ of the drill scenes, of every second NP these and of the others those; the first is sparse.
const OCCUPANCIES: [[f64; 3]; 2] = [[0.05, 0.12, 0.26], [0.07, 0.17, 0.22]];
const PRECISIONS: [&str; 3] = ["f64", "f32", "mixed"];

/// Steps before the clock starts, and those that are timed: fewer of many discs, but enough for lists to be rebuilt.
fn sampling(run: &Run) -> Sampling {
    let discs = if run.has_lists() { 250_000 } else { 100_000 };
    let equilibration = (discs / run.particles).clamp(3, 60);
    Sampling { equilibration, repeats: 1, particle_steps: 10_000, least_steps: 2 }
}

/// A drill scene, and what was measured of it.
type Scene = (Run, Checked, Option<PhaseTimes>);

/// Every drill scene.
pub(super) struct Scenes(Vec<Scene>);

impl Scenes {
    /// Nothing measured yet.
    pub(super) fn new() -> Result<Scenes, MeasurementError> {
        let mut scenes = vec![];
        for (particles, occupancies) in PARTICLES.into_iter().zip(OCCUPANCIES.iter().cycle()) {
            for &occupancy in occupancies {
                for precision in PRECISIONS {
                    for execution in [FAST, FAST_LISTS, LISTS] {
                        let run = Run { particles, occupancy, precision, execution };
                        scenes.push((run, run.scene(|scene| scene.set(&SEED, 11_u64))?, None));
                    }
                }
            }
        }
        Ok(Scenes(scenes))
    }

    /// Runs once more every scene of which there is nothing yet, and of the others those for which there is time until `end`.
    pub(super) fn sweep(&mut self, end: Instant) -> Result<(), MeasurementError> {
        for (run, checked, times) in &mut self.0 {
            if times.is_none() || Instant::now() < end {
                let more = phase_times(checked, &sampling(run))?;
                *times = Some(PhaseTimes::with(times.take(), more));
            }
        }
        Ok(())
    }

    /// The rates of the methods.
    pub(super) fn rates(&self) -> BTreeMap<String, Rates> {
        let measured: Vec<(Run, &PhaseTimes)> =
            self.0.iter().filter_map(|(run, _, times)| Some((*run, times.as_ref()?))).collect();
        let of = |method: &str| {
            let phases = Phase::ALL.iter().flat_map(|&phase| {
                let upkeep = rate(&measured, method, |times| {
                    Some((charged(phase, &times.amounts), times.upkeep(phase)))
                });
                let making = (phase == Phase::Index).then(|| {
                    rate(&measured, method, |times| {
                        let Amounts { discs, candidates, .. } = times.amounts;
                        let amounts = Amounts { remade: discs, relisted: candidates, ..Amounts::default() };
                        Some((amounts, times.making()?))
                    })
                });
                let named = [(phase.name(), Some(upkeep)), (MAKING, making)];
                named.into_iter().filter_map(|(name, rate)| Some((name.to_owned(), rate??)))
            });
            let phases: BTreeMap<String, PhaseRate> = phases.collect();
            (method.to_owned(), Rates { discs: PARTICLES.map(|discs| discs as f64).to_vec(), phases })
        };
        ["fast", "fast, sparse", "fast lists", "lists"].map(of).into_iter().collect()
    }
}

/// What there was to do in a run, and the nanoseconds that it took.
type Done = (Amounts, f64);

/// What each unit takes in a phase of a method, and how much slower everything is with each number of discs; none where it has no such
/// phase.
fn rate(
    measured: &[(Run, &PhaseTimes)],
    method: &str,
    done: impl Fn(&PhaseTimes) -> Option<Done>,
) -> Option<PhaseRate> {
    let of = |precision: &str, particles: usize| -> Vec<Done> {
        let alike = measured.iter().filter(|(run, _)| {
            (run.particles, run.precision) == (particles, precision) && run.rates() == Some(method)
        });
        alike.filter_map(|(_, times)| done(times)).filter(|done| done.1 > 0.0).collect()
    };
    let all: Vec<Vec<Vec<Done>>> = PRECISIONS
        .iter()
        .map(|precision| PARTICLES.iter().map(|&particles| of(precision, particles)).collect())
        .collect();
    all.iter().flatten().flatten().next()?;
    let (units, slower) = fitted(&all);
    let named = PRECISIONS.iter().zip(units).map(|(precision, units)| ((*precision).to_owned(), units));
    Some(PhaseRate { slower, ns: named.collect() })
}

type Units = [f64; Amounts::NAMES.len()];

/// Rounds in which the units and how much slower each number of discs is are fitted, one given the other.
const ROUNDS: usize = 12;

/// The units of every precision, and how much slower everything is with each number of discs, from the work of runs by precision and
/// number of discs.
///
/// How the units stand to each other is fitted to all of them together: of many discs alone there are too few steps with too few
/// contacts to tell.
fn fitted(all: &[Vec<Vec<Done>>]) -> (Vec<Units>, Vec<f64>) {
    let row = |(amounts, ns): &Done, slower: f64| Row {
        features: amounts.values().map(|amount| slower * amount),
        ns: *ns,
    };
    let mut slower = vec![1.0; all.first().map_or(0, Vec::len)];
    let mut units: Vec<Units> = vec![];
    for _ in 0..ROUNDS {
        // Only their product with the units is known: without this both drift apart, by a factor in each round, where runs scatter much.
        let smallest = slower.first().copied().unwrap_or(1.0);
        slower.iter_mut().for_each(|slower| *slower /= smallest);
        let rows = |by_size: &Vec<Vec<Done>>| -> Vec<Row<_>> {
            let each = by_size.iter().zip(&slower);
            each.flat_map(|(alike, &slower)| alike.iter().map(move |done| row(done, slower))).collect()
        };
        units = all.iter().map(|by_size| suited(&rows(by_size))).collect();
        let mut last = 1.0;
        for (size, slower) in slower.iter_mut().enumerate() {
            let ratio = |(by_size, units): (&Vec<Vec<Done>>, &Units)| -> Vec<f64> {
                by_size[size].iter().map(|done| done.1 / row(done, 1.0).said(units)).collect()
            };
            let ratios = all.iter().zip(&units).flat_map(ratio).filter(|ratio| ratio.is_finite());
            let ratio = median(ratios);
            // Where nothing was measured everything is as slow as before.
            last = if ratio.is_nan() { last } else { ratio };
            *slower = last;
        }
    }
    (units, slower)
}

/// The units that a phase can depend on: others would only fit the noise.
fn charged(phase: Phase, amounts: &Amounts) -> Amounts {
    let Amounts { steps, discs, cells, candidates, contacts, .. } = *amounts;
    let none = Amounts { steps, discs, ..Amounts::default() };
    match phase {
        Phase::Forces => Amounts { cells, candidates, contacts, ..none },
        Phase::Index => Amounts { cells, ..none },
        Phase::Predict | Phase::CorrectPredict | Phase::Halo | Phase::Correct => none,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs that scatter by a factor of a thousand, as on a busy machine: what is fitted stays within the square of
    /// that scatter, and does not grow with the rounds.
    #[test]
    fn scattered_runs_do_not_drive_units_and_slowdowns_apart() {
        let done = |size: usize, run: usize| {
            let amounts = Amounts { discs: 100.0 * libm::pow(4.0, size as f64), ..Amounts::default() };
            let scatter = [1.0, 900.0, 0.8, 40.0][(size + 2 * run) % 4];
            (amounts, 2.0 * scatter * amounts.discs)
        };
        let of = |size| (0..5).map(|run| done(size, run)).collect();
        let (_, slower) = fitted(&[(0..6).map(of).collect()]);
        assert!(slower.iter().all(|it| (1e-6..1e6).contains(it)), "{slower:?}");
    }

    /// Two precisions, of which the second takes twice as long; of a thousand discs there is one run alone, of ten thousand none.
    #[test]
    fn units_are_fitted_to_all_and_a_slowdown_to_each_number_of_discs() {
        let done = |factor: f64, discs: f64, contacts: f64, slower: f64| {
            let amounts = Amounts { discs, contacts, ..Amounts::default() };
            (amounts, factor * slower * (2.0 * discs + 5.0 * contacts))
        };
        let of = |factor: f64| {
            vec![
                vec![done(factor, 100.0, 10.0, 1.0), done(factor, 100.0, 70.0, 1.0)],
                vec![done(factor, 1000.0, 1.0, 1.2)],
                vec![],
            ]
        };
        let (units, slower) = fitted(&[of(1.0), of(2.0)]);
        for (factor, units) in [1.0, 2.0].into_iter().zip(units) {
            for (slower, expected) in slower.iter().zip([1.0, 1.2, 1.2]) {
                let amounts = Amounts { discs: 1000.0, contacts: 700.0, ..Amounts::default() };
                let known = factor * expected * (2.0 * 1000.0 + 5.0 * 700.0);
                let row = Row { features: amounts.values(), ns: known };
                assert!((slower * row.said(&units) / known - 1.0).abs() < 0.02, "{units:?}");
            }
        }
    }
}
