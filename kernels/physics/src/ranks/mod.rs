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

pub use parcel::{Parcel, Reader};

use std::cell::Cell;

/// A rank has ended, and what was asked of it will not come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("rank {0} has ended")]
pub struct Gone(pub usize);

/// One of several ranks. What one sends to another arrives in the order in which it was sent.
pub trait Ranks: Send {
    /// Which one this is.
    fn rank(&self) -> usize;

    /// How many there are.
    fn count(&self) -> usize;

    /// Sends something to the rank below and to that above, does something else while these messages are under way, and gives what came from below and from above.
    /// The first rank is above the last one; of two ranks each is below and above the other.
    ///
    /// # Errors
    /// [`Gone`]
    fn halo(&self, to: [Parcel; 2], meanwhile: &mut dyn FnMut()) -> Result<[Parcel; 2], Gone>;

    /// Sends something to each rank, and gives what came from each.
    ///
    /// # Errors
    /// [`Gone`]
    fn migrate(&self, to: Vec<Parcel>) -> Result<Vec<Parcel>, Gone>;

    /// Sends something to the first rank, which is given what came from each; the others get nothing.
    ///
    /// # Errors
    /// [`Gone`]
    fn gather(&self, own: Parcel) -> Result<Vec<Parcel>, Gone>;

    /// Gives what the first rank says; the others say nothing.
    ///
    /// # Errors
    /// [`Gone`]
    fn tell(&self, said: Option<Parcel>) -> Result<Parcel, Gone>;
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
pub fn crew() -> Crew {
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

/// Says that there is no other simulation, to processes that wait for one; for the first rank to say.
///
/// # Errors
/// [`Gone`]
pub fn dismiss(ranks: &dyn Ranks) -> Result<(), Gone> {
    let mut none = Parcel::new();
    none.push(0);
    ranks.tell(Some(none)).map(drop)
}

/// Waits for the first rank; returns whether it said [`dismiss`], or has ended, in place of beginning a simulation.
pub fn is_dismissed(ranks: &dyn Ranks) -> bool {
    ranks.tell(None).is_ok_and(|parcel| parcel.read().count() == 0)
}
