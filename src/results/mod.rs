//! Results: what a finished item holds, the folder that items are written to, and the runs that a study has finished.

mod folder;
mod item;
mod journal;
mod journal_error;
mod meter;
mod own_files;
mod team;

pub use folder::{Folder, FolderError};
pub use item::{Item, Progress};
pub use journal::{Identity, Journal};
pub use journal_error::JournalError;
pub use meter::Meter;
pub(crate) use own_files::OwnFiles;
pub use team::Team;

use crate::console::Failure;
use crate::report::{Section, Table};
use serde::Serialize;

/// How much is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// Under a minute in all.
    Quick,
    /// As much as the sources show, in five minutes.
    Full,
    /// More of the items that say so, for hours to spare.
    All,
}

/// A finished item.
pub struct Made {
    /// What is shown of it.
    pub section: Section,
    /// The dataset.
    pub data: serde_json::Value,
    /// Tables for programs that the page does not show.
    pub tables: Vec<Table>,
    /// Further files: name and contents.
    pub files: Vec<(String, String)>,
}

impl Made {
    /// Of a section and its dataset.
    ///
    /// # Errors
    /// If the dataset, or the section, is none that JSON can hold: a number that is none comes back as nothing.
    pub fn new(section: Section, data: &impl Serialize) -> Result<Made, Failure> {
        let data = serde_json::to_value(data).map_err(|cause| Failure::writing("JSON")(cause.into()))?;
        // It is read when the page is made again.
        serde_json::to_vec(&section)
            .and_then(|text| serde_json::from_slice::<Section>(&text))
            .map_err(|cause| Failure::writing("JSON")(cause.into()))?;
        Ok(Made { section, data, tables: vec![], files: vec![] })
    }

    /// An item of several scenes, each with a name, under which its data stands.
    ///
    /// # Errors
    /// If the dataset is none that JSON can hold.
    pub fn by_name<T: Serialize>(section: Section, scenes: &[(String, T)]) -> Result<Made, Failure> {
        let one = |(name, data): &(String, T)| Ok((name.clone(), serde_json::to_value(data)?));
        let all = scenes.iter().map(one).collect::<serde_json::Result<serde_json::Map<_, _>>>();
        Made::new(section, &all.map_err(|cause| Failure::writing("JSON")(cause.into()))?)
    }

    /// With tables for programs that the page does not show.
    #[must_use]
    pub fn with_tables(mut self, tables: impl IntoIterator<Item = Table>) -> Made {
        self.tables.extend(tables);
        self
    }

    /// With one more file.
    #[must_use]
    pub fn with_file(mut self, name: &str, text: String) -> Made {
        self.files.push((name.to_owned(), text));
        self
    }
}
