//! Forces, energy and trajectories in f32 and in mixed precision, on the bench scene.
//!
//! Results do not depend on the host: an engine gives the same bits everywhere.

mod energy;
mod forces;
mod gas;
mod trajectories;

use crate::console::CommandFailure;
use crate::results::{FinishedItem, StudyEnvironment, StudySize};
use gas::SEEDS;

/// Measures force errors, energies of undamped gases, and divergence of trajectories.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    // Approximate shares of the time.
    let (forces_end, trajectories_end) = (0.3, 0.4);
    let forces = forces::frame(|share| (lab.progress)(forces_end * share))?;
    let trajectories = trajectories::frames()?;
    (lab.progress)(trajectories_end);
    let rest = |share| (lab.progress)(trajectories_end + (1.0 - trajectories_end) * share);
    let frames = [forces].into_iter().chain(energy::frames(&rest)?).chain(trajectories);
    Ok(FinishedItem::of(frames).with_seeds(SEEDS))
}
