//! What do forces, energy and trajectories lose in f32 and in mixed precision?
//!
//! All of it on the bench scene. Nothing here depends on the host: an engine gives the same bits everywhere.

pub mod energy;
pub mod forces;
mod gas;
pub mod trajectories;

pub use gas::{EQUILIBRATION, PACKING_FRACTIONS, SEEDS};

use super::StudyError;
use crate::results::Progress;
use energy::EnergyCase;
use forces::ForceError;
use serde::Serialize;
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

/// Does all of it. `progress` gets the share that is done.
///
/// # Errors
/// [`StudyError`] if a scene breaks.
pub fn precision(progress: Progress<'_>) -> Result<Precisions, StudyError> {
    // Shares of the time, about.
    let (forces_end, trajectories_end) = (0.3, 0.4);
    let forces = forces::force_errors(|share| progress(forces_end * share))?;
    let trajectories = trajectories::divergences()?;
    progress(trajectories_end);
    let energies = energy::energies(&|share| progress(trajectories_end + (1.0 - trajectories_end) * share))?;
    Ok(Precisions { forces, energies, trajectories })
}
