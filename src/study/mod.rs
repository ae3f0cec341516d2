//! Studies of any method that states its trials: speed against accuracy, stability, plans. They use the entries of methods alone.

mod alarm;
mod case;
mod choice;
mod error;
pub(crate) mod explain;
mod items;
mod observed;
pub(crate) mod rivals;
mod runs;
mod rvv;
pub(crate) mod scaling;
mod short_texts;
pub(crate) mod stability;
mod state;
mod subject;
pub(crate) mod trial;
pub(crate) mod work_precision;

pub(crate) use case::StudyCase;
pub(crate) use choice::SettingChoice;
pub(crate) use choice::TIE;
pub(crate) use error::StudyError;
pub(crate) use items::ITEMS;
pub(crate) use short_texts::{first_line, rounded};
pub(crate) use subject::Subject;
