//! What can be reproduced: a table or figure of a source, by its name.

use super::{Effort, Made};
use crate::console;

/// Where the share of a piece of work that is done is heard.
pub type Progress<'p> = &'p (dyn Fn(f64) + Sync);

/// A table or figure of the source, reproduced.
#[derive(Debug)]
pub struct Item {
    /// The name on the command line.
    pub name: &'static str,
    /// What it shows.
    pub doc: &'static str,
    /// Seconds that it takes about, quick and in full.
    pub seconds: [f64; 2],
    /// Whether it is made where only little time is given and it is not asked for by name.
    pub is_quick: bool,
    /// Makes it.
    pub make: fn(Effort, Progress<'_>) -> Result<Made, console::Failure>,
}

impl Item {
    /// Seconds that it takes about.
    pub fn seconds(&self, effort: Effort) -> f64 {
        self.seconds[usize::from(effort == Effort::Full)]
    }
}
