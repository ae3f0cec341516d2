//! Operation counts of an engine, in the units of ISO99's cost formula (section 4).

/// Counts since an engine started or resumed. Resuming repeats some searches, so the counts belong to a session, not to a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Operations {
    /// Predicted collision times of pairs: k_PP.
    pub(crate) predictions: u64,
    /// Searches for the next event of a disc among all its possible partners.
    pub searches: u64,
    /// Searches due to a partner that had another event first.
    pub(crate) repairs: u64,
    /// Insertions and moves in the event queue: k_CBT.
    pub(crate) queue_moves: u64,
    /// Assignments of a disc to a cell: k_EEPGM.
    pub(crate) cell_updates: u64,
}

impl Operations {
    /// Returns each count with its name.
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
