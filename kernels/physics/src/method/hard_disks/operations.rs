//! What an engine does for its events, counted in the units of the source's cost formula (ISO99, section 4).

use crate::method::Snapshot;

/// Counts since the start of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Operations {
    /// Predictions of when a pair of discs meets: k_PP.
    pub predictions: u64,
    /// Searches for the next event of a disc among all that it may meet.
    pub searches: u64,
    /// Searches of these for a disc whose partner met another one before.
    pub repairs: u64,
    /// Events that were put into the queue or moved in it: k_CBT.
    pub queue_moves: u64,
    /// Discs that were put into a cell: k_EEPGM.
    pub cell_updates: u64,
}

type Count = fn(&mut Operations) -> &mut u64;

/// All counts, by their names in summaries and checkpoints.
const COUNTS: [(&str, Count); 5] = [
    ("predictions", |it| &mut it.predictions),
    ("searches", |it| &mut it.searches),
    ("repairs", |it| &mut it.repairs),
    ("queue_moves", |it| &mut it.queue_moves),
    ("cell_updates", |it| &mut it.cell_updates),
];

impl Operations {
    /// Every count with its name.
    pub fn named(mut self) -> [(&'static str, u64); COUNTS.len()] {
        COUNTS.map(|(name, count)| (name, *count(&mut self)))
    }

    /// Adds every count to what a checkpoint keeps.
    pub fn keep(self, kept: &mut Snapshot) {
        self.named().into_iter().for_each(|(name, count)| kept.add_count(&key(name), count));
    }

    /// The counts that a checkpoint kept.
    ///
    /// # Errors
    /// A sentence, if one is missing.
    pub fn kept(kept: &Snapshot) -> Result<Operations, String> {
        let mut operations = Operations::default();
        for (name, count) in COUNTS {
            *count(&mut operations) = kept.count(&key(name))?;
        }
        Ok(operations)
    }
}

fn key(name: &str) -> String {
    format!("operations.{name}")
}
