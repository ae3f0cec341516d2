//! Work whose amount hangs on the data: the fast execution and the neighbour lists, on drill scenes of their own.

use super::fit;
use crate::method::Phase;
use crate::model::host::{Amounts, RatePoint, Rates};
use crate::scene::Checked;
use crate::study::phase_times::{FAST, LISTS, PhaseTimes, Run, Sampling, phase_times};
use crate::study::throughput::MeasurementError;
use std::collections::BTreeMap;

/// NP of the drill scenes.
pub(super) const PARTICLES: [usize; 5] = [60, 400, 3000, 15_000, 60_000];
/// ρ of the drill scenes; the first two are sparse.
const OCCUPANCIES: [f64; 5] = [0.03, 0.09, 0.16, 0.21, 0.26];
const PRECISIONS: [&str; 3] = ["f64", "f32", "mixed"];

/// Steps before the clock starts, and those that are timed: fewer of many discs.
fn sampling(particles: usize) -> Sampling {
    let equilibration = (200_000 / particles).clamp(4, 30);
    Sampling { equilibration, repeats: 3, particle_steps: 15_000, least_steps: 4 }
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
                    for execution in [FAST, LISTS] {
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
            let more = phase_times(checked, &sampling(run.particles))?;
            *times = Some(match times.take() {
                Some(before) => before.joined(more),
                None => more,
            });
            progress((at + 1) as f64 / all);
        }
        Ok(())
    }

    /// The rates of the methods.
    pub(super) fn rates(&self) -> BTreeMap<String, Rates> {
        let measured = self.0.iter().filter_map(|(run, _, times)| Some((*run, times.as_ref()?)));
        rates(&measured.collect::<Vec<_>>())
    }
}

fn rates(measured: &[(Run, &PhaseTimes)]) -> BTreeMap<String, Rates> {
    let mut methods: BTreeMap<String, Rates> = BTreeMap::new();
    for particles in PARTICLES {
        for precision in PRECISIONS {
            for method in ["fast", "fast, sparse", "lists"] {
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
                    if alike.iter().all(|times| times.best(phase) == 0.0) {
                        continue;
                    }
                    let points: &mut Vec<RatePoint> = phases.entry(phase.name().to_owned()).or_default();
                    points.push(point(&alike, phase));
                }
            }
        }
    }
    methods
}

/// What each unit takes in a phase.
fn point(alike: &[&PhaseTimes], phase: Phase) -> RatePoint {
    let rows = alike.iter().map(|times| {
        let ns = times.best(phase).max(1.0);
        (charged(phase, &times.amounts).values().map(|amount| amount / ns), 1.0)
    });
    let ns = fit::non_negative(&rows.collect::<Vec<_>>());
    let named = Amounts::NAMES.iter().zip(ns).filter(|(_, ns)| *ns > 0.0);
    RatePoint {
        discs: alike.iter().map(|times| times.amounts.discs as usize).max().unwrap_or(0),
        ns: named.map(|(name, ns)| ((*name).to_owned(), ns)).collect(),
    }
}

/// The units that a phase can depend on: others would only fit the noise.
fn charged(phase: Phase, amounts: &Amounts) -> Amounts {
    let Amounts { discs, cells, candidates, contacts, relisted } = *amounts;
    let none = Amounts { discs, ..Amounts::default() };
    match phase {
        Phase::Forces => Amounts { cells, candidates, contacts, ..none },
        Phase::Index => Amounts { cells, relisted, ..none },
        Phase::Predict | Phase::CorrectPredict | Phase::Correct => none,
    }
}
