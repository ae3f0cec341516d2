//! What an engine does for its events, counted in the units of the source's cost formula (ISO99, section 4).

/// Counts since an engine began or went on: one that goes on looks for some events once more, so they are of a session, not of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Operations {
    /// Predictions of when a pair of discs meets: k_PP.
    pub(crate) predictions: u64,
    /// Searches for the next event of a disc among all that it may meet.
    pub searches: u64,
    /// Searches of these for a disc whose partner met another one before.
    pub(crate) repairs: u64,
    /// Events that were put into the queue or moved in it: k_CBT.
    pub(crate) queue_moves: u64,
    /// Discs that were put into a cell: k_EEPGM.
    pub(crate) cell_updates: u64,
}

impl Operations {
    /// Every count with its name.
    pub(crate) fn named(self) -> Vec<(&'static str, u64)> {
        let Operations { predictions, searches, repairs, queue_moves, cell_updates } = self;
        vec![
            ("predictions", predictions),
            ("searches", searches),
            ("repairs", repairs),
            ("queue_moves", queue_moves),
            ("cell_updates", cell_updates),
        ]
    }
}
