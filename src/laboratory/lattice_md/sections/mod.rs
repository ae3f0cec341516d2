//! The sections of the report that are this method's: a study's dataset as text, tables and figures. None runs physics.

pub mod break_even;
pub mod calibration;
pub mod crossover;
pub mod ladder;
pub mod measured_cost;
pub mod model_validation;
pub mod printed_cost;
pub mod threads;
