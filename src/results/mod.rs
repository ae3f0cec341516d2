//! Results: finished items, the folder they are written to, and the journal of a study.

mod folder;
mod item;
mod item_files;
mod journal;
mod journal_error;
mod meter;
mod team;

pub use folder::Folder;
pub(crate) use item::{Item, Progress};
pub(crate) use journal::{Journal, JournalIdentity};
pub(crate) use journal_error::JournalError;
pub(crate) use meter::{ProgressMeter, run_in_parallel};
pub(crate) use team::ProcessTeam;

use crate::frame::ResultFrame;
use crate::provenance::RepeatedMeasurement;
use crate::report::figure::Picture;
use crate::report::section::Film;
use std::path::PathBuf;

/// Environment of a study.
pub(crate) struct StudyEnvironment<'p> {
    /// Receives the finished fraction of the work.
    pub progress: Progress<'p>,
    /// Program that measures in separate processes; none if this process measures.
    pub program: Option<PathBuf>,
}

impl<'p> StudyEnvironment<'p> {
    /// Environment that measures in this process.
    #[cfg(test)]
    pub(crate) fn here(progress: Progress<'p>) -> StudyEnvironment<'p> {
        StudyEnvironment { progress, program: None }
    }

    /// Environment that measures in separate processes.
    pub(crate) fn apart(progress: Progress<'p>) -> StudyEnvironment<'p> {
        StudyEnvironment { progress, program: std::env::current_exe().ok() }
    }
}

/// Size of a study.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StudySize {
    /// All items together take under a minute.
    Quick,
    /// The extent of the papers, in five minutes.
    Full,
    /// Larger items where available, for hours.
    All,
}

/// Finished item.
#[derive(Default)]
pub(crate) struct FinishedItem {
    pub frames: Vec<ResultFrame>,
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
    pub repeated: Vec<RepeatedMeasurement>,
}

impl FinishedItem {
    /// Item with tables, whose page is a template.
    pub(crate) fn of(frames: impl IntoIterator<Item = ResultFrame>) -> FinishedItem {
        FinishedItem { frames: frames.into_iter().collect(), ..FinishedItem::default() }
    }

    /// Data as JSON: each frame by name, as a list of rows.
    pub(crate) fn json(&self) -> serde_json::Value {
        self.frames.iter().map(|frame| (frame.name.clone(), frame.json())).collect()
    }

    /// Adds a picture that is not a chart of a frame.
    #[must_use]
    pub(crate) fn with_picture(mut self, name: &str, picture: Picture) -> FinishedItem {
        self.pictures.push((name.to_owned(), picture));
        self
    }

    /// Adds a film.
    #[must_use]
    pub(crate) fn with_film(self, film: Film) -> FinishedItem {
        FinishedItem { film: Some(film), ..self }
    }

    /// Adds the seeds of the random numbers.
    #[must_use]
    pub(crate) fn with_seeds(self, seeds: impl IntoIterator<Item = u64>) -> FinishedItem {
        FinishedItem { seeds: seeds.into_iter().collect(), ..self }
    }

    /// Adds a file.
    #[must_use]
    pub(crate) fn with_file(mut self, name: &str, text: String) -> FinishedItem {
        self.files.push((name.to_owned(), text));
        self
    }
}
