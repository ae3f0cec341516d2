//! The sections of the report that are this method's: a study's dataset as text, tables and figures. None runs physics.

pub mod break_even;
pub mod calibration;
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
pub mod pipe_flow;
pub mod precision;
pub mod printed_cost;
pub mod threads;
pub mod useful_work;
