//! The studies of this method: one file per question a user asks, each a function from parameters to a dataset.

pub mod calibration;
pub mod corrector;
pub mod damping;
pub mod density_cost;
pub mod efficiency_table;
pub mod identity;
pub mod ladder;
pub mod listing;
pub mod mask;
pub mod misprints;
pub mod model_validation;
pub mod phase_times;
pub mod pipe_flow;
pub mod precision;
pub mod predicted_step;
pub(super) mod printed;
mod reported;
pub mod rounds;
pub mod samples;
pub(super) mod searches;
pub mod useful_work;

pub use crate::study::StudyError;
