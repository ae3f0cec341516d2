//! Team of processes that make one study together.
//!
//! All processes execute the same study. Each makes a part of the independent runs; then they exchange results as lines of a
//! [`Journal`](super::Journal), and each continues as if it had made all runs. Results that depend on time, such as a rate, are
//! measured by one process and broadcast, so that all make the same decisions.

use serde_json::Value;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use stripmine_physics::ranks::{Parcel, RankBackend, RankError, Ranks};

/// Results of runs by key.
pub(super) type RunResults = BTreeMap<String, Value>;

/// Runs of each process as JSON, none for one that has ended its part. The first process broadcasts them, or the error that ends the study.
type ExchangedRuns = Result<Vec<Option<String>>, RankError>;

/// Membership of this process in the team.
pub(crate) struct ProcessTeam {
    ranks: Mutex<Box<dyn Ranks>>,
    rank: usize,
    count: usize,
    has_ended: AtomicBool,
}

impl ProcessTeam {
    /// Team of the processes of a crew; none if this process is alone.
    pub(crate) fn of(crew: RankBackend) -> Option<ProcessTeam> {
        match crew {
            RankBackend::Processes(join) => Some(ProcessTeam::new(join())),
            RankBackend::One | RankBackend::Threads(_) => None,
        }
    }

    /// Team with this process as one of several ranks.
    pub(crate) fn new(ranks: Box<dyn Ranks>) -> ProcessTeam {
        let (rank, count) = (ranks.rank(), ranks.count());
        ProcessTeam { ranks: Mutex::new(ranks), rank, count, has_ended: AtomicBool::new(false) }
    }

    /// Returns true if this process writes, prints and measures times.
    pub(crate) fn is_first(&self) -> bool {
        self.rank == 0
    }

    /// Share of this process in a list of independent inputs.
    pub(super) fn own_share<'i, T>(&self, all: &'i [T]) -> Vec<&'i T> {
        all.iter().skip(self.rank).step_by(self.count).collect()
    }

    /// Exchanges the runs of this process for those of all. Waits for the others.
    ///
    /// # Errors
    /// [`RankError`] if the study has ended on the first process, or another process is lost.
    pub(super) fn exchange_runs(&self, own: &RunResults) -> Result<RunResults, RankError> {
        let text = serde_json::to_string(own).map_err(|_| RankError::Unreadable(self.rank))?;
        let ranks = self.ranks();
        let gathered = ranks.gather_messages(Some(text));
        let said = match gathered {
            Err(lost) if !self.is_first() => return Err(lost),
            gathered => self.is_first().then_some(gathered),
        };
        let told: ExchangedRuns = ranks.broadcast_message(said)?;
        let all = told.inspect_err(|_| self.has_ended.store(true, Ordering::Relaxed))?;
        let mut runs = RunResults::new();
        for (rank, text) in all.iter().enumerate() {
            let Some(text) = text else { continue };
            let of_rank: RunResults = serde_json::from_str(text).map_err(|_| RankError::Unreadable(rank))?;
            runs.extend(of_rank);
        }
        Ok(runs)
    }

    fn ranks(&self) -> MutexGuard<'_, Box<dyn Ranks>> {
        self.ranks.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for ProcessTeam {
    /// The first process ends the study on all, however it ended there; the others wait for that.
    fn drop(&mut self) {
        let ranks = self.ranks();
        while !self.has_ended.load(Ordering::Relaxed) {
            // The runs of the others are discarded.
            let gathered = ranks.gather(Parcel::of(&None::<String>));
            let said = self.is_first().then_some(Err(RankError::Ended(0)));
            let told = gathered.and_then(|_| ranks.broadcast_message::<ExchangedRuns>(said));
            self.has_ended.store(!matches!(told, Ok(Ok(_))), Ordering::Relaxed);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::results::{Journal, JournalError, JournalIdentity, ProcessTeam};
    use std::path::Path;
    use std::sync::Mutex;
    use std::thread;
    use stripmine_physics::ranks::local;

    /// Results of each rank; none if the study fails.
    type RankResults = Vec<Option<Vec<u64>>>;

    /// Results of a study of three stages, and the rank that made each run.
    fn study(folder: &Path, count: usize, fails: bool) -> (RankResults, Vec<(usize, u64)>) {
        let made = Mutex::new(vec![]);
        let found = thread::scope(|scope| {
            let one = |ranks: local::ThreadRank| {
                let made = &made;
                move || {
                    let identity =
                        JournalIdentity { of: "a study".to_owned(), digest: "12345678".to_owned() };
                    let team = ProcessTeam::new(Box::new(ranks));
                    let rank = team.rank;
                    let journal = Journal::open(folder, &identity, Some(team)).ok()?;
                    let run = |&key: &u64| {
                        let make = || {
                            made.lock().unwrap().push((rank, key));
                            Ok::<_, JournalError>(10 * key)
                        };
                        journal.recall(&key.to_string(), |_| true, make)
                    };
                    let first = journal.run_on_one(|| run(&0)).ok()?;
                    if fails && rank == 0 {
                        return None;
                    }
                    let many: Vec<u64> = (1..20).collect();
                    let second = journal.run_all(&many, run).ok()?;
                    let third = journal.run_all(&[20], run).ok()?;
                    Some([vec![first], second, third].concat())
                }
            };
            let started: Vec<_> =
                local::ranks(count, 1).into_iter().map(|ranks| scope.spawn(one(ranks))).collect();
            started.into_iter().map(|thread| thread.join().unwrap()).collect()
        });
        (found, made.into_inner().unwrap())
    }

    /// Every run is made once, by the ranks in turn; all have the same results; finished runs are not repeated.
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

    /// If the first rank ends early, the others do not wait forever.
    #[test]
    fn the_first_rank_ends_all() {
        let folder = tempfile::tempdir().unwrap();
        let (found, _) = study(folder.path(), 3, true);
        assert_eq!(found, vec![None; 3]);
    }
}
