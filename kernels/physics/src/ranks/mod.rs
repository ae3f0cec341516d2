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
//! Ranks are threads of this process ([`local`]): each has its own part of the particles, and nothing but messages in common.

pub mod local;
mod parcel;

pub use parcel::{Parcel, Reader};

use crate::method::{Failure, FailureKind};
use std::cell::Cell;

/// A rank has ended, and what was asked of it will not come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("rank {0} has ended")]
pub struct Gone(pub usize);

/// One of several ranks.
pub trait Ranks: Send {
    /// Which one this is.
    fn rank(&self) -> usize;

    /// How many there are.
    fn count(&self) -> usize;

    /// Sends something to the rank below and to that above, and gives what came from below and from above. The first rank is above the last one; of two
    /// ranks each is below and above the other.
    ///
    /// # Errors
    /// [`Gone`]
    fn halo(&self, to: [Parcel; 2]) -> Result<[Parcel; 2], Gone>;

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

thread_local! {
    static COUNT: Cell<usize> = const { Cell::new(1) };
}

/// Why a simulation cannot be carried out by several ranks.
const ONE_RANK: FailureKind = FailureKind::new("one-rank");

/// Refuses several ranks, for a reason.
///
/// # Errors
/// [`Failure`] if there are several.
pub fn refuse_several(why: &str) -> Result<(), Failure> {
    match count() {
        1 => Ok(()),
        count => {
            let what = format!("{count} ranks were asked for, but {why}");
            let remedy = "take one rank, or several seeds: run --seeds";
            Err(Failure::new(ONE_RANK, what, remedy))
        }
    }
}

/// How many ranks simulations are to be carried out by that begin now, on this thread.
pub fn count() -> usize {
    COUNT.get()
}

/// What `work` gives, where simulations that it begins, on this thread, are carried out by `count` ranks.
pub fn over<R>(count: usize, work: impl FnOnce() -> R) -> R {
    /// Puts back what was, even if that is because of a panic.
    struct Before(usize);

    impl Drop for Before {
        fn drop(&mut self) {
            COUNT.set(self.0);
        }
    }

    let _before = Before(COUNT.replace(count.max(1)));
    work()
}
