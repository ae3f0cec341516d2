//! Force sum on several ranks, each with some bands of rows.
//!
//! Every rank has all bodies. The first rank broadcasts their positions and adds up the sums of the bands in order, so the bits are those of one
//! rank. Communication grows with the number of bodies, computation with its square.

use super::bodies::{PointMasses, StateColumns};
use super::scene::NbodyScene;
use super::sums::{ForceSums, StopCallback, never_stop};
use super::swept::PairSweep;
use crate::method::{Clock, DISMISSED, FailureKind, PhysicsFailure, rank_loss_failure};
use crate::ranks::{self, Parcel, RankBackend, RankError, Ranks, local, numbers};
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::sync::{Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use stripmine_kernels::backend::Precision;
use stripmine_kernels::isa::ProgramError;
use stripmine_kernels::sweep::all_pairs::Arithmetic;

/// Failure of more ranks than bands.
const TOO_MANY: FailureKind = FailureKind::new("too-many-ranks");

/// Creates the sums of the first rank, which use all ranks.
///
/// # Errors
/// [`PhysicsFailure`] if there are more ranks than bands. In a process that is not the first rank, the failure reports its dismissal.
pub(super) fn ranked_sums<P: Precision>(
    scene: &NbodyScene,
    bodies: &PointMasses,
    arithmetic: Arithmetic,
) -> Result<Box<dyn ForceSums>, PhysicsFailure> {
    let set = scene.instructions();
    let swept = || PairSweep::<P>::new(scene.softening, bodies, arithmetic, set);
    let crew = ranks::current_backend();
    let (own, count) = (swept(), crew.count());
    if count == 1 {
        return Ok(Box::new(own));
    }
    let bands = own.bands();
    if count > bands {
        let what = format!("{count} ranks are more than the {bands} bands of rows of the all-pairs sum");
        return Err(PhysicsFailure::new(
            TOO_MANY,
            what,
            format!("use at most {bands} ranks, or more bodies"),
        ));
    }
    let (ranks, threads): (Box<dyn Ranks>, Vec<JoinHandle<()>>) = match crew {
        RankBackend::Processes(join) => {
            let ranks = join();
            if ranks.rank() > 0 {
                return Err(match serve(ranks.as_ref(), own, false) {
                    Ok(()) => PhysicsFailure::new(DISMISSED, "this rank is dismissed", ""),
                    Err(lost) => rank_loss_failure(lost, Clock::default()),
                });
            }
            (ranks, vec![])
        }
        RankBackend::One | RankBackend::Threads(_) => {
            let per_rank = rayon::current_num_threads();
            let mut rest = local::ranks(count, per_rank);
            let first: Box<dyn Ranks> = Box::new(rest.remove(0));
            let begin = |ranks: local::ThreadRank| {
                let own = swept();
                let pool = rayon::ThreadPoolBuilder::new().num_threads(per_rank).build();
                let pool = pool.map_err(|error| error.to_string())?;
                // The first rank detects a loss itself.
                let served = move || _ = serve(&ranks, own, true);
                let work = move || pool.install(served);
                thread::Builder::new().spawn(work).map_err(|error| error.to_string())
            };
            let threads: Result<Vec<_>, String> = rest.into_iter().map(begin).collect();
            let threads = threads.map_err(|error| {
                let what = format!("cannot start a thread for a rank: {error}");
                PhysicsFailure::new(TOO_MANY, what, "use fewer ranks or --threads")
            });
            (first, threads?)
        }
    };
    Ok(Box::new(RankedSums { ranks: Mutex::new(Ok(ranks)), own, threads }))
}

fn bands_of(rank: usize, ranks: usize, bands: usize) -> Range<usize> {
    rank * bands / ranks..(rank + 1) * bands / ranks
}

/// Sums of the first rank.
struct RankedSums<P> {
    /// Ranks, or the rank that was lost first.
    ranks: Mutex<Result<Box<dyn Ranks>, RankError>>,
    own: PairSweep<P>,
    threads: Vec<JoinHandle<()>>,
}

/// Command of the first rank to the others, sent in an option: none if no simulation follows ([`ranks::dismiss`]).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum RankCommand {
    /// Calculate sums.
    Sum { observed: bool, position: Parcel, velocity: Option<Parcel> },
    /// End of this simulation.
    End,
}

/// Serves the first rank: a thread until this simulation ends, a process until no other follows.
fn serve<P: Precision>(ranks: &dyn Ranks, mut own: PairSweep<P>, is_thread: bool) -> Result<(), RankError> {
    loop {
        let answer = match ranks.broadcast_message(None) {
            Ok(Some(RankCommand::Sum { observed, position, velocity })) => {
                band_sums(ranks, &mut own, observed, (&position, velocity.as_ref()))
            }
            Ok(Some(RankCommand::End)) if !is_thread => continue,
            Ok(Some(RankCommand::End) | None) => return Ok(()),
            Err(lost) => Err(lost),
        };
        ranks.gather(answer.as_ref().map_or_else(|lost| Parcel::lost(*lost), Parcel::of))?;
        answer?;
    }
}

/// Sums of each band of a rank.
fn band_sums<P: Precision>(
    ranks: &dyn Ranks,
    own: &mut PairSweep<P>,
    observed: bool,
    (position, velocity): (&Parcel, Option<&Parcel>),
) -> Result<Vec<Parcel>, RankError> {
    let entries = own.entries();
    let columns = |parcel: &Parcel| -> Result<StateColumns, RankError> {
        let mut numbers = numbers(&parcel.0, 0, 3 * entries)?;
        Ok([(); 3].map(|()| numbers.by_ref().take(entries).collect()))
    };
    let (position, velocity) = (columns(position)?, velocity.map(columns).transpose()?);
    let bands = bands_of(ranks.rank(), ranks.count(), own.bands());
    let met = own.visit_bands((&position, velocity.as_ref()), bands.clone(), observed, &never_stop);
    // The first rank has the same processor and law, so it fails for the same reason and reports it.
    met.map_err(|_| RankError::Ended(ranks.rank()))?;
    Ok(bands.map(|band| Parcel::of_numbers(own.band(band, velocity.is_some()))).collect())
}

impl<P: Precision> RankedSums<P> {
    /// Visits the pairs of all ranks and collects the sums of the other ranks.
    fn gather_band_sums(
        &mut self,
        (position, velocity): (&StateColumns, Option<&StateColumns>),
        observed: bool,
        stop: StopCallback<'_>,
    ) -> Result<Result<(), ProgramError>, RankError> {
        let ranks = self.ranks.get_mut().unwrap_or_else(PoisonError::into_inner);
        let ranks = ranks.as_ref().map_err(|lost| *lost)?;
        let sent = |columns: &StateColumns| Parcel::of_numbers(columns.iter().flatten().copied());
        let (from, rates) = (sent(position), velocity.map(sent));
        ranks.broadcast_message(Some(Some(RankCommand::Sum {
            observed,
            position: from,
            velocity: rates,
        })))?;
        let (count, bands, has_rates) = (ranks.count(), self.own.bands(), velocity.is_some());
        let met = self.own.visit_bands((position, velocity), bands_of(0, count, bands), observed, stop);
        let all = ranks.gather(Parcel::default())?;
        if met.is_err() {
            return Ok(met);
        }
        for (rank, parcel) in all.iter().enumerate().skip(1) {
            let of_bands: Vec<&[u8]> = parcel.open(rank)?;
            let bands = bands_of(rank, count, bands);
            if of_bands.len() != bands.len() {
                return Err(RankError::Unreadable(rank));
            }
            for (band, bytes) in bands.zip(of_bands) {
                self.own.store_band(band, has_rates, (rank, bytes))?;
            }
        }
        Ok(met)
    }
}

impl<P: Precision> ForceSums for RankedSums<P> {
    fn sum(
        &mut self,
        position: &StateColumns,
        velocity: Option<&StateColumns>,
        observed: bool,
        stop: StopCallback<'_>,
    ) -> Result<f64, ProgramError> {
        match self.gather_band_sums((position, velocity), observed, stop) {
            Ok(met) => {
                met?;
                self.own.finish(velocity.is_some())
            }
            // The current step is finished by the first rank alone, to the same bits; `lost` then ends the run.
            Err(lost) => {
                self.ranks = Mutex::new(Err(lost));
                self.own.sum(position, velocity, observed, stop)
            }
        }
    }

    fn over(&self, per_mass: &[f64], into: [Option<&mut StateColumns>; 2]) {
        self.own.over(per_mass, into);
    }

    fn lost(&self) -> Option<RankError> {
        self.ranks.lock().unwrap_or_else(PoisonError::into_inner).as_ref().err().copied()
    }
}

impl<P> Drop for RankedSums<P> {
    fn drop(&mut self) {
        if let Ok(ranks) = self.ranks.get_mut().unwrap_or_else(PoisonError::into_inner) {
            #[expect(clippy::let_underscore_must_use, reason = "a rank that has ended needs no message")]
            let _ = ranks.broadcast_message(Some(Some(RankCommand::End)));
        }
        self.threads.drain(..).for_each(|thread| _ = thread.join());
    }
}
