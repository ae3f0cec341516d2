//! Failures of runs on several ranks.

use super::{Clock, FailureKind, PhysicsFailure};
use crate::ranks::{self, RankError};

/// A simulation that runs on one rank only.
const ONE_RANK: FailureKind = FailureKind::new("one-rank");
/// A rank is lost.
pub const RANK_ENDED: FailureKind = FailureKind::new("rank-ended");
/// End of a process other than the first rank when nothing is wrong.
pub const DISMISSED: FailureKind = FailureKind::new("dismissed");

/// Rejects several ranks for a reason.
///
/// # Errors
/// [`PhysicsFailure`] if there are several.
pub(crate) fn reject_several_ranks(why: &str) -> Result<(), PhysicsFailure> {
    match ranks::current_backend().count() {
        1 => Ok(()),
        count => {
            let what = format!("cannot run on {count} ranks: {why}");
            let remedy = "use one rank, or several seeds: run --seeds";
            Err(PhysicsFailure::new(ONE_RANK, what, remedy))
        }
    }
}

/// Failure of the remaining ranks after one is lost.
pub(crate) fn rank_loss_failure(lost: RankError, at: Clock) -> PhysicsFailure {
    let remedy =
        "see its last message; the last checkpoint is complete: resume with --resume, on any number of ranks";
    PhysicsFailure::new(RANK_ENDED, lost.to_string(), remedy).at(at)
}
