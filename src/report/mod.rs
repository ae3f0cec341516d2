//! Reports: finished data as tables. Each export is one small file; none of them runs physics.

pub mod break_even;
pub mod calibration;
pub mod crossover;
pub mod csv;
pub mod damping;
pub mod density_cost;
pub mod efficiency_table;
pub mod figure;
pub mod html;
pub mod identity;
pub mod ladder;
pub mod listing;
pub mod markdown;
pub mod mask;
pub mod measured_cost;
pub mod misprints;
pub mod model_validation;
pub mod page;
pub mod pipe_flow;
pub mod precision;
pub mod section;
pub mod table;
pub mod terminal;
pub mod threads;
pub mod useful_work;

pub use section::{Section, Verdict};
pub use table::{Cell, Table};
