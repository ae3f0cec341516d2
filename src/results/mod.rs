//! Results: finished items, the folder they are written to, and the journal of a study.

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

/// Environment of a study.
pub(crate) struct Lab<'p> {
    /// Receives the finished fraction of the work.
    pub progress: Progress<'p>,
    /// Program that measures in separate processes; none if this process measures.
    pub program: Option<PathBuf>,
}

impl<'p> Lab<'p> {
    /// Environment that measures in this process.
    #[cfg(test)]
    pub(crate) fn here(progress: Progress<'p>) -> Lab<'p> {
        Lab { progress, program: None }
    }

    /// Environment that measures in separate processes.
    pub(crate) fn apart(progress: Progress<'p>) -> Lab<'p> {
        Lab { progress, program: std::env::current_exe().ok() }
    }
}

/// Size of a study.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Size {
    /// All items together take under a minute.
    Quick,
    /// The extent of the papers, in five minutes.
    Full,
    /// Larger items where available, for hours.
    All,
}

/// Finished item.
#[derive(Default)]
pub(crate) struct Made {
    pub frames: Vec<Frame>,
    /// Pictures that are not charts of frames, by name.
    pub pictures: Vec<(String, Picture)>,
    pub(crate) film: Option<Film>,
    /// Further files: name and contents.
    pub files: Vec<(String, String)>,
    /// Seeds of the random numbers.
    pub seeds: Vec<u64>,
    /// Number of processes that measured times; none if the provenance has it.
    pub(crate) processes: Option<usize>,
    /// Earlier measurements that it repeats.
    pub repeated: Vec<Measurement>,
}

impl Made {
    /// Item with tables, whose page is a template.
    pub(crate) fn of(frames: impl IntoIterator<Item = Frame>) -> Made {
        Made { frames: frames.into_iter().collect(), ..Made::default() }
    }

    /// Data as JSON: each frame by name, as a list of rows.
    pub(crate) fn json(&self) -> serde_json::Value {
        self.frames.iter().map(|frame| (frame.name.clone(), frame.json())).collect()
    }

    /// Adds a picture that is not a chart of a frame.
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

    /// Adds a file.
    #[must_use]
    pub(crate) fn with_file(mut self, name: &str, text: String) -> Made {
        self.files.push((name.to_owned(), text));
        self
    }
}
