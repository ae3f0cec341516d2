//! What do forces, energy and trajectories lose in f32 and in mixed precision?
//!
//! All of it on the bench scene. Nothing here depends on the host: every execution gives the same bits everywhere.

pub mod energy;
pub mod forces;
pub mod trajectories;

use super::StudyError;
use crate::method::Method;
use crate::observe::Scenery;
use crate::particles::Particles;
use crate::run::{assemble, model};
use crate::scene::Document;
use energy::EnergyCase;
use forces::ForceError;
use serde::Serialize;
use stripmine_kernels::sweep::lattice::Coordinates;
use trajectories::Divergence;

/// The dataset.
#[derive(Clone, Debug, Serialize)]
pub struct Precisions {
    /// Errors of the forces on one configuration.
    pub forces: Vec<ForceError>,
    /// What the energy of an undamped gas does.
    pub energies: Vec<EnergyCase>,
    /// How far trajectories run apart.
    pub trajectories: Vec<Divergence>,
}

/// Packing fractions: nearly a solid, and a gas.
pub const PACKING_FRACTIONS: [f64; 2] = [0.84, 0.3];
/// Seeds of what is averaged.
pub const SEEDS: [u64; 3] = [1, 2, 3];
/// Steps in f64 before anything is compared: the start on a lattice has no contacts.
pub const EQUILIBRATION: u64 = 1000;

/// Does all of it. `progress` gets the share that is done.
///
/// # Errors
/// [`StudyError`] if a scene breaks.
pub fn precision(progress: impl Fn(f64) + Sync) -> Result<Precisions, StudyError> {
    // Shares of the time, about.
    let (forces_end, trajectories_end) = (0.3, 0.4);
    let forces = forces::force_errors(|share| progress(forces_end * share))?;
    let trajectories = trajectories::divergences()?;
    progress(trajectories_end);
    let energies = energy::energies(|share| progress(trajectories_end + (1.0 - trajectories_end) * share))?;
    Ok(Precisions { forces, energies, trajectories })
}

/// A running bench scene.
struct Gas {
    method: Box<dyn Method>,
    scenery: Scenery,
}

impl Gas {
    /// The bench scene with overrides, from `discs` where given.
    fn begin(overrides: &[String], discs: Option<&Particles>) -> Result<Gas, StudyError> {
        Gas::seen_from(Coordinates::CellRelative, overrides, discs)
    }

    /// The same with positions seen from there, also where a run would be refused because single precision loses motion: what
    /// that does is the question here.
    fn seen_from(
        coordinates: Coordinates,
        overrides: &[String],
        discs: Option<&Particles>,
    ) -> Result<Gas, StudyError> {
        let mut checked = Document::load("bench", overrides)?.check()?;
        checked.scene.method.coordinates = coordinates;
        if let Some(discs) = discs {
            checked.particles = discs.clone();
        }
        Ok(Gas { method: assemble(&checked)?, scenery: Scenery::of(&model(&checked)) })
    }

    /// The same after [`EQUILIBRATION`] steps in f64 with velocity Verlet.
    fn equilibrated(overrides: &[String]) -> Result<Particles, StudyError> {
        let mut overrides = overrides.to_vec();
        overrides
            .extend(["method.execution=\"fast\"", "integrator.kind=\"velocity-verlet\""].map(str::to_owned));
        let mut gas = Gas::begin(&overrides, None)?;
        gas.advance(EQUILIBRATION)?;
        Ok(gas.method.particles())
    }

    fn advance(&mut self, steps: u64) -> Result<(), StudyError> {
        Ok((0..steps).try_for_each(|_| self.method.step())?)
    }
}

/// Number of discs, density and seed, as overrides.
fn place(count: usize, packing_fraction: f64, seed: u64) -> Vec<String> {
    vec![
        format!("particles.count={count}"),
        format!("particles.packing_fraction={packing_fraction}"),
        format!("particles.seed={seed}"),
    ]
}
