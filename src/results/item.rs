//! What can be reproduced: a table or figure of a source, or of our own, by its name.

use super::{Lab, Made, Size};
use crate::console;
use crate::pages::{Cost, Page};
use crate::report::Chapter;

/// Where the share of a piece of work that is done is heard.
pub(crate) type Progress<'p> = &'p (dyn Fn(f64) + Sync);

/// What makes an item.
type Make = fn(&Lab<'_>, Size) -> Result<Made, console::Failure>;

/// An item of the report.
#[derive(Debug)]
pub(crate) struct Item {
    /// Name on the command line, and of its template.
    pub name: &'static str,
    make: Make,
}

/// MiB of an item without a page.
const USUAL_MEMORY: u64 = 256;

impl Item {
    /// An item whose template says title, chapter and cost.
    pub(crate) const fn of(name: &'static str, make: Make) -> Item {
        Item { name, make }
    }

    fn page(&self) -> Option<Page> {
        Page::of(self.name).ok().flatten()
    }

    pub(crate) fn title(&self) -> String {
        self.page().map_or_else(String::new, |page| page.title().to_owned())
    }

    /// Chapter of the report.
    pub(crate) fn chapter(&self) -> Chapter {
        self.page().map_or(Chapter::Beyond, |page| page.chapter())
    }

    /// Stated cost.
    fn cost(&self) -> Cost {
        let none = Cost { quick: None, full: 0.0, all: None, memory: USUAL_MEMORY };
        self.page().map_or(none, |page| page.cost())
    }

    /// Returns whether `--quick` makes it.
    pub(crate) fn is_quick(&self) -> bool {
        self.cost().quick.is_some()
    }

    /// Returns whether `reproduce` makes it without `--all`.
    pub(crate) fn is_default(&self) -> bool {
        self.chapter() == Chapter::Sources
    }

    /// Seconds that it takes about.
    pub(crate) fn seconds(&self, size: Size) -> f64 {
        let cost = self.cost();
        match size {
            Size::Quick => cost.quick.unwrap_or(cost.full),
            Size::Full => cost.full,
            Size::All => cost.all.unwrap_or(cost.full),
        }
    }

    /// MiB of memory that it takes in full, at most.
    #[cfg(test)]
    pub(crate) fn memory(&self) -> u64 {
        self.cost().memory
    }

    /// Makes it.
    ///
    /// # Errors
    /// Those of its study.
    pub(crate) fn make(&self, lab: &Lab<'_>, size: Size) -> Result<Made, console::Failure> {
        (self.make)(lab, size)
    }
}
