//! The studies of this method: one file per question a user asks, each a function from parameters to a dataset.

pub mod break_even;
pub mod calibration;
pub mod corrector;
pub mod crossover;
pub mod damping;
pub mod density_cost;
pub mod efficiency_table;
pub mod identity;
pub mod ladder;
pub mod listing;
pub mod mask;
pub mod measured_cost;
pub mod misprints;
pub mod model_validation;
pub mod phase_times;
pub mod pipe_flow;
pub mod precision;
pub mod predicted_step;
pub mod printed_cost;
mod reported;
pub mod rounds;
pub mod samples;
pub mod threads;
pub mod useful_work;

pub use crate::study::StudyError;

use stripmine_physics::method::lattice_md::Document;
use stripmine_physics::method::throughput::{MeasurementError, TimedRun};

/// A scene of discs that runs, and is timed again and again: `equilibration` steps first, then repeats of `steps`.
///
/// # Errors
/// [`MeasurementError`] if the scene is bad or breaks while running.
fn running(document: Document, equilibration: u64, steps: u64) -> Result<TimedRun, MeasurementError> {
    let bench = document.bench();
    TimedRun::begin(bench, document.prepare()?, equilibration, steps)
}
