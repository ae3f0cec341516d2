//! What is run, and how often.

use crate::method::lattice_md::study::calibration::CalibrationError;
use crate::method::lattice_md::study::phase_times::{FAST, FAST_LISTS, LISTS, Run};
use crate::method::lattice_md::study::rounds::Bound;
use crate::method::throughput::MeasurementError;
use crate::model::host::OutOfRange;
use stripmine_kernels::Execution;

/// What is run.
#[derive(Clone, Debug)]
pub struct Effort {
    /// NP.
    pub particles: Vec<usize>,
    /// ρ on cells as wide as the radius.
    pub occupancies: Vec<f64>,
    /// Rounds over all runs, each laid out in memory again: within a round, the other programs on the machine and their data in
    /// the larger caches change little.
    pub rounds: Bound,
    /// Further rounds, at most, over those runs alone that were always disturbed or do not repeat themselves yet: in pairs, as
    /// rounds of even and of odd number are compared.
    pub further: usize,
    /// Repeats of a run in a round.
    pub repeats: usize,
    /// Particle-steps of a repeat, about.
    pub particle_steps: usize,
}

/// The executions, by the name that a scene gives them; the last three depend on the data. Strips as long as a CRAY's vectors
/// are drilled on other lattices, the longer ones on none.
pub(super) const EXECUTIONS: [(&str, Option<Execution>); 8] = [
    ("eager", Some(Execution::Eager)),
    ("strip:64", Some(Execution::Strip(64))),
    ("strip:128", Some(Execution::Strip(128))),
    ("strip:512", Some(Execution::Strip(512))),
    ("chained", Some(Execution::Chained)),
    (FAST, None),
    (FAST_LISTS, None),
    (LISTS, None),
];

pub(super) const PRECISIONS: [&str; 3] = ["f64", "f32", "mixed"];

/// Runs whose halves are farther apart than this share are run again; and those that were always disturbed.
pub const UNSETTLED: f64 = 0.1;
/// Why there is no validation.
#[derive(Debug, thiserror::Error)]
pub enum ValidationError {
    /// A calibration broke.
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
    /// A run broke.
    #[error(transparent)]
    Measurement(#[from] MeasurementError),
    /// A case that the model does not reach.
    #[error("{case}: {cause}")]
    OutOfRange {
        /// The case.
        case: String,
        /// Why.
        cause: OutOfRange,
    },
}

/// Every run, in order.
pub(super) fn runs(effort: &Effort) -> impl Iterator<Item = Run> {
    let places = effort
        .particles
        .iter()
        .flat_map(|&particles| effort.occupancies.iter().map(move |&occupancy| (particles, occupancy)));
    places.flat_map(|(particles, occupancy)| {
        PRECISIONS.into_iter().flat_map(move |precision| {
            EXECUTIONS.map(|(execution, _)| Run { particles, occupancy, precision, execution })
        })
    })
}
