//! First exchange between processes. It checks that all of them can begin, and that they do the same.
//!
//! Every process takes part once: before its first message of joint work, otherwise at its end. So no process waits for one that has ended.

use super::{process_failure, rank_failure};
use crate::console::CommandFailure;
use serde::{Deserialize, Serialize};
use stripmine_physics::ranks::{RankError, Ranks};

/// State of a process before its first message.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum ProcessState {
    /// Begins the work that this text describes (scene and program).
    Begins(String),
    /// Has ended successfully without the others.
    Finished,
    /// Cannot begin.
    Refused { code: u8, words: String },
}

impl ProcessState {
    pub(super) fn refused(failure: &CommandFailure) -> ProcessState {
        ProcessState::Refused { code: failure.exit_code(), words: failure.message_text() }
    }
}

/// Verdict on all processes, the same on each.
pub(super) enum JointVerdict {
    /// All begin the same work, have ended successfully, or fail for the same reason; or the first rank failed in work of its own.
    Own,
    /// Failure with which all end.
    Failed(CommandFailure),
}

/// Verdict as broadcast by the first rank.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum BroadcastVerdict {
    /// All processes are in the same state.
    Alike,
    /// A rank fails. `alone` is true if the others have ended successfully.
    Failed { rank: usize, alone: bool, code: u8, words: String },
    /// A rank does different work from the first one.
    Differs(usize),
}

/// Exchanges the states of all ranks and returns the verdict.
///
/// # Errors
/// [`RankError`] if a rank is lost.
pub(super) fn exchange_states(ranks: &dyn Ranks, part: ProcessState) -> Result<JointVerdict, RankError> {
    let all = ranks.gather_messages(part)?;
    let announced = ranks.broadcast_message((ranks.rank() == 0).then(|| joint_verdict(&all)))?;
    Ok(match announced {
        BroadcastVerdict::Alike => JointVerdict::Own,
        BroadcastVerdict::Failed { rank, alone: true, .. } if ranks.rank() == rank => JointVerdict::Own,
        BroadcastVerdict::Failed { rank, code, words, .. } => {
            JointVerdict::Failed(rank_failure(rank, code, &words))
        }
        BroadcastVerdict::Differs(rank) => JointVerdict::Failed(process_failure(
            format!(
                "rank {rank} differs from rank 0 in its scene, its arguments or its version of the program"
            ),
            "start all ranks with the same arguments, files and program",
        )),
    })
}

/// Finds the first rank that fails, unless all fail for the same reason; otherwise the first that differs.
fn joint_verdict(all: &[ProcessState]) -> BroadcastVerdict {
    let Some(differs) = all.iter().position(|part| *part != all[0]) else { return BroadcastVerdict::Alike };
    let refused = all.iter().enumerate().find_map(|(rank, part)| match part {
        ProcessState::Refused { code, words } => Some((rank, *code, words.clone())),
        ProcessState::Begins(_) | ProcessState::Finished => None,
    });
    match refused {
        Some((rank, code, words)) => {
            let alone = rank == 0 && all[1..].iter().all(|part| *part == ProcessState::Finished);
            BroadcastVerdict::Failed { rank, alone, code, words }
        }
        None => BroadcastVerdict::Differs(differs),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::ErrorKind;
    use std::thread;
    use stripmine_physics::ranks::local;

    /// Exit code and message of each rank for the given states; none where they agree.
    fn outcomes(parts: &[&str]) -> Vec<Option<(u8, String)>> {
        let one = |ranks: local::ThreadRank, part: &str| {
            let failure = CommandFailure::writing(part.to_owned())(ErrorKind::NotFound.into());
            let part = match part.split_once(' ') {
                Some(("begins", same)) => ProcessState::Begins(same.to_owned()),
                Some(_) => ProcessState::refused(&failure),
                None => ProcessState::Finished,
            };
            match exchange_states(&ranks, part).unwrap() {
                JointVerdict::Own => None,
                JointVerdict::Failed(failure) => Some((failure.exit_code(), failure.to_string())),
            }
        };
        thread::scope(|scope| {
            let ranks = local::ranks(parts.len(), 1).into_iter().zip(parts);
            let started: Vec<_> = ranks.map(|(ranks, part)| scope.spawn(move || one(ranks, part))).collect();
            started.into_iter().map(|thread| thread.join().unwrap()).collect()
        })
    }

    /// All ranks end alike, and the message names the rank that cannot begin or does something else.
    #[test]
    fn a_rank_that_cannot_begin_ends_all() {
        for (parts, expected) in [
            (&["begins a", "begins a", "begins a"][..], None),
            (&["finished", "finished"], None),
            // Every rank has its own message.
            (&["no scene", "no scene"], None),
            (&["begins a", "no scene"], Some((5, "rank 1: no scene"))),
            (&["no scene", "begins a", "begins a"], Some((5, "rank 0: no scene"))),
            (&["finished", "begins a", "no scene"], Some((5, "rank 2: no scene"))),
            (&["no scene", "no memory"], Some((5, "rank 0: no scene"))),
            (&["begins a", "begins a", "begins b"], Some((4, "rank 2 differs from rank 0"))),
            (&["begins a", "finished"], Some((4, "rank 1 differs from rank 0"))),
        ] {
            for outcome in outcomes(parts) {
                let fits = match (&outcome, expected) {
                    (Some((code, said)), Some((expected, words))) => {
                        *code == expected && said.contains(words)
                    }
                    (said, expected) => said.is_none() && expected.is_none(),
                };
                assert!(fits, "{parts:?}: {outcome:?}");
            }
        }
        // The first rank reports its own failure; the others end with its exit code.
        let [first, other] = &outcomes(&["no scene", "finished"])[..] else { panic!("two ranks") };
        assert!(first.is_none() && other.as_ref().is_some_and(|(code, _)| *code == 5), "{first:?} {other:?}");
    }
}
