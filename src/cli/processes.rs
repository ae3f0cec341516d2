//! Processes started by `mpiexec`: the rank of this one, and the work of the others.
//!
//! The first rank prints. The others read the same scene, follow the first rank or make their share of the runs, and print nothing.

mod agreement;
#[cfg(any(test, feature = "mpi"))]
mod joining;

#[cfg(feature = "mpi")]
use crate::console::warn;
use crate::console::{CommandFailure, report_failure};
use crate::laboratory::rates::VERB as MEASURE;
use crate::study::StudyError;
use agreement::{JointVerdict, ProcessState, exchange_states};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use stripmine_physics::method::{DISMISSED, FailureKind, PhysicsFailure as Broken, RANK_ENDED};
use stripmine_physics::ranks::{self, RankBackend, RankError, Ranks, dismiss, is_dismissed};
use stripmine_physics::reported::ErrorClass;

/// Environment variables in which a launcher stores the number of processes and the rank.
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

/// Verbs that start no joint simulation. Each process runs them independently under any launcher.
const ALONE: [&str; 6] = ["scene", "average", "plot", "completions", "man", MEASURE];

/// One of several processes started by a launcher.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct LaunchedProcess {
    rank: usize,
    count: usize,
    /// Variable that holds the rank.
    variable: &'static str,
}

/// Rank of this process, from the environment; none if it is the only one.
fn launched_process(variable: impl Fn(&str) -> Option<String>) -> Option<LaunchedProcess> {
    let number = |name: &str| variable(name)?.trim().parse::<usize>().ok();
    LAUNCHERS.iter().find_map(|launcher| {
        let (count, rank) = (number(launcher.size)?, number(launcher.rank)?);
        (count > 1).then_some(LaunchedProcess { rank, count, variable: launcher.rank })
    })
}

fn own_process() -> Option<LaunchedProcess> {
    launched_process(|name| std::env::var(name).ok())
}

/// Returns true if this process prints errors: the first one, the only one, or any that works independently.
pub(super) fn prints_errors(verb: &str) -> bool {
    ALONE.contains(&verb) || own_process().is_none_or(|place| place.rank == 0)
}

const PROCESSES: FailureKind = FailureKind::new("processes");

/// Session of messages between ranks, open until the program ends.
pub(super) struct ProcessSession {
    #[cfg(feature = "mpi")]
    _session: Option<stripmine_physics::ranks::mpi::MpiSession>,
    crew: RankBackend,
}

impl ProcessSession {
    /// Joins the other processes, if there are any and the verb has work for them.
    ///
    /// # Errors
    /// [`CommandFailure`] if there are any and this program was built without MPI.
    pub(super) fn begin(verb: &str) -> Result<ProcessSession, CommandFailure> {
        let Some(place) = own_process().filter(|_| !ALONE.contains(&verb)) else {
            return Ok(ProcessSession {
                #[cfg(feature = "mpi")]
                _session: None,
                crew: RankBackend::One,
            });
        };
        #[cfg(feature = "mpi")]
        return Ok(ProcessSession {
            _session: joining::with_timeouts(
                stripmine_physics::ranks::mpi::MpiSession::begin,
                waiting(place),
            ),
            crew: RankBackend::Processes(stripmine_physics::ranks::mpi::world),
        });
        #[cfg(not(feature = "mpi"))]
        Err(without_mpi(place))
    }

    /// Crew that runs simulations.
    pub(super) fn crew(&self) -> RankBackend {
        self.crew
    }

    /// Outcome of this process, shared with all others. A process that could not begin ends all of them, so that none waits for it.
    pub(super) fn shared_outcome(&self, outcome: Result<(), CommandFailure>) -> Result<(), CommandFailure> {
        let RankBackend::Processes(join) = self.crew else { return outcome };
        let part = match &outcome {
            Err(failure) if failure.exit_code() != 0 => ProcessState::refused(failure),
            _ => ProcessState::Finished,
        };
        match first_exchange(join().as_ref(), part)? {
            JointVerdict::Own => outcome,
            JointVerdict::Failed(failure) => Err(failure),
        }
    }
}

impl Drop for ProcessSession {
    fn drop(&mut self) {
        // MPI would deadlock: it waits for the others, and they wait for this process.
        if thread::panicking() && matches!(self.crew, RankBackend::Processes(_)) {
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

/// Set by the first exchange, which comes once and before any other message.
static HAVE_MET: AtomicBool = AtomicBool::new(false);

/// Returns true once all processes have begun, or ended, together.
pub(super) fn has_exchanged() -> bool {
    HAVE_MET.load(Ordering::SeqCst)
}

/// Verdict on all processes from the first exchange; later calls return `Own`.
fn first_exchange(ranks: &dyn Ranks, part: ProcessState) -> Result<JointVerdict, CommandFailure> {
    if HAVE_MET.swap(true, Ordering::SeqCst) {
        return Ok(JointVerdict::Own);
    }
    exchange_states(ranks, part).map_err(lost_rank_failure)
}

/// Begins joint work if every process can begin and has the same `same`. Each process calls this before its first message.
///
/// # Errors
/// [`CommandFailure`] on all processes, naming the rank that cannot begin or does something else.
pub(super) fn begin(ranks: &dyn Ranks, same: &str) -> Result<(), CommandFailure> {
    match first_exchange(ranks, ProcessState::Begins(same.to_owned()))? {
        JointVerdict::Own => Ok(()),
        JointVerdict::Failed(failure) => Err(failure),
    }
}

/// Time to wait for other processes before a notice, and further time before this process ends (s).
#[cfg(feature = "mpi")]
const PATIENCE: [u64; 2] = [20, 280];

/// Actions while waiting for others to join: ranks 0 and 1 print a notice, since either may be the missing one; all end after the limit.
#[cfg(feature = "mpi")]
fn waiting(
    LaunchedProcess { rank, count, .. }: LaunchedProcess,
) -> Vec<(std::time::Duration, joining::TimedAction)> {
    let [notice, end] = PATIENCE;
    let words = move |seconds: u64| {
        format!("rank {rank} of {count} has waited {seconds} s for processes that have not joined")
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
        let failure = process_failure(words(notice + end), &remedy);
        if says {
            report_failure(&failure, false);
        }
        std::process::exit(failure.exit_code().into());
    };
    let seconds = std::time::Duration::from_secs;
    let acts: [(std::time::Duration, joining::TimedAction); 2] =
        [(seconds(notice), Box::new(warns)), (seconds(end), Box::new(ends))];
    acts.into()
}

#[cfg(not(feature = "mpi"))]
fn without_mpi(LaunchedProcess { count, variable, .. }: LaunchedProcess) -> CommandFailure {
    let what = format!(
        "this is one of {count} processes ({variable} is set), but this program was built without MPI"
    );
    let remedy = format!(
        "build it with cargo build --release --features mpi, or use threads as ranks (run --ranks), or unset {variable} \
         if each process works independently"
    );
    process_failure(what, &remedy)
}

fn process_failure(what: String, remedy: &str) -> CommandFailure {
    StudyError::Own(Box::new(Broken::new(PROCESSES, what, remedy))).into()
}

/// Failure for a lost rank.
pub(super) fn lost_rank_failure(lost: RankError) -> CommandFailure {
    process_failure(lost.to_string(), "see its last message")
}

/// Failure of another rank, with its exit code and message.
pub(super) fn rank_failure(rank: usize, code: u8, said: &str) -> CommandFailure {
    CommandFailure::OfProcess {
        process: format!("rank {rank}"),
        class: ErrorClass::of_exit_code(code),
        said: said.to_owned(),
    }
}

/// Rank of this process; 0 if it is the only one.
pub(super) fn rank(crew: RankBackend) -> usize {
    if let RankBackend::Processes(join) = crew { join().rank() } else { 0 }
}

/// Failure for ranks requested both as threads and as processes.
pub(super) fn duplicate_ranks_failure() -> CommandFailure {
    let what = "--ranks was given, but this is already one of several processes".to_owned();
    process_failure(what, "use --ranks without mpiexec, or mpiexec -n without --ranks")
}

/// Serves simulations begun by `start` on a rank other than the first, until the first dismisses it.
pub(super) fn serve(crew: RankBackend, start: impl FnOnce() -> Result<(), Broken>) {
    let RankBackend::Processes(join) = crew else { return };
    let Err(failure) = ranks::with_backend(crew, start) else { return };
    // If the first rank has begun nothing, it failed for the same reason and reports it. Otherwise it waits for this rank; so do
    // others, if this rank lost one of them in the middle of a step.
    let is_waited_for = match failure.kind {
        DISMISSED => false,
        RANK_ENDED => true,
        _ => !is_dismissed(join().as_ref()),
    };
    if is_waited_for {
        let failure = CommandFailure::from(StudyError::Own(Box::new(failure)));
        let code = failure.exit_code();
        report_failure(&rank_failure(join().rank(), code, &failure.message_text()), false);
        abort(code);
    }
}

/// Runs joint work on all processes. `work` receives true on the first rank, which may begin simulations on all of them.
///
/// # Errors
/// [`CommandFailure`] of the rank itself, or of [`begin`] if scenes or programs differ.
pub(super) fn run_jointly(
    join: fn() -> Box<dyn Ranks>,
    same: &str,
    work: impl FnOnce(bool) -> Result<(), CommandFailure>,
) -> Result<(), CommandFailure> {
    let ranks = join();
    begin(ranks.as_ref(), same)?;
    let is_first = ranks.rank() == 0;
    let outcome = work(is_first);
    if is_first {
        dismiss(ranks.as_ref()).map_err(lost_rank_failure)?;
    }
    outcome
}

/// Runs independent pieces of work, distributed over the ranks in turn. The first rank returns the first failure once all have ended.
///
/// # Errors
/// The rank's own failure; on the first rank also that of another; or that of [`begin`].
pub(super) fn run_independently(
    join: fn() -> Box<dyn Ranks>,
    same: &str,
    mut work: impl FnMut(usize, usize) -> Result<(), CommandFailure>,
) -> Result<(), CommandFailure> {
    let ranks = join();
    begin(ranks.as_ref(), same)?;
    let outcome = work(ranks.rank(), ranks.count());
    let said = outcome.as_ref().err().map(|failure| (failure.exit_code(), failure.message_text()));
    let all = ranks.gather_messages(said).map_err(lost_rank_failure)?;
    outcome?;
    let failed = all.into_iter().enumerate().find_map(|(rank, said)| Some((rank, said?)));
    failed.map_or(Ok(()), |(rank, (code, words))| Err(rank_failure(rank, code, &words)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn launchers_are_recognised_by_size_and_rank() {
        /// Variables, and the rank and count they encode.
        type Case<'a> = (&'a [(&'a str, &'a str)], Option<(usize, usize)>);
        let cases: [Case<'_>; 10] = [
            (&[], None),
            (&[("PMI_SIZE", "8"), ("PMI_RANK", "3")], Some((3, 8))),
            (&[("OMPI_COMM_WORLD_SIZE", "2"), ("OMPI_COMM_WORLD_RANK", "1")], Some((1, 2))),
            // srun with PMIx.
            (&[("SLURM_NTASKS", "2"), ("PMIX_RANK", "0")], Some((0, 2))),
            // A batch script or shell of Slurm, without srun.
            (&[("SLURM_NTASKS", "64"), ("SLURM_PROCID", "0")], None),
            // mpirun of Open MPI inside a Slurm job has its own count.
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
            let found = launched_process(value).map(|place| (place.rank, place.count));
            assert_eq!(found, expected, "{variables:?}");
        }
    }
}
