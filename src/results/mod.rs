//! Results: what a finished item holds, the folder that items are written to, and the runs that a study has finished.

mod folder;
mod item;
mod journal;
mod journal_error;
mod made;
mod meter;
mod team;

pub use folder::Folder;
pub(crate) use item::{Item, Progress};
pub(crate) use journal::{Identity, Journal};
pub(crate) use journal_error::JournalError;
pub(crate) use meter::{Meter, side_by_side};
pub(crate) use team::Team;

use crate::frame::Frame;
use crate::provenance::Measurement;
use crate::report::figure::Picture;
use crate::report::section::Film;
use std::path::PathBuf;

/// Surroundings of a study.
pub(crate) struct Lab<'p> {
    /// Hears the share of the work that is done.
    pub progress: Progress<'p>,
    /// Program that measures in processes of its own; none where this process measures.
    pub program: Option<PathBuf>,
}

impl<'p> Lab<'p> {
    /// Surroundings in which everything happens in this process.
    #[cfg(test)]
    pub(crate) fn here(progress: Progress<'p>) -> Lab<'p> {
        Lab { progress, program: None }
    }

    /// Surroundings in which processes of their own measure.
    pub(crate) fn apart(progress: Progress<'p>) -> Lab<'p> {
        Lab { progress, program: std::env::current_exe().ok() }
    }
}

/// Size of a study.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Size {
    /// Under a minute in all.
    Quick,
    /// As much as the sources show, in five minutes.
    Full,
    /// More of the items that say so, for hours to spare.
    All,
}

/// A finished item.
#[derive(Default)]
pub(crate) struct Made {
    pub frames: Vec<Frame>,
    /// Pictures that are no charts of frames, by name.
    pub pictures: Vec<(String, Picture)>,
    pub(crate) film: Option<Film>,
    /// Further files: name and contents.
    pub files: Vec<(String, String)>,
    /// Seeds of the random numbers.
    pub seeds: Vec<u64>,
    /// Processes that measured times; none where the record has them.
    pub(crate) processes: Option<usize>,
    /// Measurements that it repeats.
    pub repeated: Vec<Measurement>,
}

impl Made {
    /// An item whose page is a template.
    pub(crate) fn of(frames: impl IntoIterator<Item = Frame>) -> Made {
        Made { frames: frames.into_iter().collect(), ..Made::default() }
    }

    /// The data for programs: each frame by its name, as a list of rows.
    pub(crate) fn json(&self) -> serde_json::Value {
        self.frames.iter().map(|frame| (frame.name.clone(), frame.json())).collect()
    }

    /// Adds a picture that is no chart of a frame.
    #[must_use]
    pub(crate) fn with_picture(mut self, name: &str, picture: Picture) -> Made {
        self.pictures.push((name.to_owned(), picture));
        self
    }

    /// Adds a film.
    #[must_use]
    pub(crate) fn with_film(self, film: Film) -> Made {
        Made { film: Some(film), ..self }
    }

    /// Adds the seeds of the random numbers.
    #[must_use]
    pub(crate) fn with_seeds(self, seeds: impl IntoIterator<Item = u64>) -> Made {
        Made { seeds: seeds.into_iter().collect(), ..self }
    }

    /// With one more file.
    #[must_use]
    pub(crate) fn with_file(mut self, name: &str, text: String) -> Made {
        self.files.push((name.to_owned(), text));
        self
    }
}
