//! Crossings of periodic sides, counted at each event: displacements across periodic sides.

use super::event::Arena;
use crate::io::checkpoint::CheckpointColumn;
use crate::method::pairwise::Crossings;
use stripmine_kernels::flight::FlyingDisc;

/// Crossing counts, and each disc in the state after its last event.
pub(super) struct CrossingCounter {
    crossings: Crossings,
    before: Vec<FlyingDisc>,
}

impl CrossingCounter {
    /// Starts the counts at 0, for discs in the order of their numbers.
    pub(super) fn new(arena: &Arena, discs: Vec<FlyingDisc>) -> CrossingCounter {
        CrossingCounter { crossings: Crossings::new(arena.domain.periodic(), discs.len()), before: discs }
    }

    /// Counts the crossings of a disc up to its event, after which its state is `now`.
    pub(super) fn register_crossings(&mut self, arena: &Arena, number: u32, now: &FlyingDisc) {
        let before = &mut self.before[number as usize];
        let beyond = arena.domain.periods(before.at(&arena.space, now.time));
        if beyond != [0.0; 2] {
            self.crossings.add(number as usize, beyond);
        }
        *before = *now;
    }

    /// Replaces the states after the last events.
    pub(super) fn take_discs(&mut self, discs: &[FlyingDisc]) {
        self.before.copy_from_slice(discs);
    }

    /// Number of periods that a disc has crossed at a time after its last event, relative to its image inside the box.
    pub(super) fn image(&self, arena: &Arena, number: usize, time: f64) -> [i32; 2] {
        self.crossings.image(&arena.domain, number, self.before[number].at(&arena.space, time))
    }

    /// True if there is a periodic side and all are followed.
    pub(super) fn is_following_all_sides(&self, arena: &Arena) -> bool {
        self.crossings.follows(&arena.domain)
    }

    /// The counts by name, for a checkpoint.
    pub(super) fn columns(&self) -> impl Iterator<Item = (String, CheckpointColumn)> {
        self.crossings.columns()
    }

    /// Restores discs and the columns of a checkpoint. If the run did not follow crossings, the counts begin at 0.
    ///
    /// # Errors
    /// A message if a column does not hold the counts of these discs.
    pub(super) fn take_up(
        &mut self,
        discs: &[FlyingDisc],
        columns: &[(String, CheckpointColumn)],
    ) -> Result<(), String> {
        let mut columns: Vec<(String, CheckpointColumn)> = Crossings::among(columns).cloned().collect();
        Crossings::begin_in(&mut columns, discs.len());
        self.crossings.restore_counts(&columns)?;
        self.take_discs(discs);
        Ok(())
    }
}
