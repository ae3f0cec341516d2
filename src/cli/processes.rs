//! The processes that `mpiexec` has started, where it has: which one this is, and what the others do meanwhile.
//!
//! The first rank is the program that the user sees. The others read the same scene and do as it says, or runs of their own; they print nothing.

mod agreement;
#[cfg(any(test, feature = "mpi"))]
mod joining;

#[cfg(feature = "mpi")]
use crate::console::warn;
use crate::console::{Failure, tell};
use crate::laboratory::rates::VERB as MEASURE;
use crate::study::StudyError;
use agreement::{Part, Verdict, agreed};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use stripmine_physics::method::{DISMISSED, Failure as Broken, FailureKind, RANK_ENDED};
use stripmine_physics::ranks::{self, Crew, RankError, Ranks, dismiss, is_dismissed};
use stripmine_physics::reported::Class;

/// Variables by which a launcher tells processes how many they are, and which one each is.
struct Launcher {
    size: &'static str,
    rank: &'static str,
}

/// Slurm sets the number of tasks in batch scripts and interactive shells too: the rank of PMIx shows that `srun` started this process.
const LAUNCHERS: [Launcher; 3] = [
    Launcher { size: "PMI_SIZE", rank: "PMI_RANK" },
    Launcher { size: "OMPI_COMM_WORLD_SIZE", rank: "OMPI_COMM_WORLD_RANK" },
    Launcher { size: "SLURM_NTASKS", rank: "PMIX_RANK" },
];

/// Verbs that start no simulation together. Each process carries them out on its own, whatever launcher has set its variables.
const ALONE: [&str; 6] = ["scene", "average", "plot", "completions", "man", MEASURE];

/// A process among those that a launcher has started.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Launched {
    rank: usize,
    count: usize,
    /// The variable that tells the rank.
    variable: &'static str,
}

/// The place of this process among several, by the variables of the environment; none where it is the only one.
fn launched(variable: impl Fn(&str) -> Option<String>) -> Option<Launched> {
    let number = |name: &str| variable(name)?.trim().parse::<usize>().ok();
    LAUNCHERS.iter().find_map(|launcher| {
        let (count, rank) = (number(launcher.size)?, number(launcher.rank)?);
        (count > 1).then_some(Launched { rank, count, variable: launcher.rank })
    })
}

fn own_place() -> Option<Launched> {
    launched(|name| std::env::var(name).ok())
}

/// Reports whether this process says what fails: the first one, the only one, or any where each works on its own.
pub(super) fn is_first(verb: &str) -> bool {
    ALONE.contains(&verb) || own_place().is_none_or(|place| place.rank == 0)
}

const PROCESSES: FailureKind = FailureKind::new("processes");

/// What ranks need to speak to each other; the program holds it to its end.
pub(super) struct Session {
    #[cfg(feature = "mpi")]
    _session: Option<stripmine_physics::ranks::mpi::Session>,
    crew: Crew,
}

impl Session {
    /// Joins the other processes, where there are some and the verb has work for them.
    ///
    /// # Errors
    /// [`Failure`] where there are some, and this program was built without MPI.
    pub(super) fn begin(verb: &str) -> Result<Session, Failure> {
        let Some(place) = own_place().filter(|_| !ALONE.contains(&verb)) else {
            return Ok(Session {
                #[cfg(feature = "mpi")]
                _session: None,
                crew: Crew::One,
            });
        };
        #[cfg(feature = "mpi")]
        return Ok(Session {
            _session: joining::watched(stripmine_physics::ranks::mpi::Session::begin, waiting(place)),
            crew: Crew::Processes(stripmine_physics::ranks::mpi::world),
        });
        #[cfg(not(feature = "mpi"))]
        Err(without_mpi(place))
    }

    /// By whom simulations are carried out.
    pub(super) fn crew(&self) -> Crew {
        self.crew
    }

    /// The outcome of this process, once every other one knows of it: a process that could not begin ends all of them, in place of leaving them to
    /// wait for it.
    pub(super) fn ended(&self, outcome: Result<(), Failure>) -> Result<(), Failure> {
        let Crew::Processes(join) = self.crew else { return outcome };
        let part = match &outcome {
            Err(failure) if failure.exit_code() != 0 => Part::refused(failure),
            _ => Part::Finished,
        };
        match first_exchange(join().as_ref(), part)? {
            Verdict::Own => outcome,
            Verdict::Failed(failure) => Err(failure),
        }
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        // MPI would wait for the others, which wait for this process.
        if thread::panicking() && matches!(self.crew, Crew::Processes(_)) {
            abort(PANICKED);
        }
    }
}

/// The exit code of a program that panicked.
const PANICKED: u8 = 101;

/// Ends all processes at once.
fn abort(code: u8) -> ! {
    #[cfg(feature = "mpi")]
    stripmine_physics::ranks::mpi::abort(code);
    #[cfg(not(feature = "mpi"))]
    std::process::exit(code.into());
}

/// Records that the processes have heard of each other. They do so once, before any other message.
static HAVE_MET: AtomicBool = AtomicBool::new(false);

/// Whether all processes have begun, or ended, together.
pub(super) fn have_met() -> bool {
    HAVE_MET.load(Ordering::SeqCst)
}

/// The verdict on all processes, of the first exchange; later ones find nothing more.
fn first_exchange(ranks: &dyn Ranks, part: Part) -> Result<Verdict, Failure> {
    if HAVE_MET.swap(true, Ordering::SeqCst) {
        return Ok(Verdict::Own);
    }
    agreed(ranks, part).map_err(lost)
}

/// Begins what all processes do together, if every one of them can begin and does `same`; for each of several processes to call before its first message.
///
/// # Errors
/// [`Failure`] on all of them, naming the rank that cannot begin, or that does something else.
pub(super) fn begin(ranks: &dyn Ranks, same: &str) -> Result<(), Failure> {
    match first_exchange(ranks, Part::Begins(same.to_owned()))? {
        Verdict::Own => Ok(()),
        Verdict::Failed(failure) => Err(failure),
    }
}

/// How long others are waited for before this is said, and how much longer before this process ends (s).
#[cfg(feature = "mpi")]
const PATIENCE: [u64; 2] = [20, 280];

/// What a process does that waits for others to join: the first two say so, for one of them may be missing itself; all end in the end.
#[cfg(feature = "mpi")]
fn waiting(Launched { rank, count, .. }: Launched) -> Vec<(std::time::Duration, joining::Act)> {
    let [notice, end] = PATIENCE;
    let words = move |seconds: u64| {
        format!("rank {rank} waits for others of {count} processes, which have not joined for {seconds} s")
    };
    let remedy = format!(
        "give all ranks the same verb: {}, --help and --version join no other process",
        ALONE.join(", ")
    );
    let says = rank < 2;
    let warns = move || {
        if says {
            warn(format_args!("{}", words(notice)));
        }
    };
    let ends = move || {
        let failure = broken(words(notice + end), &remedy);
        if says {
            tell(&failure, false);
        }
        std::process::exit(failure.exit_code().into());
    };
    let seconds = std::time::Duration::from_secs;
    let acts: [(std::time::Duration, joining::Act); 2] =
        [(seconds(notice), Box::new(warns)), (seconds(end), Box::new(ends))];
    acts.into()
}

#[cfg(not(feature = "mpi"))]
fn without_mpi(Launched { count, variable, .. }: Launched) -> Failure {
    let what = format!(
        "this is one of {count} processes ({variable} is set), but the program was built without MPI"
    );
    let remedy = format!(
        "build it with: cargo build --release --features mpi; or take ranks that are threads: run --ranks; or unset {variable} \
         where each process is to work on its own"
    );
    broken(what, &remedy)
}

fn broken(what: String, remedy: &str) -> Failure {
    StudyError::Own(Box::new(Broken::new(PROCESSES, what, remedy))).into()
}

/// A rank is lost.
pub(super) fn lost(lost: RankError) -> Failure {
    broken(lost.to_string(), "see what it said last")
}

/// The failure of another rank, with its exit code and words.
pub(super) fn of_rank(rank: usize, code: u8, said: &str) -> Failure {
    Failure::OfProcess {
        process: format!("rank {rank}"),
        class: Class::of_exit_code(code),
        said: said.to_owned(),
    }
}

/// Which of several processes this is.
pub(super) fn rank(crew: Crew) -> usize {
    if let Crew::Processes(join) = crew { join().rank() } else { 0 }
}

/// Ranks were asked for as threads and as processes.
pub(super) fn ranks_twice() -> Failure {
    let what = "--ranks was given, but this is one of several processes already".to_owned();
    broken(what, "take --ranks without mpiexec, or mpiexec -n without --ranks")
}

/// The part that a rank which is not the first takes in simulations that `start` begins, until the first dismisses it.
pub(super) fn serve(crew: Crew, start: impl FnOnce() -> Result<(), Broken>) {
    let Crew::Processes(join) = crew else { return };
    let Err(failure) = ranks::over(crew, start) else { return };
    // Where the first rank has begun nothing, it was refused the same, and says so. Elsewhere it waits for this rank; and so do others, where
    // this one has lost one of them in the middle of a step.
    let is_waited_for = match failure.kind {
        DISMISSED => false,
        RANK_ENDED => true,
        _ => !is_dismissed(join().as_ref()),
    };
    if is_waited_for {
        let failure = Failure::from(StudyError::Own(Box::new(failure)));
        let code = failure.exit_code();
        tell(&of_rank(join().rank(), code, &failure.words()), false);
        abort(code);
    }
}

/// Does the same on all processes. The first rank does `first`, which may begin simulations on all of them, the others `serve`, which takes their part
/// in these.
///
/// # Errors
/// [`Failure`] of the rank itself, or of [`begin`] where they do not say the same of it (scene and program).
pub(super) fn together(
    join: fn() -> Box<dyn Ranks>,
    same: &str,
    first: impl FnOnce() -> Result<(), Failure>,
    serve: impl FnOnce(),
) -> Result<(), Failure> {
    let ranks = join();
    begin(ranks.as_ref(), same)?;
    if ranks.rank() == 0 {
        let outcome = first();
        dismiss(ranks.as_ref()).map_err(lost)?;
        return outcome;
    }
    serve();
    Ok(())
}

/// Work that ranks do on their own, each every so-many-th piece of it; the first failure, on the first rank once all have ended.
///
/// # Errors
/// The rank's own failure; on the first rank that of another one; or that of [`begin`].
pub(super) fn apart(
    join: fn() -> Box<dyn Ranks>,
    same: &str,
    mut work: impl FnMut(usize, usize) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let ranks = join();
    begin(ranks.as_ref(), same)?;
    let outcome = work(ranks.rank(), ranks.count());
    let said = outcome.as_ref().err().map(|failure| (failure.exit_code(), failure.words()));
    let all = ranks.gather_messages(said).map_err(lost)?;
    outcome?;
    let failed = all.into_iter().enumerate().find_map(|(rank, said)| Some((rank, said?)));
    failed.map_or(Ok(()), |(rank, (code, words))| Err(of_rank(rank, code, &words)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn launchers_are_recognised_by_size_and_rank() {
        /// Variables, and the rank and count that they tell.
        type Case<'a> = (&'a [(&'a str, &'a str)], Option<(usize, usize)>);
        let cases: [Case<'_>; 10] = [
            (&[], None),
            (&[("PMI_SIZE", "8"), ("PMI_RANK", "3")], Some((3, 8))),
            (&[("OMPI_COMM_WORLD_SIZE", "2"), ("OMPI_COMM_WORLD_RANK", "1")], Some((1, 2))),
            // srun with PMIx.
            (&[("SLURM_NTASKS", "2"), ("PMIX_RANK", "0")], Some((0, 2))),
            // A batch script or shell of Slurm, which has started nothing.
            (&[("SLURM_NTASKS", "64"), ("SLURM_PROCID", "0")], None),
            // mpirun of Open MPI inside a job of Slurm: its own count.
            (
                &[
                    ("SLURM_NTASKS", "64"),
                    ("PMIX_RANK", "1"),
                    ("OMPI_COMM_WORLD_SIZE", "4"),
                    ("OMPI_COMM_WORLD_RANK", "1"),
                ],
                Some((1, 4)),
            ),
            (&[("PMI_SIZE", "1"), ("PMI_RANK", "0")], None),
            (&[("SLURM_NTASKS", "1"), ("PMIX_RANK", "0")], None),
            (&[("PMIX_RANK", "0")], None),
            (&[("PMI_SIZE", "many"), ("PMI_RANK", "0")], None),
        ];
        for (variables, expected) in cases {
            let value = |name: &str| {
                variables.iter().find(|(known, _)| *known == name).map(|(_, value)| (*value).to_owned())
            };
            let found = launched(value).map(|place| (place.rank, place.count));
            assert_eq!(found, expected, "{variables:?}");
        }
    }
}
