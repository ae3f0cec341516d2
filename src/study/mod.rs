//! Studies that any method joins by stating its trials: speed against accuracy. They know methods by their entries alone.

mod alarm;
mod case;
mod choice;
mod error;
pub mod explain;
mod items;
mod observed;
pub mod rivals;
mod runs;
pub mod scaling;
mod shortened;
pub mod stability;
mod state;
mod subject;
pub(crate) mod trial;
pub mod work_precision;

pub use case::Case;
pub use choice::Choice;
pub(crate) use choice::TIE;
pub use error::StudyError;
pub use items::ITEMS;
pub(crate) use shortened::{first_line, rounded};
pub use subject::Subject;
