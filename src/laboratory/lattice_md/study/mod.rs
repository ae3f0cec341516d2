//! Studies of lattice MD, each a function from parameters to a dataset.

pub(super) mod calibration;
pub(super) mod corrector;
pub(super) mod damping;
pub(super) mod density_cost;
pub(super) mod efficiency_table;
pub(super) mod identity;
pub(super) mod ladder;
pub(super) mod listing;
pub(super) mod mask;
pub(super) mod misprints;
pub(super) mod model_validation;
pub(super) mod other_models;
mod phase_times;
pub(super) mod pipe_flow;
pub(super) mod precision;
pub(super) mod printed;
mod samples;
pub(super) mod scaling;
pub(super) mod searches;
pub(super) mod unequal;
pub(super) mod useful_work;
pub(super) mod wave_spectra;

use crate::study::StudyError;
