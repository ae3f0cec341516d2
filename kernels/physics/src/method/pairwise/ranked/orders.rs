//! Execution of the first rank's orders on each rank.

use super::wire::{Do, ForcesReport, NamedColumns, RankOrder, RankSample};
use super::worker::{RankPart, RankWorker};
use crate::method::pairwise::search::PairSearch;
use crate::method::pairwise::{NameableDiscs, PrescribedMotion, SteppingDiscs};
use crate::ranks::{Parcel, RankError, Ranks};
use stripmine_kernels::backend::Precision;

/// Executes orders until none follows.
///
/// # Errors
/// [`RankError`]: a rank was lost, which is reported to the first rank, or the first rank has ended.
pub(super) fn execute_orders(mut part: Box<dyn RankPart>) -> Result<(), RankError> {
    loop {
        let order = part.ranks().broadcast_message::<Option<RankOrder>>(None);
        match order.and_then(|order| order.map(|order| part.execute_order(order)).transpose()) {
            Ok(None) => return Ok(()),
            Ok(Some(own)) => part.ranks().gather(own)?,
            Err(lost) => {
                #[expect(
                    clippy::let_underscore_must_use,
                    reason = "this rank ends with its loss, received or not"
                )]
                let _ = part.ranks().gather(Parcel::lost(lost));
                return Err(lost);
            }
        };
    }
}

impl<S: Precision, P: Precision, Q: PairSearch<S, P>> RankPart for RankWorker<S, P, Q> {
    fn ranks(&self) -> &dyn Ranks {
        self.ranks.as_ref()
    }

    fn engine(&self) -> &dyn SteppingDiscs {
        &self.engine
    }

    fn engine_mut(&mut self) -> &mut dyn SteppingDiscs {
        &mut self.engine
    }

    fn prescribed(&self) -> Option<PrescribedMotion> {
        self.engine.prescribed()
    }

    fn columns(&self) -> [NamedColumns; 2] {
        [self.engine.columns_of(&[]), self.engine.columns_of_all().collect()]
    }

    fn execute_order(&mut self, order: RankOrder) -> Result<Parcel, RankError> {
        let RankOrder { crossed, is_to_migrate, what } = order;
        self.add_reported_crossings(&crossed);
        let distributed = if is_to_migrate { self.migrate()? } else { Ok(()) };
        Ok(match what {
            Do::Advance => Parcel::of(&self.advance()?),
            Do::Forces(asked) => Parcel::of(&ForcesReport { distributed, ..self.compute_forces(asked) }),
            Do::SkipForces => {
                self.engine.awaits_forces = false;
                Parcel::of(&distributed)
            }
            Do::Look(what) => self.take_sample(what)?,
            Do::Settle => Parcel::of(&self.settle()),
            Do::Restore { steps, columns } => Parcel::of(&self.restore(steps, &columns)),
        })
    }

    fn take_sample(&self, what: RankSample) -> Result<Parcel, RankError> {
        Ok(match what {
            RankSample::Standing => self.standing(),
            RankSample::Column(place) => self.column(place),
            RankSample::Forces => self.each_own(|disc| self.engine.force_on(disc)),
            RankSample::Velocities => self.each_own(|disc| self.engine.velocity(disc)),
            RankSample::Contacts => Parcel::of(&self.contacts()?),
            RankSample::Listed => Parcel::of(&self.listed()),
            RankSample::Unfit => Parcel::of(&self.unfit()),
        })
    }
}
