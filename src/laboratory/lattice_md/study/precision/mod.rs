//! Forces, energy and trajectories in f32 and in mixed precision.
//!
//! All of it runs the bench scene. Nothing depends on the host: an engine gives the same bits everywhere.

mod energy;
mod forces;
mod gas;
mod trajectories;

use crate::console::Failure;
use crate::results::{Lab, Made, Size};
use gas::SEEDS;

/// Errors of forces, energies of undamped gases, and divergence of trajectories.
pub(crate) fn made(lab: &Lab<'_>, _: Size) -> Result<Made, Failure> {
    // Shares of the time, about.
    let (forces_end, trajectories_end) = (0.3, 0.4);
    let forces = forces::frame(|share| (lab.progress)(forces_end * share))?;
    let trajectories = trajectories::frames()?;
    (lab.progress)(trajectories_end);
    let rest = |share| (lab.progress)(trajectories_end + (1.0 - trajectories_end) * share);
    let frames = [forces].into_iter().chain(energy::frames(&rest)?).chain(trajectories);
    Ok(Made::of(frames).with_seeds(SEEDS))
}
