//! What can be reproduced: a table or figure of a source, or of our own, by its name.

use super::{Lab, Made, Size};
use crate::console;
use crate::pages::{Cost, Page};
use crate::report::Chapter;

/// Where the share of a piece of work that is done is heard.
pub type Progress<'p> = &'p (dyn Fn(f64) + Sync);

/// What makes an item.
type Make = fn(&Lab<'_>, Size) -> Result<Made, console::Failure>;

/// An item of the report.
#[derive(Debug)]
pub struct Item {
    /// Name on the command line, and of its template.
    pub name: &'static str,
    made: Option<(Chapter, &'static str, Cost)>,
    make: Make,
}

/// MiB that most items stay below.
const USUAL_MEMORY: u64 = 256;

impl Item {
    /// An item whose template says title, chapter and cost.
    pub const fn of(name: &'static str, make: Make) -> Item {
        Item { name, made: None, make }
    }

    /// An item that is made in full only, in about so many seconds.
    pub const fn full(
        name: &'static str,
        chapter: Chapter,
        seconds: f64,
        make: Make,
        doc: &'static str,
    ) -> Item {
        let cost = Cost { quick: None, full: seconds, all: None, memory: USUAL_MEMORY };
        Item { name, made: Some((chapter, doc, cost)), make }
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
        Item { name, made: Some((chapter, doc, cost)), make }
    }

    /// The item with more of it by `--all`, in about so many seconds.
    pub const fn with_more(mut self, seconds: f64) -> Item {
        if let Some((_, _, cost)) = &mut self.made {
            cost.all = Some(seconds);
        }
        self
    }

    /// The item with the memory that it takes in full, where this is more than usual.
    pub const fn with_memory(mut self, mebibytes: u64) -> Item {
        if let Some((_, _, cost)) = &mut self.made {
            cost.memory = mebibytes;
        }
        self
    }

    /// Chapter of the report, and title.
    pub fn heading(&self) -> (Chapter, String) {
        let page = || Page::of(self.name).ok().flatten();
        match self.made {
            Some((chapter, doc, _)) => (chapter, doc.to_owned()),
            None => {
                page().map_or((Chapter::Beyond, String::new()), |it| (it.chapter(), it.title().to_owned()))
            }
        }
    }

    /// Chapter of the report.
    pub fn chapter(&self) -> Chapter {
        self.heading().0
    }

    /// Stated cost.
    fn cost(&self) -> Cost {
        let none = Cost { quick: None, full: 0.0, all: None, memory: USUAL_MEMORY };
        let page = || Page::of(self.name).ok().flatten().map_or(none, |it| it.cost());
        self.made.map_or_else(page, |(_, _, cost)| cost)
    }

    /// Returns whether `--quick` makes it.
    pub fn is_quick(&self) -> bool {
        self.cost().quick.is_some()
    }

    /// Returns whether `reproduce` makes it without `--all`.
    pub fn is_default(&self) -> bool {
        self.chapter() == Chapter::Sources
    }

    /// Seconds that it takes about.
    pub fn seconds(&self, size: Size) -> f64 {
        let cost = self.cost();
        match size {
            Size::Quick => cost.quick.unwrap_or(cost.full),
            Size::Full => cost.full,
            Size::All => cost.all.unwrap_or(cost.full),
        }
    }

    /// MiB of memory that it takes in full, at most.
    pub fn memory(&self) -> u64 {
        self.cost().memory
    }

    /// Makes it.
    ///
    /// # Errors
    /// Those of its study.
    pub fn make(&self, lab: &Lab<'_>, size: Size) -> Result<Made, console::Failure> {
        let mut made = (self.make)(lab, size)?;
        if let Some(section) = &mut made.section {
            section.chapter = self.chapter();
            if size == Size::All && self.cost().all.is_some() {
                section.again = format!("stripmine reproduce --all --only {}", self.name);
            }
        }
        Ok(made)
    }
}
