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
    cost: Cost,
    make: Make,
}

/// What an item takes on the two cores of the report's host.
#[derive(Debug)]
struct Cost {
    /// Seconds of a quick look; none where the item is made in full only.
    quick: Option<f64>,
    /// Seconds in full.
    full: f64,
    /// Seconds where `--all` asks for more of the item.
    all: Option<f64>,
    /// MiB of memory in full, at most.
    memory: u64,
}

/// MiB that most items stay below.
const USUAL_MEMORY: u64 = 256;

impl Item {
    /// An item that is made in full only, in about so many seconds.
    pub const fn full(
        name: &'static str,
        chapter: Chapter,
        seconds: f64,
        make: Make,
        doc: &'static str,
    ) -> Item {
        let cost = Cost { quick: None, full: seconds, all: None, memory: USUAL_MEMORY };
        Item { name, chapter, doc, cost, make }
    }

    /// An item that `--quick` makes too, with the seconds that it takes: quick, in full. Data that are the same on every host are the
    /// same in both.
    pub const fn quick(
        name: &'static str,
        chapter: Chapter,
        [quick, full]: [f64; 2],
        make: Make,
        doc: &'static str,
    ) -> Item {
        let cost = Cost { quick: Some(quick), full, all: None, memory: USUAL_MEMORY };
        Item { name, chapter, doc, cost, make }
    }

    /// The item with more of it by `--all`, in about so many seconds.
    pub const fn with_more(self, seconds: f64) -> Item {
        Item { cost: Cost { all: Some(seconds), ..self.cost }, ..self }
    }

    /// The item with the memory that it takes in full, where this is more than usual.
    pub const fn with_memory(self, mebibytes: u64) -> Item {
        Item { cost: Cost { memory: mebibytes, ..self.cost }, ..self }
    }

    /// Returns whether `--quick` makes it.
    pub const fn is_quick(&self) -> bool {
        self.cost.quick.is_some()
    }

    /// Returns whether `reproduce` makes it without `--all`.
    pub fn is_default(&self) -> bool {
        self.chapter == Chapter::Sources
    }

    /// Seconds that it takes about.
    pub fn seconds(&self, effort: Effort) -> f64 {
        match effort {
            Effort::Quick => self.cost.quick.unwrap_or(self.cost.full),
            Effort::Full => self.cost.full,
            Effort::All => self.cost.all.unwrap_or(self.cost.full),
        }
    }

    /// MiB of memory that it takes in full, at most.
    pub const fn memory(&self) -> u64 {
        self.cost.memory
    }

    /// Makes it.
    ///
    /// # Errors
    /// Those of its study.
    pub fn make(&self, effort: Effort, progress: Progress<'_>) -> Result<Made, console::Failure> {
        let mut made = (self.make)(effort, progress)?;
        made.section.chapter = self.chapter;
        if effort == Effort::All && self.cost.all.is_some() {
            made.section.again = format!("stripmine reproduce --all --only {}", self.name);
        }
        Ok(made)
    }
}
