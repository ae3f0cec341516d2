//! Distribution of a scene to ranks at the start.

use super::first::{FirstRank, RankThreads};
use super::orders::execute_orders;
use super::wire::RankOrder;
use super::worker::{PartStart, RankWorker, all_rows};
use crate::method::pairwise::search::PairSearch;
use crate::method::pairwise::state::Members;
use crate::method::pairwise::{CompiledDynamics, Crossings, Elapsed, PairEngine, PairSystem};
use crate::method::{Clock, DISMISSED, FailureKind, PhysicsFailure, rank_loss_failure};
use crate::particles::Particles;
use crate::ranks::{RankError, Ranks, local};
use std::collections::HashSet;
use std::sync::Arc;
use std::thread;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend::Precision;

/// A scene has fewer bands than there are ranks.
const TOO_MANY: FailureKind = FailureKind::new("too-many-ranks");

/// Data of a scene shared by all ranks, without its particles.
pub(super) struct RankedScene<S, P, Q> {
    pub(super) dynamics: Arc<dyn CompiledDynamics<S, P, Q>>,
    pub(super) system: PairSystem,
    pub(super) set: InstructionSet,
    pub(super) search: Q,
}

impl<S: Precision, P: Precision, Q: PairSearch<S, P> + 'static> RankedScene<S, P, Q> {
    pub(super) fn reject_too_many_ranks(&self, count: usize) -> Result<(), PhysicsFailure> {
        let bands = self.search.rows().bands().len();
        if count <= bands {
            return Ok(());
        }
        let what = format!("{count} ranks are more than the {bands} bands of rows that the scene has");
        let remedy = format!("use at most {bands} ranks, or more particles");
        Err(PhysicsFailure::new(TOO_MANY, what, remedy))
    }

    /// Builds the part of a rank at the start.
    pub(super) fn part(&self, ranks: Box<dyn Ranks>, start: Arc<Particles>) -> PartStart {
        let elapsed = Elapsed::new(self.system.dt, Crossings::new(self.system.followed, start.len()));
        let none = Members { numbers: vec![], moving: 0, grains: 0 };
        let search = self.search.emptied(0, all_rows(self.search.rows()));
        let all = (self.dynamics.clone(), self.system.clone(), self.set);
        let worker = RankWorker::new(ranks, PairEngine::of(all, search, start, none, elapsed))?;
        Ok(Box::new(worker))
    }

    /// Starts the other ranks on threads and returns the first rank.
    pub(super) fn on_threads(&self, count: usize, particles: Particles) -> Result<FirstRank, PhysicsFailure> {
        let start = Arc::new(particles);
        let per_rank = rayon::current_num_threads();
        let mut rest = local::ranks(count, per_rank);
        let first = Box::new(rest.remove(0));
        let mut threads = vec![];
        for ranks in rest {
            let search = self.search.emptied(0, all_rows(self.search.rows()));
            let RankedScene { dynamics, system, set, .. } = self;
            let scene = RankedScene { dynamics: dynamics.clone(), system: system.clone(), set: *set, search };
            let start = start.clone();
            // The first rank detects a loss itself.
            let work = move || _ = serve_one(scene.part(Box::new(ranks), start));
            let pool = rayon::ThreadPoolBuilder::new().num_threads(per_rank).build();
            let spawned = pool.map_err(|error| error.to_string()).and_then(|pool| {
                thread::Builder::new().spawn(move || pool.install(work)).map_err(|error| error.to_string())
            });
            threads.push(spawned.map_err(|error| {
                let what = format!("cannot start a thread for a rank: {error}");
                PhysicsFailure::new(TOO_MANY, what, "use fewer ranks or --threads")
            })?);
        }
        FirstRank::of(first, RankThreads(threads), |ranks| self.part(ranks, start))
    }

    /// Serves simulations on a process other than the first, one after the other, until the first ends it.
    pub(super) fn serve_process(&self, join: fn() -> Box<dyn Ranks>, particles: Particles) -> PhysicsFailure {
        loop {
            let ids: HashSet<u32> = match join().broadcast_message::<Option<Vec<u32>>>(None) {
                Ok(Some(ids)) => ids.into_iter().collect(),
                Ok(None) => return PhysicsFailure::new(DISMISSED, "this rank is dismissed", ""),
                Err(lost) => return rank_loss_failure(lost, Clock::default()),
            };
            let there = particles.all().iter().filter(|particle| ids.contains(&particle.id));
            let start = Particles::new(there.copied().collect());
            match serve_one(self.part(join(), Arc::new(start))) {
                // The first rank reports the reason.
                Ok(()) | Err(RankError::Ended(0)) => {}
                Err(lost) => return rank_loss_failure(lost, Clock::default()),
            }
        }
    }
}

/// Reports the start of a part to the first rank and follows its orders.
///
/// # Errors
/// As [`execute_orders`].
fn serve_one(part: PartStart) -> Result<(), RankError> {
    match part {
        Ok(part) => {
            part.ranks().gather_messages(None::<PhysicsFailure>)?;
            execute_orders(part)
        }
        Err((ranks, failure)) => {
            ranks.gather_messages(Some(failure))?;
            // Wait for the end announced by the first rank.
            ranks.broadcast_message::<Option<RankOrder>>(None).map(drop)
        }
    }
}
