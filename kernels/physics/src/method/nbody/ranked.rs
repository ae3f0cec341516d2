//! All pairs by several ranks, each those of some bands of rows.
//!
//! Every rank has all bodies; the first one tells where they are, and adds up what the bands have met, in their order: the bits are those of one rank. What goes from
//! rank to rank grows with the bodies, what is done with it with their square.

use super::bodies::{Bodies, Columns};
use super::scene::Scene;
use super::sums::{Stop, Sums, never};
use super::swept::Swept;
use crate::method::{DISMISSED, Failure, FailureKind};
use crate::ranks::{self, Crew, Gone, Parcel, Ranks, Reader, local};
use std::ops::Range;
use std::sync::{Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use stripmine_kernels::backend::Precision;
use stripmine_kernels::isa::ProgramError;
use stripmine_kernels::sweep::all_pairs::Arithmetic;

/// More ranks than bands.
const TOO_MANY: FailureKind = FailureKind::new("too-many-ranks");

/// The sums of the first rank, by as many ranks as there are.
///
/// # Errors
/// [`Failure`] if there are more ranks than bands; where this is a process that is not the first rank, that it is dismissed.
pub(super) fn summed<P: Precision>(
    scene: &Scene,
    bodies: &Bodies,
    arithmetic: Arithmetic,
) -> Result<Box<dyn Sums>, Failure> {
    let set = scene.instructions();
    let swept = || Swept::<P>::new(scene.softening, bodies, arithmetic, set);
    let crew = ranks::crew();
    let (own, count) = (swept(), crew.count());
    if count == 1 {
        return Ok(Box::new(own));
    }
    let bands = own.bands();
    if count > bands {
        let what = format!("{count} ranks are more than the {bands} bands of rows that all pairs have");
        return Err(Failure::new(TOO_MANY, what, format!("take at most {bands} ranks, or more bodies")));
    }
    let (ranks, threads): (Box<dyn Ranks>, Vec<JoinHandle<()>>) = match crew {
        Crew::Processes(join) => {
            let ranks = join();
            if ranks.rank() > 0 {
                serve(ranks.as_ref(), own, false);
                return Err(Failure::new(DISMISSED, "this rank is dismissed", ""));
            }
            (ranks, vec![])
        }
        Crew::One | Crew::Threads(_) => {
            let per_rank = rayon::current_num_threads();
            let mut rest = local::ranks(count, per_rank);
            let first: Box<dyn Ranks> = Box::new(rest.remove(0));
            let begin = |ranks: local::Local| {
                let own = swept();
                let pool = rayon::ThreadPoolBuilder::new().num_threads(per_rank).build();
                let pool = pool.map_err(|error| error.to_string())?;
                let served = move || serve(&ranks, own, true);
                let work = move || pool.install(served);
                thread::Builder::new().spawn(work).map_err(|error| error.to_string())
            };
            let threads: Result<Vec<_>, String> = rest.into_iter().map(begin).collect();
            let threads = threads.map_err(|error| {
                let what = format!("no thread can be had for a rank: {error}");
                Failure::new(TOO_MANY, what, "take fewer ranks or --threads")
            });
            (first, threads?)
        }
    };
    Ok(Box::new(RankedSums { ranks: Mutex::new(Some(ranks)), own, threads }))
}

/// The bands of a rank.
fn bands_of(rank: usize, ranks: usize, bands: usize) -> Range<usize> {
    rank * bands / ranks..(rank + 1) * bands / ranks
}

/// The sums of the first rank.
struct RankedSums<P> {
    /// None once one of them has ended.
    ranks: Mutex<Option<Box<dyn Ranks>>>,
    own: Swept<P>,
    threads: Vec<JoinHandle<()>>,
}

/// What the first rank says: that no simulation follows ([`ranks::dismiss`]), that sums are wanted, that this simulation has ended.
const DISMISS: usize = 0;
const SUM: usize = 1;
const END: usize = 2;

/// Does as the first rank says: a thread until this simulation ends, a process until no other follows.
fn serve<P: Precision>(ranks: &dyn Ranks, mut own: Swept<P>, is_thread: bool) {
    while let Ok(parcel) = ranks.tell(None) {
        let mut reader = parcel.read();
        match reader.count() {
            SUM => {}
            DISMISS => return,
            _ if is_thread => return,
            _ => continue,
        }
        let (observed, has_rates) = (reader.count() > 0, reader.count() > 0);
        let position = take(&mut reader);
        let velocity = has_rates.then(|| take(&mut reader));
        let bands = bands_of(ranks.rank(), ranks.count(), own.bands());
        let met = own.meet((&position, velocity.as_ref()), bands.clone(), observed, &never);
        let mut parcel = Parcel::new();
        // The first rank has the same processor and the same law: what fails here fails there.
        if met.is_ok() {
            bands.for_each(|band| parcel.numbers(own.band(band, has_rates)));
        }
        if ranks.gather(parcel).is_err() {
            return;
        }
    }
}

fn put(columns: &Columns, parcel: &mut Parcel) {
    for column in columns {
        parcel.push(column.len());
        parcel.numbers(column.iter().copied());
    }
}

fn take(reader: &mut Reader<'_>) -> Columns {
    [(); 3].map(|()| (0..reader.count()).map(|_| reader.number()).collect())
}

impl<P: Precision> RankedSums<P> {
    /// What the other ranks have met is put beside what this one meets.
    fn met(
        &mut self,
        (position, velocity): (&Columns, Option<&Columns>),
        observed: bool,
        stop: Stop<'_>,
    ) -> Result<Result<(), ProgramError>, Gone> {
        let ranks = self.ranks.get_mut().unwrap_or_else(PoisonError::into_inner);
        let Some(ranks) = ranks else { return Err(Gone(0)) };
        let mut parcel = Parcel::new();
        [SUM, usize::from(observed), usize::from(velocity.is_some())]
            .into_iter()
            .for_each(|word| parcel.push(word));
        put(position, &mut parcel);
        velocity.into_iter().for_each(|velocity| put(velocity, &mut parcel));
        ranks.tell(Some(parcel))?;
        let (count, bands) = (ranks.count(), self.own.bands());
        let met = self.own.meet((position, velocity), bands_of(0, count, bands), observed, stop);
        for (rank, parcel) in ranks.gather(Parcel::new())?.iter().enumerate().skip(1) {
            let mut reader = parcel.read();
            if reader.is_empty() {
                return Err(Gone(rank));
            }
            for band in bands_of(rank, count, bands) {
                self.own.put_band(band, velocity.is_some(), || reader.number());
            }
        }
        Ok(met)
    }
}

impl<P: Precision> Sums for RankedSums<P> {
    fn sum(
        &mut self,
        position: &Columns,
        velocity: Option<&Columns>,
        observed: bool,
        stop: Stop<'_>,
    ) -> Result<f64, ProgramError> {
        match self.met((position, velocity), observed, stop) {
            Ok(met) => {
                met?;
                self.own.finish(velocity.is_some())
            }
            // Without the others it goes on alone, to the same bits.
            Err(_) => {
                self.ranks = Mutex::new(None);
                self.own.sum(position, velocity, observed, stop)
            }
        }
    }

    fn over(&self, per_mass: &[f64], into: [Option<&mut Columns>; 2]) {
        self.own.over(per_mass, into);
    }
}

impl<P> Drop for RankedSums<P> {
    fn drop(&mut self) {
        if let Some(ranks) = self.ranks.get_mut().unwrap_or_else(PoisonError::into_inner).take() {
            let mut end = Parcel::new();
            end.push(END);
            // Who has ended already needs not be told.
            let _ = ranks.tell(Some(end));
        }
        self.threads.drain(..).for_each(|thread| _ = thread.join());
    }
}
