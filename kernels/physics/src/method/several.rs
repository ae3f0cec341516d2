//! What a method says where several ranks are asked for.

use super::{Clock, Failure, FailureKind};
use crate::ranks::{self, RankError};

/// Why a simulation cannot be carried out by several ranks.
const ONE_RANK: FailureKind = FailureKind::new("one-rank");
/// A rank is lost.
pub const RANK_ENDED: FailureKind = FailureKind::new("rank-ended");
/// What a process ends its part with that is not the first rank: nothing is wrong.
pub const DISMISSED: FailureKind = FailureKind::new("dismissed");

/// Refuses several ranks, for a reason.
///
/// # Errors
/// [`Failure`] if there are several.
pub(crate) fn refuse_several_ranks(why: &str) -> Result<(), Failure> {
    match ranks::crew().count() {
        1 => Ok(()),
        count => {
            let what = format!("{count} ranks were asked for, but {why}");
            let remedy = "take one rank, or several seeds: run --seeds";
            Err(Failure::new(ONE_RANK, what, remedy))
        }
    }
}

/// The failure of the other ranks where one is lost.
pub(crate) fn ended(lost: RankError, at: Clock) -> Failure {
    let remedy =
        "see what it said last; the last checkpoint is whole: go on with --resume, on any number of ranks";
    Failure::new(RANK_ENDED, lost.to_string(), remedy).at(at)
}
