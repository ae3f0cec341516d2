//! Timing of work that depends on the data: the fast engine and neighbour lists, on separate drill scenes.

use super::fit::{FitRow, fit_robustly};
use crate::laboratory::lattice_md::study::phase_times::{
    BenchRun, FAST, FAST_LISTS, LISTS, PRECISIONS, PhaseTimedRun,
};
use crate::model::host::{AmountUnits, Amounts, MAKING, PhaseRates};
use std::collections::BTreeMap;
use std::time::Instant;
use stripmine_physics::method::lattice_md::Phase;
use stripmine_physics::method::throughput::MeasurementError;
use stripmine_physics::scene::{Overrides, SEED};

/// NP of the drill scenes, close enough that every boundary of a memory level is resolved.
const PARTICLES: [usize; 6] = [60, 220, 900, 3300, 11_000, 32_000];
/// ρ of the drill scenes, alternating between consecutive NP; the first is sparse.
const OCCUPANCIES: [[f64; 3]; 2] = [[0.05, 0.12, 0.26], [0.07, 0.17, 0.22]];

/// All drill scenes, each with true once it has been measured.
pub(super) struct DrillScenes(Vec<(PhaseTimedRun, bool)>);

impl DrillScenes {
    /// Makes all drill scenes, without measurements.
    pub(super) fn new() -> Result<DrillScenes, MeasurementError> {
        let (mut scenes, seed) = (vec![], Overrides::new().set(&SEED, 11_u64));
        for (particles, occupancies) in PARTICLES.into_iter().zip(OCCUPANCIES.iter().cycle()) {
            for &occupancy in occupancies {
                for precision in PRECISIONS {
                    for execution in [FAST, FAST_LISTS, LISTS] {
                        let run = BenchRun { particles, occupancy, precision, execution };
                        scenes.push((PhaseTimedRun::new(run, &seed)?, false));
                    }
                }
            }
        }
        Ok(DrillScenes(scenes))
    }

    /// Measures every scene without a measurement, and others as long as there is time until `end`.
    pub(super) fn sweep(&mut self, end: Instant) -> Result<(), MeasurementError> {
        for (scene, is_measured) in &mut self.0 {
            if !*is_measured || Instant::now() < end {
                scene.measure()?;
                *is_measured = true;
            }
        }
        Ok(())
    }

    /// Smallest and largest number of discs.
    pub(super) fn discs(&self) -> [f64; 2] {
        [PARTICLES[0], PARTICLES[PARTICLES.len() - 1]].map(|discs| discs as f64)
    }

    /// Fitted rates of the methods.
    pub(super) fn rates(&self) -> BTreeMap<String, PhaseRates> {
        let mut methods = BTreeMap::<String, PhaseRates>::new();
        for method in ["fast", "fast, sparse", "fast lists", "lists"] {
            for precision in PRECISIONS {
                let is_alike = |run: &BenchRun| (run.rates(), run.precision) == (Some(method), precision);
                let alike = || self.0.iter().map(|(scene, _)| scene).filter(|scene| is_alike(&scene.run));
                let upkeep = Phase::ALL.iter().map(|&phase| {
                    let done = alike().map(|it| {
                        (relevant_amounts(phase, &it.amounts_per_step()), it.phase_time_without_builds(phase))
                    });
                    (phase.name(), fit_units(done))
                });
                let making = alike().filter_map(|it| {
                    let Amounts { discs: remade, candidates: relisted, .. } = it.amounts_per_step();
                    Some((
                        Amounts { makings: 1.0, remade, relisted, ..Amounts::default() },
                        it.list_build_time()?,
                    ))
                });
                for (phase, units) in upkeep.chain([(MAKING, fit_units(making))]) {
                    let Some(units) = units else { continue };
                    let rates = methods.entry(method.to_owned()).or_default();
                    rates.entry(phase.to_owned()).or_default().insert(precision.to_owned(), units);
                }
            }
        }
        methods
    }
}

/// Cost of each unit, fitted to amounts and nanoseconds of runs; `None` without such work.
fn fit_units(done: impl Iterator<Item = (Amounts, f64)>) -> Option<AmountUnits> {
    let rows = done.filter(|(_, ns)| *ns > 0.0);
    let rows: Vec<_> = rows.map(|(amounts, ns)| FitRow { features: amounts.values(), ns }).collect();
    (!rows.is_empty()).then(|| fit_robustly(&rows))
}

/// Units that a phase can depend on; others would only fit the noise.
fn relevant_amounts(phase: Phase, amounts: &Amounts) -> Amounts {
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

    /// The majority determines the fit even if runs scatter by a factor of a thousand, as on a busy machine. A unit without work costs nothing.
    #[test]
    fn scattered_runs_do_not_bias_units() {
        let done = |(at, scatter): (usize, f64)| {
            let amounts = Amounts { discs: 100.0 * 4f64.powi(at as i32), ..Amounts::default() };
            (amounts, 2.0 * scatter * amounts.discs)
        };
        let scatter = [1.0, 900.0, 0.8, 1.1, 40.0, 1.2, 0.9].into_iter().enumerate();
        let units = fit_units(scatter.map(done)).unwrap();
        assert!((1.0..4.0).contains(&units[1]), "{units:?}");
        assert_eq!(units.iter().filter(|unit| **unit > 0.0).count(), 1);
        assert_eq!(super::fit_units(std::iter::empty()), None);
    }

    #[test]
    fn discs_and_contacts_are_distinguished() {
        let done = |discs: f64, contacts: f64| {
            (Amounts { discs, contacts, ..Amounts::default() }, 2.0 * discs + 5.0 * contacts)
        };
        let found = fit_units([done(100.0, 10.0), done(100.0, 70.0), done(1000.0, 1.0)].into_iter()).unwrap();
        assert!((found[1] - 2.0).abs() < 1e-3 && (found[4] - 5.0).abs() < 1e-3, "{found:?}");
    }
}
