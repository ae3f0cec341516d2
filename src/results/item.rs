//! What can be reproduced: a table or figure of a source, or of our own, by its name.

use super::{Effort, Made};
use crate::console;
use crate::report::Chapter;

/// Where the share of a piece of work that is done is heard.
pub type Progress<'p> = &'p (dyn Fn(f64) + Sync);

/// What makes an item.
type Make = fn(Effort, Progress<'_>) -> Result<Made, console::Failure>;

/// A table or figure of the report.
#[derive(Debug)]
pub struct Item {
    /// The name on the command line.
    pub name: &'static str,
    /// Its chapter of the report.
    pub chapter: Chapter,
    /// What it shows.
    pub doc: &'static str,
    /// Seconds that it takes about, quick and in full; none where it is not made quickly.
    seconds: (Option<f64>, f64),
    make: Make,
}

impl Item {
    /// One that is made in full only: with seconds that it takes about.
    pub const fn full(
        name: &'static str,
        chapter: Chapter,
        seconds: f64,
        make: Make,
        doc: &'static str,
    ) -> Item {
        Item { name, chapter, doc, seconds: (None, seconds), make }
    }

    /// One that is also made where only little time is given, with seconds that it takes about: quick, in full. What is the same on
    /// every host is the same in both.
    pub const fn quick(
        name: &'static str,
        chapter: Chapter,
        [quick, full]: [f64; 2],
        make: Make,
        doc: &'static str,
    ) -> Item {
        Item { name, chapter, doc, seconds: (Some(quick), full), make }
    }

    /// Whether it is made where only little time is given and it is not asked for by name.
    pub const fn is_quick(&self) -> bool {
        self.seconds.0.is_some()
    }

    /// Seconds that it takes about.
    pub fn seconds(&self, effort: Effort) -> f64 {
        let (quick, full) = self.seconds;
        if effort == Effort::Full { full } else { quick.unwrap_or(full) }
    }

    /// Makes it.
    ///
    /// # Errors
    /// Those of its study.
    pub fn make(&self, effort: Effort, progress: Progress<'_>) -> Result<Made, console::Failure> {
        let mut made = (self.make)(effort, progress)?;
        made.section.chapter = self.chapter;
        Ok(made)
    }
}
