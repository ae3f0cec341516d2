//! Steps whose work depends on the data: the fast engine and the neighbour lists, on drill scenes of their own.

use crate::laboratory::lattice_md::study::phase_times::{
    FAST, FAST_LISTS, LISTS, PhaseTimes, Run, Sampling, phase_times,
};
use crate::model::host::Steps;
use std::time::Instant;
use stripmine_physics::method::lattice_md::Phase;
use stripmine_physics::method::throughput::MeasurementError;
use stripmine_physics::scene::SEED;

/// NP of the drill scenes: close enough to each other that no level of memory ends unseen between two of them.
const PARTICLES: [usize; 6] = [60, 220, 900, 3300, 11_000, 32_000];
/// ρ of the drill scenes. At 0.15 a lattice is searched by another algorithm.
const OCCUPANCIES: [f64; 8] = [0.01, 0.02, 0.04, 0.08, 0.149, 0.151, 0.2, 0.26];
const PRECISIONS: [&str; 3] = ["f64", "f32", "mixed"];

/// Steps before the clock starts, and those that are timed: fewer of many discs, but enough for lists to be rebuilt.
fn sampling(run: &Run) -> Sampling {
    let discs = if run.has_lists() { 250_000 } else { 100_000 };
    let equilibration = (discs / run.particles).clamp(3, 60);
    Sampling { equilibration, repeats: 1, particle_steps: 10_000, least_steps: 2 }
}

/// Every drill scene, and what was measured of it.
pub(super) struct Scenes(Vec<(Run, Option<PhaseTimes>)>);

impl Scenes {
    /// Nothing measured yet.
    pub(super) fn new() -> Scenes {
        let places = PARTICLES.iter().flat_map(|&discs| OCCUPANCIES.map(|occupancy| (discs, occupancy)));
        let runs = places.flat_map(|(particles, occupancy)| {
            PRECISIONS.into_iter().flat_map(move |precision| {
                [FAST, FAST_LISTS, LISTS].map(|execution| Run { particles, occupancy, precision, execution })
            })
        });
        Scenes(runs.map(|run| (run, None)).collect())
    }

    /// Runs once more every scene of which there is nothing yet, and of the others those for which there is time until `end`.
    pub(super) fn sweep(&mut self, end: Instant) -> Result<(), MeasurementError> {
        for (run, times) in &mut self.0 {
            if times.is_none() || Instant::now() < end {
                let more = phase_times(&run.scene(|scene| scene.set(&SEED, 11_u64))?, &sampling(run))?;
                *times = Some(PhaseTimes::with(times.take(), more));
            }
        }
        Ok(())
    }

    /// The phases as they were timed.
    pub(super) fn steps(&self) -> Steps {
        let mut steps = Steps {
            discs: PARTICLES.map(|discs| discs as f64).to_vec(),
            occupancies: OCCUPANCIES.to_vec(),
            ..Steps::default()
        };
        // In the order of the numbers of discs, and for each of these of the occupancies.
        for (run, times) in &self.0 {
            let precisions = steps.ns.entry(run.execution.to_owned()).or_default();
            let phases = precisions.entry(run.precision.to_owned()).or_default();
            for phase in Phase::ALL {
                let ns = times.as_ref().map_or(0.0, |times| times.of(*phase));
                let grid = phases.entry(phase.name().to_owned()).or_default();
                if grid.last().is_none_or(|row| row.len() == OCCUPANCIES.len()) {
                    grid.push(vec![]);
                }
                grid.last_mut().into_iter().for_each(|row| row.push(ns));
            }
        }
        // Not every method has every phase.
        let precisions = steps.ns.values_mut().flat_map(|of| of.values_mut());
        precisions.for_each(|phases| phases.retain(|_, grid| grid.iter().flatten().any(|&ns| ns > 0.0)));
        steps
    }
}
