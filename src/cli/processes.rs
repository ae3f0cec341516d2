//! The processes that `mpiexec` has started, where it has: which one this is, and what the others do meanwhile.
//!
//! The first rank is the program that the user sees. The others read the same scene and do as it says, or runs of their own; they print nothing.

use crate::console::Failure;
use crate::study::StudyError;
use stripmine_physics::method::{DISMISSED, Failure as Broken, FailureKind};
use stripmine_physics::ranks::{self, Crew, Gone, Parcel, Ranks, dismiss, first_to_differ};

/// How launchers tell processes how many they are, and which one each is.
const SIZES: [&str; 2] = ["PMI_SIZE", "OMPI_COMM_WORLD_SIZE"];
const RANKS: [&str; 2] = ["PMI_RANK", "OMPI_COMM_WORLD_RANK"];

/// The first number that some variables of the environment hold.
fn of_launcher(names: [&str; 2]) -> Option<usize> {
    names.iter().find_map(|name| std::env::var(name).ok()?.parse().ok())
}

/// Whether this process speaks to the user: the first one, or the only one.
pub(super) fn is_first() -> bool {
    of_launcher(RANKS).is_none_or(|rank| rank == 0) || of_launcher(SIZES).is_none_or(|count| count < 2)
}
const PROCESSES: FailureKind = FailureKind::new("processes");

/// What ranks need to speak to each other; the program holds it to its end.
pub(super) struct Session {
    #[cfg(feature = "mpi")]
    _session: Option<stripmine_physics::ranks::mpi::Session>,
    crew: Crew,
}

impl Session {
    /// Joins the other processes, where there are some.
    ///
    /// # Errors
    /// [`Failure`] where there are some, and this program was built without MPI.
    pub(super) fn begin() -> Result<Session, Failure> {
        let count = of_launcher(SIZES).unwrap_or(1);
        if count < 2 {
            return Ok(Session {
                #[cfg(feature = "mpi")]
                _session: None,
                crew: Crew::One,
            });
        }
        #[cfg(feature = "mpi")]
        return Ok(Session {
            _session: stripmine_physics::ranks::mpi::Session::begin(),
            crew: Crew::Processes(stripmine_physics::ranks::mpi::world),
        });
        #[cfg(not(feature = "mpi"))]
        Err(broken(
            format!("this is one of {count} processes, but the program was built without MPI"),
            "build it with: cargo build --release --features mpi; or take ranks that are threads: run --ranks",
        ))
    }

    /// By whom simulations are carried out.
    pub(super) fn crew(&self) -> Crew {
        self.crew
    }
}

fn broken(what: String, remedy: &str) -> Failure {
    StudyError::Own(Box::new(Broken::new(PROCESSES, what, remedy))).into()
}

/// A rank has ended.
pub(super) fn gone(gone: Gone) -> Failure {
    broken(gone.to_string(), "see what it said last")
}

/// What a rank says that went wrong.
pub(super) fn of_rank(rank: usize, said: &str) -> Failure {
    broken(format!("rank {rank}: {said}"), "see what it says")
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
    // Where its part has not begun, for what is refused on all ranks, it still waits for the end.
    if !matches!(ranks::over(crew, start), Err(failure) if failure.kind == DISMISSED) {
        ranks::wait(join().as_ref());
    }
}

/// What all processes do: the same on each, or nothing where they do not say the same of it (scene and program). The first rank does `first`, which may begin
/// simulations on all of them, the others `serve`, which takes their part in these.
///
/// # Errors
/// [`Failure`] of the rank itself, or that says which rank differs.
pub(super) fn together(
    join: fn() -> Box<dyn Ranks>,
    same: &str,
    first: impl FnOnce() -> Result<(), Failure>,
    serve: impl FnOnce(),
) -> Result<(), Failure> {
    let ranks = join();
    if let Some(rank) = first_to_differ(ranks.as_ref(), same).map_err(gone)? {
        let what =
            format!("rank {rank} has another scene, or is another version of the program, than rank 0");
        return Err(broken(what, "give all ranks the same files and the same program"));
    }
    if ranks.rank() == 0 {
        let outcome = first();
        dismiss(ranks.as_ref()).map_err(gone)?;
        return outcome;
    }
    serve();
    Ok(())
}

/// Work that ranks do on their own, each every so-many-th piece of it; the first failure, on the first rank once all have ended.
///
/// # Errors
/// The rank's own failure; on the first rank that of another one.
pub(super) fn apart(
    join: fn() -> Box<dyn Ranks>,
    mut work: impl FnMut(usize, usize) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let ranks = join();
    let outcome = work(ranks.rank(), ranks.count());
    let mut said = Parcel::new();
    said.text(&outcome.as_ref().err().map_or(String::new(), ToString::to_string));
    let all = ranks.gather(said).map_err(gone)?;
    outcome?;
    let failed = all.iter().map(|parcel| parcel.read().text()).enumerate().find(|(_, said)| !said.is_empty());
    match failed {
        Some((rank, said)) => Err(of_rank(rank, &said)),
        None => Ok(()),
    }
}
