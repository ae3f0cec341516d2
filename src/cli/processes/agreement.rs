//! The first exchange between processes: whether all of them can begin, and do the same.
//!
//! Every process takes part in it once: before its first message where it begins something that all of them do, else at its end. So nobody waits for a process
//! that has ended.

use super::{broken, of_rank};
use crate::console::Failure;
use stripmine_physics::ranks::{Gone, Parcel, Ranks};

/// The part of a process before its first message.
#[derive(Clone, Copy)]
pub(super) enum Part<'p> {
    /// It begins what this text describes (scene and program).
    Begins(&'p str),
    /// It has ended well without the others.
    Finished,
    /// It cannot begin.
    Refused(&'p Failure),
}

/// The same on all processes.
pub(super) enum Verdict {
    /// All begin the same, have ended well, or fail for the same reason; or the first rank failed in what is its alone.
    Own,
    /// The failure with which all end.
    Failed(Failure),
}

const BEGINS: usize = 0;
const FINISHED: usize = 1;
const REFUSED: usize = 2;

/// Words by which the first rank announces the verdict.
const ALIKE: usize = 0;
const FAILED: usize = 1;
const FAILED_ALONE: usize = 2;
const DIFFERS: usize = 3;

/// The verdict on the parts of all ranks.
///
/// # Errors
/// [`Gone`]
pub(super) fn agreed(ranks: &dyn Ranks, part: Part<'_>) -> Result<Verdict, Gone> {
    let mut own = Parcel::new();
    let (kind, code, text) = match part {
        Part::Begins(same) => (BEGINS, 0, same.to_owned()),
        Part::Finished => (FINISHED, 0, String::new()),
        Part::Refused(failure) => (REFUSED, failure.exit_code(), failure.words()),
    };
    [kind, code.into()].into_iter().for_each(|word| own.push(word));
    own.text(&text);
    let all = ranks.gather(own)?;
    let told = ranks.tell((ranks.rank() == 0).then(|| verdict(&all)))?;
    let mut reader = told.read();
    let [verdict, rank, code] = [(); 3].map(|()| reader.count());
    Ok(match verdict {
        ALIKE => Verdict::Own,
        FAILED_ALONE if ranks.rank() == rank => Verdict::Own,
        FAILED | FAILED_ALONE => Verdict::Failed(of_rank(rank, code as u8, &reader.text())),
        _ => Verdict::Failed(broken(
            format!(
                "rank {rank} has another scene, other arguments, or another version of the program than rank 0"
            ),
            "give all ranks the same arguments, the same files and the same program",
        )),
    })
}

/// The verdict in words of a parcel: the first rank that fails where not all do for the same reason, else the first that differs.
fn verdict(all: &[Parcel]) -> Parcel {
    let read = |parcel: &Parcel| {
        let mut reader = parcel.read();
        (reader.count(), reader.count(), reader.text())
    };
    let mut said = Parcel::new();
    let Some(differs) = all.iter().position(|parcel| *parcel != all[0]) else {
        [ALIKE, 0, 0].into_iter().for_each(|word| said.push(word));
        return said;
    };
    let fails = all.iter().map(read).enumerate().find(|(_, (kind, ..))| *kind == REFUSED);
    let others_finished = all[1..].iter().all(|parcel| read(parcel).0 == FINISHED);
    let (words, text) = match fails {
        Some((0, (_, code, text))) if others_finished => ([FAILED_ALONE, 0, code], text),
        Some((rank, (_, code, text))) => ([FAILED, rank, code], text),
        None => ([DIFFERS, differs, 0], String::new()),
    };
    words.into_iter().for_each(|word| said.push(word));
    said.text(&text);
    said
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::ErrorKind;
    use std::thread;
    use stripmine_physics::ranks::local;

    /// Exit code and words of each of some ranks, for the part of each; nothing where they agree.
    fn outcomes(parts: &[&str]) -> Vec<Option<(u8, String)>> {
        let one = |ranks: local::Local, part: &str| {
            let failure = Failure::writing(part.to_owned())(ErrorKind::NotFound.into());
            let part = match part.split_once(' ') {
                Some(("begins", same)) => Part::Begins(same),
                Some(_) => Part::Refused(&failure),
                None => Part::Finished,
            };
            match agreed(&ranks, part).unwrap() {
                Verdict::Own => None,
                Verdict::Failed(failure) => Some((failure.exit_code(), failure.to_string())),
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
    fn one_rank_that_cannot_begin_ends_all() {
        for (parts, expected) in [
            (&["begins a", "begins a", "begins a"][..], None),
            (&["finished", "finished"], None),
            // Every rank has the message itself.
            (&["no scene", "no scene"], None),
            (&["begins a", "no scene"], Some((5, "rank 1: no scene"))),
            (&["no scene", "begins a", "begins a"], Some((5, "rank 0: no scene"))),
            (&["finished", "begins a", "no scene"], Some((5, "rank 2: no scene"))),
            (&["no scene", "no memory"], Some((5, "rank 0: no scene"))),
            (&["begins a", "begins a", "begins b"], Some((4, "rank 2 has another scene"))),
            (&["begins a", "finished"], Some((4, "rank 1 has another scene"))),
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
        // The first rank says itself what failed in a verb of its own; the others end with its exit code.
        let [first, other] = &outcomes(&["no scene", "finished"])[..] else { panic!("two ranks") };
        assert!(first.is_none() && other.as_ref().is_some_and(|(code, _)| *code == 5), "{first:?} {other:?}");
    }
}
