//! Periods that discs cross, counted at each event: displacements across periodic sides.

use super::event::Arena;
use crate::io::checkpoint::Column;
use crate::method::pairwise::Crossings;
use stripmine_kernels::flight::Disc;

/// How many periods each disc has crossed, and each disc as its last event left it.
pub(super) struct Followed {
    crossings: Crossings,
    before: Vec<Disc>,
}

impl Followed {
    /// None crossed yet, by discs in the order of their numbers.
    pub(super) fn new(arena: &Arena, discs: Vec<Disc>) -> Followed {
        Followed { crossings: Crossings::new(arena.domain.periodic(), discs.len()), before: discs }
    }

    /// Counts what a disc has crossed up to its event, after which it is `now`.
    pub(super) fn see(&mut self, arena: &Arena, number: u32, now: &Disc) {
        let before = &mut self.before[number as usize];
        let beyond = arena.domain.periods(before.at(&arena.space, now.time));
        if beyond != [0.0; 2] {
            self.crossings.add(number as usize, beyond);
        }
        *before = *now;
    }

    /// How many periods a disc has crossed at a time after its last event, as of its image inside the box.
    pub(super) fn image(&self, arena: &Arena, number: usize, time: f64) -> [i32; 2] {
        self.crossings.image(&arena.domain, number, self.before[number].at(&arena.space, time))
    }

    /// Whether every periodic side is followed, and there is one.
    pub(super) fn follows(&self, arena: &Arena) -> bool {
        self.crossings.follows(&arena.domain)
    }

    /// The counts by name, for a checkpoint.
    pub(super) fn columns(&self) -> impl Iterator<Item = (String, Column)> {
        self.crossings.columns()
    }

    /// Takes up discs and the columns of a checkpoint; those of a run in which nothing was followed have no counts, which begin at 0.
    ///
    /// # Errors
    /// A sentence, if a column is not one of counts of these discs.
    pub(super) fn take_up(&mut self, discs: &[Disc], columns: &[(String, Column)]) -> Result<(), String> {
        let mut columns: Vec<(String, Column)> = Crossings::among(columns).cloned().collect();
        Crossings::begin_in(&mut columns, discs.len());
        self.crossings.take_up(&columns)?;
        self.before.copy_from_slice(discs);
        Ok(())
    }
}
