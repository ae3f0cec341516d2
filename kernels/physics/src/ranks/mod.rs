//! Several ranks that carry out one simulation: what they say to each other, whatever carries it.
//!
//! ```text
//! halo       to the ranks below and above, in a ring        what stands near them            every step
//! migrate    from each to each                              who moves over                   now and then
//! gather     from each to the first                         sums, in the order of ranks      every step
//! tell       from the first to all                          what is next, and when to stop   every step
//! ```
//!
//! No sum is left to whatever carries the messages: what is gathered is added in an order that depends on the scene alone. So a run has the same bits
//! on any number of ranks.
//!
//! Ranks are threads of this process ([`local`]), or processes that `mpiexec` has started (feature `mpi`): each has its own part of the particles, and
//! nothing but messages in common.

pub mod local;
#[cfg(feature = "mpi")]
pub mod mpi;
mod parcel;

pub use parcel::Parcel;
pub(crate) use parcel::numbers;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::cell::Cell;
use std::iter::once;

/// A rank from which nothing that was asked of it will come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, thiserror::Error)]
pub enum RankError {
    /// The rank has ended.
    #[error("rank {0} has ended")]
    Ended(usize),
    /// The rank has sent bytes that are not the message that was expected of it.
    #[error("rank {0} sent a message that cannot be read")]
    Unreadable(usize),
}

/// One of several ranks. What one sends to another arrives in the order in which it was sent.
pub trait Ranks: Send {
    /// Which one this is.
    fn rank(&self) -> usize;

    /// How many there are.
    fn count(&self) -> usize;

    /// The rank below and that above, in a ring.
    fn neighbours(&self) -> [usize; 2] {
        let (rank, count) = (self.rank(), self.count());
        [(rank + count - 1) % count, (rank + 1) % count]
    }

    /// Sends something to the rank below and to that above, does something else while these messages are under way, and gives what came from below and from above.
    /// The first rank is above the last one; of two ranks each is below and above the other.
    ///
    /// # Errors
    /// [`RankError`]
    fn halo(&self, to: [Parcel; 2], meanwhile: &mut dyn FnMut()) -> Result<[Parcel; 2], RankError>;

    /// Sends something to each rank, and gives what came from each.
    ///
    /// # Errors
    /// [`RankError`]
    fn migrate(&self, to: Vec<Parcel>) -> Result<Vec<Parcel>, RankError>;

    /// Sends something to the first rank, which is given what came from each; the others get nothing.
    ///
    /// # Errors
    /// [`RankError`]
    fn gather(&self, own: Parcel) -> Result<Vec<Parcel>, RankError>;

    /// Gives what the first rank says; the others say nothing.
    ///
    /// # Errors
    /// [`RankError`]
    fn tell(&self, said: Option<Parcel>) -> Result<Parcel, RankError>;
}

impl dyn Ranks + '_ {
    /// As [`gather`](Ranks::gather), of messages.
    ///
    /// # Errors
    /// [`RankError`]
    pub fn gather_messages<T: Serialize + DeserializeOwned>(&self, own: T) -> Result<Vec<T>, RankError> {
        if self.rank() > 0 {
            return self.gather(Parcel::of(&own)).map(|_| vec![]);
        }
        let all = self.gather(Parcel::default())?;
        let others = all.iter().enumerate().skip(1).map(|(rank, parcel)| parcel.open(rank));
        once(Ok(own)).chain(others).collect()
    }

    /// As [`tell`](Ranks::tell), of a message.
    ///
    /// # Errors
    /// [`RankError`]
    pub fn tell_message<T: Serialize + DeserializeOwned>(&self, said: Option<T>) -> Result<T, RankError> {
        let told = self.tell(said.as_ref().map(Parcel::of))?;
        said.map_or_else(|| told.open(0), Ok)
    }
}

/// By whom simulations are carried out that begin now.
#[derive(Clone, Copy, Debug)]
pub enum Crew {
    /// By one rank alone.
    One,
    /// By several threads of this process, each a rank with as many threads as the current pool.
    Threads(usize),
    /// By processes, of which this is one; what gives its place among them.
    Processes(fn() -> Box<dyn Ranks>),
}

impl Crew {
    /// How many ranks these are.
    pub fn count(self) -> usize {
        match self {
            Crew::One => 1,
            Crew::Threads(count) => count,
            Crew::Processes(join) => join().count(),
        }
    }
}

thread_local! {
    static CREW: Cell<Crew> = const { Cell::new(Crew::One) };
}

/// By whom simulations are carried out that begin now, on this thread.
pub(crate) fn crew() -> Crew {
    CREW.get()
}

/// What `work` gives, where simulations that it begins, on this thread, are carried out by others than before.
pub fn over<R>(crew: Crew, work: impl FnOnce() -> R) -> R {
    /// Puts back what was, even if that is because of a panic.
    struct Before(Crew);

    impl Drop for Before {
        fn drop(&mut self) {
            CREW.set(self.0);
        }
    }

    let _before = Before(CREW.replace(crew));
    work()
}

/// Tells processes that wait for a simulation that there is no other; for the first rank to call. The message is an option, which holds the
/// next simulation where there is one.
///
/// # Errors
/// [`RankError`]
pub fn dismiss(ranks: &dyn Ranks) -> Result<(), RankError> {
    ranks.tell_message(Some(None::<()>)).map(drop)
}

/// Waits for the first rank; returns whether it said [`dismiss`] in place of beginning a simulation.
pub fn is_dismissed(ranks: &dyn Ranks) -> bool {
    ranks.tell_message::<Option<()>>(None) == Ok(None)
}
