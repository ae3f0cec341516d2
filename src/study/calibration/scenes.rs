//! Work whose amount hangs on the data: the fast execution and the neighbour lists, on drill scenes of their own.

use super::fit;
use crate::method::Phase;
use crate::model::host::{Amounts, RatePoint, Rates};
use crate::scene::Checked;
use crate::study::phase_times::{FAST, FAST_LISTS, LISTS, PhaseTimes, Run, Sampling, phase_times};
use crate::study::throughput::MeasurementError;
use std::collections::BTreeMap;

/// NP of the drill scenes.
pub(super) const PARTICLES: [usize; 5] = [60, 400, 3000, 12_000, 32_000];
/// ρ of the drill scenes; the first three are sparse.
const OCCUPANCIES: [f64; 6] = [0.03, 0.07, 0.12, 0.17, 0.21, 0.26];
const PRECISIONS: [&str; 3] = ["f64", "f32", "mixed"];

/// Steps before the clock starts, and those that are timed: fewer of many discs, but enough for lists to be made anew.
fn sampling(run: &Run) -> Sampling {
    let discs = if run.has_lists() { 250_000 } else { 100_000 };
    let equilibration = (discs / run.particles).clamp(3, 60);
    Sampling { equilibration, repeats: 3, particle_steps: 10_000, least_steps: 2 }
}

/// Every drill scene, and what was measured of it.
pub(super) struct Scenes(Vec<(Run, Checked, Option<PhaseTimes>)>);

impl Scenes {
    /// Nothing measured yet.
    pub(super) fn new() -> Result<Scenes, MeasurementError> {
        let mut scenes = vec![];
        for particles in PARTICLES {
            for occupancy in OCCUPANCIES {
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
    pub(super) fn sweep(&mut self, progress: impl Fn(f64)) -> Result<(), MeasurementError> {
        let all = self.0.len() as f64;
        for (at, (run, checked, times)) in self.0.iter_mut().enumerate() {
            let more = phase_times(checked, &sampling(run))?;
            *times = Some(match times.take() {
                Some(before) => before.joined(more),
                None => more,
            });
            progress((at + 1) as f64 / all);
        }
        Ok(())
    }

    /// The rates of the methods, at the pace of a reference.
    pub(super) fn rates(&self, reference: f64) -> BTreeMap<String, Rates> {
        let measured = self.0.iter().filter_map(|(run, _, times)| Some((*run, times.as_ref()?)));
        rates(&measured.collect::<Vec<_>>(), reference)
    }
}

fn rates(measured: &[(Run, &PhaseTimes)], reference: f64) -> BTreeMap<String, Rates> {
    let mut methods: BTreeMap<String, Rates> = BTreeMap::new();
    for particles in PARTICLES {
        for precision in PRECISIONS {
            for method in ["fast", "fast, sparse", "fast lists", "lists"] {
                let alike: Vec<&PhaseTimes> = measured
                    .iter()
                    .filter(|(run, _)| {
                        run.particles == particles
                            && run.precision == precision
                            && run.rates() == Some(method)
                    })
                    .map(|(_, times)| *times)
                    .collect();
                let phases =
                    methods.entry(method.to_owned()).or_default().0.entry(precision.to_owned()).or_default();
                for &phase in Phase::ALL {
                    if alike.iter().all(|times| times.quiet(phase, reference) == 0.0) {
                        continue;
                    }
                    let points: &mut Vec<RatePoint> = phases.entry(phase.name().to_owned()).or_default();
                    let mut point = point(&alike, phase, reference);
                    // Of many discs few steps are run, and no lists may have been made: as of fewer discs, then.
                    if let Some(before) = points.last().filter(|_| !point.makes_lists()) {
                        let made = before.ns.iter().filter(|(unit, _)| MAKING.contains(&unit.as_str()));
                        point.ns.extend(made.map(|(unit, ns)| (unit.clone(), *ns)));
                    }
                    points.push(point);
                }
            }
        }
    }
    methods
}

/// The units of making lists.
const MAKING: [&str; 2] = ["remade", "relisted"];

impl RatePoint {
    fn makes_lists(&self) -> bool {
        MAKING.iter().any(|&unit| self.ns.contains_key(unit))
    }
}

/// What each unit takes in a phase.
fn point(alike: &[&PhaseTimes], phase: Phase, reference: f64) -> RatePoint {
    let quiet = alike.iter().map(|times| (charged(phase, &times.amounts), times.quiet(phase, reference)));
    let mut ns = per_unit(quiet);
    if phase == Phase::Index {
        let makings = alike.iter().filter_map(|times| {
            let Amounts { discs, candidates, .. } = times.amounts;
            let amounts = Amounts { remade: discs, relisted: candidates, ..Amounts::default() };
            Some((amounts, times.making(reference)?))
        });
        ns.extend(per_unit(makings));
    }
    RatePoint {
        discs: alike.iter().map(|times| times.amounts.discs as usize).max().unwrap_or(0),
        ns: ns.into_iter().map(|(name, ns)| (name.to_owned(), ns)).collect(),
    }
}

/// Nanoseconds of each unit that costs some, from amounts and the nanoseconds that they took.
fn per_unit(measured: impl Iterator<Item = (Amounts, f64)>) -> Vec<(&'static str, f64)> {
    let rows = measured.filter(|(_, ns)| *ns > 0.0);
    let rows: Vec<_> = rows.map(|(amounts, ns)| (amounts.values().map(|amount| amount / ns), 1.0)).collect();
    let ns = fit::non_negative(&rows);
    Amounts::NAMES.into_iter().zip(ns).filter(|(_, ns)| *ns > 0.0).collect()
}

/// The units that a phase can depend on: others would only fit the noise.
fn charged(phase: Phase, amounts: &Amounts) -> Amounts {
    let Amounts { discs, cells, candidates, contacts, .. } = *amounts;
    let none = Amounts { discs, ..Amounts::default() };
    match phase {
        Phase::Forces => Amounts { cells, candidates, contacts, ..none },
        Phase::Index => Amounts { cells, ..none },
        Phase::Predict | Phase::CorrectPredict | Phase::Correct => none,
    }
}
