//! The sections of the report that are this method's: a study's dataset as text, tables and figures. None runs physics.

pub mod break_even;
pub mod crossover;
pub mod measured_cost;
pub mod printed_cost;
pub mod threads;
