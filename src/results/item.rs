//! Items of the report: tables and figures of the papers or of our own, by name.

use super::{FinishedItem, StudyEnvironment, StudySize};
use crate::console;
use crate::pages::{ItemCost, Page};
use crate::report::Chapter;

/// Callback that receives the finished fraction of a piece of work.
pub(crate) type Progress<'p> = &'p (dyn Fn(f64) + Sync);

/// Function that makes an item.
type ItemMaker = fn(&StudyEnvironment<'_>, StudySize) -> Result<FinishedItem, console::CommandFailure>;

/// Item of the report.
#[derive(Debug)]
pub(crate) struct Item {
    /// Name on the command line, and of its template.
    pub name: &'static str,
    make: ItemMaker,
    /// Programs that it needs and this machine lacks, in words.
    missing: fn() -> Option<String>,
}

/// Memory of an item without a page (MiB).
const USUAL_MEMORY: u64 = 256;

impl Item {
    /// Item whose template has title, chapter and cost.
    pub(crate) const fn of(name: &'static str, make: ItemMaker) -> Item {
        Item { name, make, missing: || None }
    }

    /// Item that needs programs of others; `missing` says which of them this machine lacks.
    pub(crate) const fn with_tools(
        name: &'static str,
        make: ItemMaker,
        missing: fn() -> Option<String>,
    ) -> Item {
        Item { name, make, missing }
    }

    /// Programs that the item needs and this machine lacks, in words.
    pub(crate) fn missing_tools(&self) -> Option<String> {
        (self.missing)()
    }

    fn page(&self) -> Option<Page> {
        Page::of(self.name).ok().flatten()
    }

    pub(crate) fn title(&self) -> String {
        self.page().map_or_else(String::new, |page| page.title().to_owned())
    }

    pub(crate) fn chapter(&self) -> Chapter {
        self.page().map_or(Chapter::Beyond, |page| page.chapter())
    }

    /// Cost stated in the template.
    fn cost(&self) -> ItemCost {
        let none = ItemCost { default: true, quick: None, full: 0.0, all: None, memory: USUAL_MEMORY };
        self.page().map_or(none, |page| page.cost())
    }

    /// Returns true if `reproduce --quick` makes it.
    pub(crate) fn is_quick(&self) -> bool {
        self.cost().quick.is_some()
    }

    /// Returns true if `reproduce` makes it without `--all`.
    pub(crate) fn is_default(&self) -> bool {
        self.chapter() == Chapter::Sources && self.cost().default
    }

    /// Expected duration (s).
    pub(crate) fn seconds(&self, size: StudySize) -> f64 {
        let cost = self.cost();
        match size {
            StudySize::Quick => cost.quick.unwrap_or(cost.full),
            StudySize::Full => cost.full,
            StudySize::All => cost.all.unwrap_or(cost.full),
        }
    }

    /// Most memory of the full size (MiB).
    #[cfg(test)]
    pub(crate) fn memory(&self) -> u64 {
        self.cost().memory
    }

    /// Makes the item.
    ///
    /// # Errors
    /// Errors of its study.
    pub(crate) fn make(
        &self,
        lab: &StudyEnvironment<'_>,
        size: StudySize,
    ) -> Result<FinishedItem, console::CommandFailure> {
        (self.make)(lab, size)
    }
}
