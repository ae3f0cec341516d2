//! Work whose amount depends on the data: the fast engine and the neighbour lists, on drill scenes of their own.

use super::fit;
use crate::method::lattice_md::Checked;
use crate::method::lattice_md::Phase;
use crate::method::lattice_md::study::noise_monitor::NoiseMonitor;
use crate::method::lattice_md::study::phase_times::{
    FAST, FAST_LISTS, LISTS, PhaseTimes, Run, Sampling, phase_times,
};
use crate::method::throughput::MeasurementError;
use crate::model::host::{Amounts, RatePoint, Rates};
use crate::statistics::non_negative;
use std::collections::BTreeMap;

/// NP of the drill scenes: close enough to each other that no level of memory ends unseen between two of them.
pub(super) const PARTICLES: [usize; 8] = [60, 160, 420, 1100, 3000, 8000, 16_000, 32_000];
/// ρ of the drill scenes, of every second NP these and of the others those; the first two are sparse.
const OCCUPANCIES: [[f64; 4]; 2] = [[0.03, 0.12, 0.17, 0.26], [0.07, 0.1, 0.18, 0.22]];
const PRECISIONS: [&str; 3] = ["f64", "f32", "mixed"];

/// Steps before the clock starts, and those that are timed: fewer of many discs, but enough for lists to be rebuilt.
fn sampling(run: &Run) -> Sampling {
    let discs = if run.has_lists() { 250_000 } else { 100_000 };
    let equilibration = (discs / run.particles).clamp(3, 60);
    Sampling { equilibration, repeats: 1, particle_steps: 10_000, least_steps: 2 }
}

/// A drill scene, and what was measured of it.
type Scene = (Run, Checked, Option<PhaseTimes>);

fn once_more((run, checked, times): &mut Scene, monitor: &mut NoiseMonitor) -> Result<(), MeasurementError> {
    let more = phase_times(checked, &sampling(run), monitor)?;
    *times = Some(PhaseTimes::with(times.take(), more));
    Ok(())
}

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
                        scenes.push((run, run.scene(&["particles.seed=11"])?, None));
                    }
                }
            }
        }
        Ok(Scenes(scenes))
    }

    /// Runs every scene once more. `progress` gets the share that is done.
    pub(super) fn sweep(
        &mut self,
        monitor: &mut NoiseMonitor,
        progress: impl Fn(f64),
    ) -> Result<(), MeasurementError> {
        let all = self.0.len() as f64;
        for (at, scene) in self.0.iter_mut().enumerate() {
            once_more(scene, monitor)?;
            progress((at + 1) as f64 / all);
        }
        Ok(())
    }

    /// Runs once more what was always disturbed so far. Whether there was any.
    pub(super) fn again(
        &mut self,
        monitor: &mut NoiseMonitor,
        reference: f64,
    ) -> Result<bool, MeasurementError> {
        let mut any = false;
        for scene in &mut self.0 {
            if !scene.2.as_ref().is_some_and(|times| times.is_quiet(reference)) {
                once_more(scene, monitor)?;
                any = true;
            }
        }
        Ok(any)
    }

    /// The rates of the methods on an undisturbed core.
    pub(super) fn rates(&self, reference: f64) -> BTreeMap<String, Rates> {
        let measured = self.0.iter().filter_map(|(run, _, times)| Some((*run, times.as_ref()?)));
        rates(&measured.collect::<Vec<_>>(), reference)
    }
}

/// What there was to do in a run, and the nanoseconds that it took.
type Done = (Amounts, f64);

fn rates(measured: &[(Run, &PhaseTimes)], reference: f64) -> BTreeMap<String, Rates> {
    let mut methods: BTreeMap<String, Rates> = BTreeMap::new();
    for method in ["fast", "fast, sparse", "fast lists", "lists"] {
        let rates = methods.entry(method.to_owned()).or_default();
        for precision in PRECISIONS {
            let alike: Vec<Vec<&PhaseTimes>> = PARTICLES
                .iter()
                .map(|&particles| {
                    let alike = measured.iter().filter(|(run, _)| {
                        run.particles == particles
                            && run.precision == precision
                            && run.rates() == Some(method)
                    });
                    alike.map(|(_, times)| *times).collect()
                })
                .collect();
            let phases = rates.0.entry(precision.to_owned()).or_default();
            for &phase in Phase::ALL {
                let points = points(&alike, phase, reference);
                if points.iter().any(|point| !point.ns.is_empty()) {
                    phases.insert(phase.name().to_owned(), points);
                }
            }
        }
    }
    methods
}

/// What each unit takes in a phase, number of discs by number of discs.
fn points(alike: &[Vec<&PhaseTimes>], phase: Phase, reference: f64) -> Vec<RatePoint> {
    let upkeep = |times: &PhaseTimes| Some((charged(phase, &times.amounts), times.upkeep(phase, reference)));
    let making = |times: &PhaseTimes| {
        let Amounts { discs, candidates, .. } = times.amounts;
        let amounts = Amounts { remade: discs, relisted: candidates, ..Amounts::default() };
        (phase == Phase::Index).then(|| Some((amounts, times.making(reference)?))).flatten()
    };
    let of = |done: &dyn Fn(&PhaseTimes) -> Option<Done>| -> Vec<Vec<(&'static str, f64)>> {
        let all: Vec<Vec<Done>> = alike
            .iter()
            .map(|alike| alike.iter().filter_map(|times| done(times)).filter(|done| done.1 > 0.0).collect())
            .collect();
        per_unit(&all)
    };
    let points = alike.iter().zip(of(&upkeep)).zip(of(&making)).map(|((alike, upkeep), making)| RatePoint {
        discs: alike.iter().map(|times| times.amounts.discs as usize).max().unwrap_or(0),
        ns: upkeep.into_iter().chain(making).map(|(name, ns)| (name.to_owned(), ns)).collect(),
    });
    points.collect()
}

/// Nanoseconds of each unit that costs some, from the work at each number of discs.
///
/// How the units stand to each other is fitted to all of them together: of many discs alone there are too few steps with too
/// few contacts to tell. How much slower everything is with more discs, which lie farther away, is each number's own.
fn per_unit(done: &[Vec<Done>]) -> Vec<Vec<(&'static str, f64)>> {
    let mut slower = vec![1.0; done.len()];
    let mut units: Units = [0.0; Amounts::NAMES.len()];
    for round in 0..ROUNDS {
        let known = (round > 0).then_some(units);
        let rows = done.iter().zip(&slower).flat_map(|(done, &slower)| {
            done.iter().map(move |(amounts, ns)| {
                // As a share of what is expected, or of the amounts before anything is: as a share of its own time, one that
                // is much too short would draw all to it.
                let expected = slower * sum(amounts, &known.unwrap_or([1.0; Amounts::NAMES.len()]));
                let weight = known.map_or(1.0, |_| trust(expected / ns)) / expected.max(f64::MIN_POSITIVE);
                (amounts.values().map(|amount| weight * slower * amount), weight * ns)
            })
        });
        units = non_negative(&rows.collect::<Vec<_>>());
        // Of many discs few steps are run, and no lists may have been made: as of fewer discs, then.
        let mut last = 1.0;
        for (done, slower) in done.iter().zip(&mut slower) {
            let ratios = done.iter().map(|(amounts, ns)| ns / sum(amounts, &units));
            let ratios: Vec<f64> = ratios.filter(|ratio| ratio.is_finite()).collect();
            if !ratios.is_empty() {
                last = fit::median(ratios.into_iter());
            }
            *slower = last;
        }
    }
    let point = |slower: f64| {
        let each = Amounts::NAMES.into_iter().zip(units).filter(|(_, unit)| *unit > 0.0);
        each.map(|(name, unit)| (name, slower * unit)).collect()
    };
    slower.into_iter().map(point).collect()
}

type Units = [f64; Amounts::NAMES.len()];

fn sum(amounts: &Amounts, units: &Units) -> f64 {
    amounts.values().iter().zip(units).map(|(amount, unit)| amount * unit).sum()
}

/// The weight of a run by the ratio of its prediction to its time: what is far from the fit was disturbed, and a run that
/// took too little time must not lower all others.
fn trust(ratio: f64) -> f64 {
    let far = ratio.max(f64::MIN_POSITIVE).ln().abs();
    0.1 / (0.1 + far)
}

/// Rounds in which the units and how much slower each number of discs is are fitted, one given the other.
const ROUNDS: usize = 40;

/// The units that a phase can depend on: others would only fit the noise.
fn charged(phase: Phase, amounts: &Amounts) -> Amounts {
    let Amounts { steps, discs, cells, candidates, contacts, .. } = *amounts;
    let none = Amounts { steps, discs, ..Amounts::default() };
    match phase {
        Phase::Forces => Amounts { cells, candidates, contacts, ..none },
        Phase::Index => Amounts { cells, ..none },
        Phase::Predict | Phase::CorrectPredict | Phase::Correct => none,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_fitted_to_all_and_a_slowdown_to_each_number_of_discs() {
        let done = |discs: f64, contacts: f64, slower: f64| {
            let amounts = Amounts { discs, contacts, ..Amounts::default() };
            (amounts, slower * (2.0 * discs + 5.0 * contacts))
        };
        // Of a thousand discs there is one run alone, of ten thousand none.
        let all =
            [vec![done(100.0, 10.0, 1.0), done(100.0, 70.0, 1.0)], vec![done(1000.0, 1.0, 1.2)], vec![]];
        let points = per_unit(&all);
        for (point, slower) in points.iter().zip([1.0, 1.2, 1.2]) {
            let sum = |discs: f64, contacts: f64| {
                let amounts = Amounts { discs, contacts, ..Amounts::default() };
                let named: BTreeMap<&str, f64> = point.iter().copied().collect();
                let each = Amounts::NAMES.iter().zip(amounts.values());
                each.map(|(name, amount)| named.get(name).copied().unwrap_or(0.0) * amount).sum::<f64>()
            };
            let expected = slower * (2.0 * 1000.0 + 5.0 * 700.0);
            assert!((sum(1000.0, 700.0) / expected - 1.0).abs() < 0.02, "{point:?}");
        }
    }

    #[test]
    fn one_run_that_took_no_time_does_not_count() {
        let done = |remade: f64, relisted: f64, bad: f64| {
            let amounts = Amounts { remade, relisted, ..Amounts::default() };
            (amounts, bad * (120.0 * remade + 5.0 * relisted))
        };
        let alike =
            |discs: f64| [0.2, 0.7, 1.1, 1.5, 2.0].map(|share| done(discs, share * discs, 1.0)).to_vec();
        let mut all = vec![alike(100.0), alike(1000.0), alike(5000.0)];
        all[0].push(done(100.0, 3.0, 0.02));
        for point in per_unit(&all) {
            let named: BTreeMap<&str, f64> = point.into_iter().collect();
            let [remade, relisted] =
                ["remade", "relisted"].map(|name| named.get(name).copied().unwrap_or(0.0));
            assert!((remade / 120.0 - 1.0).abs() < 0.05 && (relisted / 5.0 - 1.0).abs() < 0.2, "{named:?}");
        }
    }
}
