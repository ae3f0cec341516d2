//! Processes that make one study together.
//!
//! All of them carry out the same study. Of what is independent in it each makes a part; then they tell each other what they found, as the
//! lines of a [`Journal`](super::Journal), and each goes on as if it had made everything. What depends on time, such as a rate, is made by one and told to all,
//! so that all decide alike.

use serde_json::Value;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use stripmine_physics::ranks::{Crew, Parcel, RankError, Ranks};

/// Runs by their keys.
pub(super) type Runs = BTreeMap<String, Value>;

/// The runs that each process has made, as JSON; none of one that has ended its part. The first process tells all of them, or whose end is the
/// end of the study.
type Told = Result<Vec<Option<String>>, RankError>;

/// One of the processes.
pub(crate) struct Team {
    ranks: Mutex<Box<dyn Ranks>>,
    rank: usize,
    count: usize,
    has_ended: AtomicBool,
}

impl Team {
    /// The processes of a crew; none where this one is alone.
    pub(crate) fn of(crew: Crew) -> Option<Team> {
        match crew {
            Crew::Processes(join) => Some(Team::new(join())),
            Crew::One | Crew::Threads(_) => None,
        }
    }

    /// This one of several ranks.
    pub(crate) fn new(ranks: Box<dyn Ranks>) -> Team {
        let (rank, count) = (ranks.rank(), ranks.count());
        Team { ranks: Mutex::new(ranks), rank, count, has_ended: AtomicBool::new(false) }
    }

    /// Whether it is this one that writes, prints and takes times.
    pub(crate) fn is_first(&self) -> bool {
        self.rank == 0
    }

    /// Its part of some independent things.
    pub(super) fn part<'i, T>(&self, all: &'i [T]) -> Vec<&'i T> {
        all.iter().skip(self.rank).step_by(self.count).collect()
    }

    /// Runs that this one has made, for those that all have made. Waits for the others.
    ///
    /// # Errors
    /// [`RankError`] if the study has ended on the first one, or another one is lost.
    pub(super) fn exchanged(&self, own: &Runs) -> Result<Runs, RankError> {
        let text = serde_json::to_string(own).map_err(|_| RankError::Unreadable(self.rank))?;
        let ranks = self.ranks();
        let gathered = ranks.gather_messages(Some(text));
        let said = match gathered {
            Err(lost) if !self.is_first() => return Err(lost),
            gathered => self.is_first().then_some(gathered),
        };
        let told: Told = ranks.tell_message(said)?;
        let all = told.inspect_err(|_| self.has_ended.store(true, Ordering::Relaxed))?;
        let mut runs = Runs::new();
        for (rank, text) in all.iter().enumerate() {
            let Some(text) = text else { continue };
            let of_rank: Runs = serde_json::from_str(text).map_err(|_| RankError::Unreadable(rank))?;
            runs.extend(of_rank);
        }
        Ok(runs)
    }

    fn ranks(&self) -> MutexGuard<'_, Box<dyn Ranks>> {
        self.ranks.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Team {
    /// The first one ends the study on all, however it came to its end there; the others wait for that.
    fn drop(&mut self) {
        let ranks = self.ranks();
        while !self.has_ended.load(Ordering::Relaxed) {
            // Whatever runs the others have made, nobody needs them.
            let gathered = ranks.gather(Parcel::of(&None::<String>));
            let said = self.is_first().then_some(Err(RankError::Ended(0)));
            let told = gathered.and_then(|_| ranks.tell_message::<Told>(said));
            self.has_ended.store(!matches!(told, Ok(Ok(_))), Ordering::Relaxed);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::results::{Identity, Journal, JournalError, Team};
    use std::path::Path;
    use std::sync::Mutex;
    use std::thread;
    use stripmine_physics::ranks::local;

    /// What each rank finds; nothing where the study does not come to its end.
    type Found = Vec<Option<Vec<u64>>>;

    /// What a study of three stages finds, and which rank has made which runs.
    fn study(folder: &Path, count: usize, fails: bool) -> (Found, Vec<(usize, u64)>) {
        let made = Mutex::new(vec![]);
        let found = thread::scope(|scope| {
            let one = |ranks: local::Local| {
                let made = &made;
                move || {
                    let identity = Identity { of: "a study".to_owned(), digest: "12345678".to_owned() };
                    let team = Team::new(Box::new(ranks));
                    let rank = team.rank;
                    let journal = Journal::open(folder, &identity, Some(team)).ok()?;
                    let run = |&key: &u64| {
                        let make = || {
                            made.lock().unwrap().push((rank, key));
                            Ok::<_, JournalError>(10 * key)
                        };
                        journal.recall(&key.to_string(), |_| true, make)
                    };
                    let first = journal.once(|| run(&0)).ok()?;
                    if fails && rank == 0 {
                        return None;
                    }
                    let many: Vec<u64> = (1..20).collect();
                    let second = journal.over(&many, run).ok()?;
                    let third = journal.over(&[20], run).ok()?;
                    Some([vec![first], second, third].concat())
                }
            };
            let started: Vec<_> =
                local::ranks(count, 1).into_iter().map(|ranks| scope.spawn(one(ranks))).collect();
            started.into_iter().map(|thread| thread.join().unwrap()).collect()
        });
        (found, made.into_inner().unwrap())
    }

    /// Every run is made once, by the ranks in turn, and all find the same; what was finished is not made again.
    #[test]
    fn ranks_make_a_study_together() {
        let expected = Some((0..21).map(|key| 10 * key).collect());
        for count in [1, 2, 5] {
            let folder = tempfile::tempdir().unwrap();
            let (found, mut made) = study(folder.path(), count, false);
            assert_eq!(found, vec![expected.clone(); count]);
            made.sort_by_key(|run| run.1);
            let by = |key: u64| if (1..20).contains(&key) { (key as usize - 1) % count } else { 0 };
            assert_eq!(made, (0..21).map(|key| (by(key), key)).collect::<Vec<_>>());
            assert_eq!(study(folder.path(), 3, false), (vec![expected.clone(); 3], vec![]));
        }
    }

    /// Where the first rank ends early, the others do not wait for ever.
    #[test]
    fn the_end_of_the_first_rank_is_the_end_of_all() {
        let folder = tempfile::tempdir().unwrap();
        let (found, _) = study(folder.path(), 3, true);
        assert_eq!(found, vec![None; 3]);
    }
}
