//! Several ranks that carry out one simulation: their messages, independent of the transport.
//!
//! ```text
//! halo       to the ranks below and above, in a ring        particles near the edge          every step
//! migrate    from each to each                              particles that change rank       occasionally
//! gather     from each to the first                         sums, in the order of ranks      every step
//! broadcast  from the first to all                          next moment, and when to stop    every step
//! ```
//!
//! No sum is left to the transport. Gathered values are added in an order that depends on the scene alone, so a run has the same bits on any number
//! of ranks.
//!
//! Ranks are threads of this process ([`local`]), or processes started by `mpiexec` (feature `mpi`). Each has its own part of the particles; they
//! share nothing but messages.

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

/// Failure of a rank to answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, thiserror::Error)]
pub enum RankError {
    /// The rank has ended.
    #[error("rank {0} has ended")]
    Ended(usize),
    /// The rank has sent bytes that are not the expected message.
    #[error("rank {0} sent a message that cannot be read")]
    Unreadable(usize),
}

/// One of several ranks. Messages between two ranks arrive in the order in which they were sent.
pub trait Ranks: Send {
    /// Number of this rank, from 0.
    fn rank(&self) -> usize;

    /// Number of ranks.
    fn count(&self) -> usize;

    /// Ranks below and above in a ring.
    fn neighbours(&self) -> [usize; 2] {
        let (rank, count) = (self.rank(), self.count());
        [(rank + count - 1) % count, (rank + 1) % count]
    }

    /// Sends a message each to the ranks below and above, runs `meanwhile` while they are in transit, and returns the messages from below and
    /// above. The first rank is above the last. Of two ranks, each is below and above the other.
    ///
    /// # Errors
    /// [`RankError`]
    fn halo(&self, to: [Parcel; 2], meanwhile: &mut dyn FnMut()) -> Result<[Parcel; 2], RankError>;

    /// Sends a message to each rank, and returns the messages of all.
    ///
    /// # Errors
    /// [`RankError`]
    fn migrate(&self, to: Vec<Parcel>) -> Result<Vec<Parcel>, RankError>;

    /// Sends a message to the first rank, which returns those of all; the others return nothing.
    ///
    /// # Errors
    /// [`RankError`]
    fn gather(&self, own: Parcel) -> Result<Vec<Parcel>, RankError>;

    /// Broadcasts a message from the first rank; the others pass none.
    ///
    /// # Errors
    /// [`RankError`]
    fn broadcast(&self, said: Option<Parcel>) -> Result<Parcel, RankError>;
}

impl dyn Ranks + '_ {
    /// Gathers serialised messages as [`gather`](Ranks::gather) does.
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

    /// Broadcasts a serialised message as [`broadcast`](Ranks::broadcast) does.
    ///
    /// # Errors
    /// [`RankError`]
    pub fn broadcast_message<T: Serialize + DeserializeOwned>(
        &self,
        said: Option<T>,
    ) -> Result<T, RankError> {
        let told = self.broadcast(said.as_ref().map(Parcel::of))?;
        said.map_or_else(|| told.open(0), Ok)
    }
}

/// Ranks that carry out simulations.
#[derive(Clone, Copy, Debug)]
pub enum RankBackend {
    /// One rank alone.
    One,
    /// Several threads of this process, each a rank with as many threads as the current pool.
    Threads(usize),
    /// Processes, including this one; the function returns its rank.
    Processes(fn() -> Box<dyn Ranks>),
}

impl RankBackend {
    /// Number of ranks.
    pub fn count(self) -> usize {
        match self {
            RankBackend::One => 1,
            RankBackend::Threads(count) => count,
            RankBackend::Processes(join) => join().count(),
        }
    }
}

thread_local! {
    static CREW: Cell<RankBackend> = const { Cell::new(RankBackend::One) };
}

/// Ranks that carry out simulations started now on this thread.
pub(crate) fn current_backend() -> RankBackend {
    CREW.get()
}

/// Runs `work`; simulations that it starts on this thread are carried out by `crew`.
pub fn with_backend<R>(crew: RankBackend, work: impl FnOnce() -> R) -> R {
    /// Restores the previous crew, even after a panic.
    struct RestoredBackend(RankBackend);

    impl Drop for RestoredBackend {
        fn drop(&mut self) {
            CREW.set(self.0);
        }
    }

    let _before = RestoredBackend(CREW.replace(crew));
    work()
}

/// Dismisses processes that wait for a simulation, since no other follows; called by the first rank. The message is an option that holds the next
/// simulation, if any.
///
/// # Errors
/// [`RankError`]
pub fn dismiss(ranks: &dyn Ranks) -> Result<(), RankError> {
    ranks.broadcast_message(Some(None::<()>)).map(drop)
}

/// Waits for the first rank; returns true if it called [`dismiss`] instead of starting a simulation.
pub fn is_dismissed(ranks: &dyn Ranks) -> bool {
    ranks.broadcast_message::<Option<()>>(None) == Ok(None)
}
