//! Orders of the first rank, as each rank carries them out.

use super::wire::{Do, ForcesReport, Order, What};
use super::worker::Worker;
use crate::method::pairwise::search::Search;
use crate::method::pairwise::{Dynamics, Named};
use crate::ranks::{Parcel, RankError};
use stripmine_kernels::backend::Precision;

impl<S: Precision, P: Precision, Q: Search<S, P>, D: Dynamics> Worker<S, P, Q, D> {
    /// Carries out orders until none follows.
    ///
    /// # Errors
    /// The rank that was lost, of which the first one is told; or that the first one has ended.
    pub(super) fn serve(mut self) -> Result<(), RankError> {
        loop {
            let order = self.ranks.tell_message::<Option<Order>>(None);
            match order.and_then(|order| order.map(|order| self.follow(order)).transpose()) {
                Ok(None) => return Ok(()),
                Ok(Some(own)) => self.ranks.gather(own)?,
                Err(lost) => {
                    #[expect(
                        clippy::let_underscore_must_use,
                        reason = "this rank ends with what it has lost, heard or not"
                    )]
                    let _ = self.ranks.gather(Parcel::lost(lost));
                    return Err(lost);
                }
            };
        }
    }

    /// Carries out an order; the answer of this rank, for the first one to open.
    pub(super) fn follow(&mut self, order: Order) -> Result<Parcel, RankError> {
        let Order { crossed, is_to_migrate, what } = order;
        self.hear_of_crossings(&crossed);
        let distributed = if is_to_migrate { self.migrate()? } else { Ok(()) };
        Ok(match what {
            Do::Advance => Parcel::of(&self.advance()?),
            Do::Forces(asked) => Parcel::of(&ForcesReport { distributed, ..self.compute_forces(asked) }),
            Do::SkipForces => {
                self.engine.awaits_forces = false;
                Parcel::of(&distributed)
            }
            Do::Look(what) => self.look(what)?,
            Do::Settle => Parcel::of(&self.settle()),
            Do::Restore { steps, columns } => Parcel::of(&self.restore(steps, &columns)),
        })
    }

    /// Answers a look, for the first rank to open.
    pub(super) fn look(&self, what: What) -> Result<Parcel, RankError> {
        Ok(match what {
            What::Standing => self.standing(),
            What::Column(place) => self.column(place),
            What::Forces => self.each_own(|disc| self.engine.force_on(disc)),
            What::Velocities => self.each_own(|disc| self.engine.velocity(disc)),
            What::Contacts => Parcel::of(&self.contacts()?),
            What::Listed => Parcel::of(&self.listed()),
            What::Unfit => Parcel::of(&self.unfit()),
        })
    }
}
