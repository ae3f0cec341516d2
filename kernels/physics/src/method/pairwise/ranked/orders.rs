//! What the first rank tells all to do, and how a rank does it.

use super::wire::take_columns;
use super::worker::{What, Worker};
use crate::method::pairwise::search::Search;
use crate::method::pairwise::{Dynamics, Losing};
use crate::ranks::{Gone, Parcel, Reader};
use stripmine_kernels::backend::Precision;
use stripmine_kernels::law::Asked;

/// What the first rank tells all to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Do {
    Advance,
    Forces(Asked),
    SkipForces,
    Look(What),
    Contacts,
    Listed,
    Unfit,
    Settle,
    Restore,
    End,
}

impl Do {
    pub(super) fn put(self, parcel: &mut Parcel) {
        let words = match self {
            Do::Advance => [0, 0],
            Do::Forces(asked) => [1, usize::from(asked.dissipation) + 2 * usize::from(asked.energy)],
            Do::SkipForces => [2, 0],
            Do::Look(What::Standing) => [3, 0],
            Do::Look(What::Forces) => [3, 1],
            Do::Look(What::Velocities) => [3, 2],
            Do::Look(What::Column(place)) => [3, 3 + place],
            Do::Contacts => [4, 0],
            Do::Listed => [5, 0],
            Do::Unfit => [6, 0],
            Do::Settle => [7, 0],
            Do::Restore => [8, 0],
            Do::End => [9, 0],
        };
        words.into_iter().for_each(|word| parcel.push(word));
        parcel.numbers([if let Do::Forces(Asked { watched: Some(depth), .. }) = self {
            depth
        } else {
            f64::NAN
        }]);
    }

    fn take(reader: &mut Reader<'_>) -> Do {
        let [code, more] = [(); 2].map(|()| reader.count());
        let depth = reader.number();
        match code {
            0 => Do::Advance,
            1 => Do::Forces(Asked {
                watched: (!depth.is_nan()).then_some(depth),
                dissipation: more & 1 == 1,
                energy: more & 2 == 2,
            }),
            2 => Do::SkipForces,
            3 => Do::Look(match more {
                0 => What::Standing,
                1 => What::Forces,
                2 => What::Velocities,
                place => What::Column(place - 3),
            }),
            4 => Do::Contacts,
            5 => Do::Listed,
            6 => Do::Unfit,
            7 => Do::Settle,
            8 => Do::Restore,
            _ => Do::End,
        }
    }
}

impl<S: Precision, P: Precision, Q: Search<S, P>, D: Dynamics> Worker<S, P, Q, D> {
    /// Does what the first rank says until it says that this is the end, or has ended itself.
    pub(super) fn serve(mut self) {
        while let Ok(parcel) = self.ranks.tell(None) {
            let mut reader = parcel.read();
            let Ok(Some(own)) = self.follow(&mut reader) else { return };
            if self.ranks.gather(own).is_err() {
                return;
            }
        }
    }

    /// Does what a parcel says; what is to be gathered of it, nothing at the end.
    pub(super) fn follow(&mut self, reader: &mut Reader<'_>) -> Result<Option<Parcel>, Gone> {
        self.hear_of_crossings(reader);
        let is_to_migrate = reader.count() > 0;
        let what = Do::take(reader);
        let moved_over = if is_to_migrate { self.migrate()? } else { Ok(()) };
        let said = |result: Result<(), String>| {
            let mut parcel = Parcel::new();
            parcel.text(&result.err().unwrap_or_default());
            parcel
        };
        Ok(Some(match what {
            Do::Advance => self.advance()?,
            Do::Forces(asked) => {
                let mut parcel = said(moved_over);
                parcel.0.extend(self.compute_forces(asked)?.0);
                parcel
            }
            Do::SkipForces => {
                self.engine.skip_forces();
                said(moved_over)
            }
            Do::Look(what) => self.each_own(what),
            Do::Contacts => self.contacts()?,
            Do::Listed => self.listed(),
            Do::Unfit => self.unfit(),
            Do::Settle => self.settle(),
            Do::Restore => {
                let steps = reader.count() as u64;
                let columns = take_columns(reader);
                said(self.restore(steps, &columns))
            }
            Do::End => return Ok(None),
        }))
    }
}
