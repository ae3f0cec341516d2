//! A scene that is dealt out to ranks: who begins with what.

use super::first::Ranked;
use super::wire::put_failure;
use super::worker::{Part, Worker, all_rows};
use crate::method::pairwise::search::Search;
use crate::method::pairwise::state::Members;
use crate::method::pairwise::{Crossings, Dynamics, Elapsed, Engine, System};
use crate::method::{DISMISSED, Failure, FailureKind};
use crate::particles::Particles;
use crate::ranks::{Parcel, Ranks, local};
use std::collections::HashSet;
use std::sync::Arc;
use std::thread;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend::Precision;

/// A scene has fewer bands than there are ranks.
const TOO_MANY: FailureKind = FailureKind::new("too-many-ranks");

/// What every rank knows of a scene but its particles.
pub(super) struct Scene<Q, D> {
    pub(super) dynamics: D,
    pub(super) system: System,
    pub(super) set: InstructionSet,
    pub(super) search: Q,
}

impl<Q, D: Dynamics + Clone + 'static> Scene<Q, D> {
    pub(super) fn refuse_too_many<S: Precision, P: Precision>(&self, count: usize) -> Result<(), Failure>
    where
        Q: Search<S, P>,
    {
        let bands = self.search.rows().bands().len();
        if count <= bands {
            return Ok(());
        }
        let what = format!("{count} ranks are more than the {bands} bands of rows that the scene has");
        let remedy = format!("take at most {bands} ranks, or more particles");
        Err(Failure::new(TOO_MANY, what, remedy))
    }

    /// The part of a rank at the start.
    pub(super) fn part<S: Precision, P: Precision>(
        &self,
        ranks: Box<dyn Ranks>,
        start: Arc<Particles>,
    ) -> Part<S, P, Q, D>
    where
        Q: Search<S, P>,
    {
        let elapsed = Elapsed::new(self.system.dt, Crossings::new(self.system.followed, start.len()));
        let none = Members { numbers: vec![], moving: 0, grains: 0 };
        let search = self.search.emptied(0, all_rows(self.search.rows()));
        let all = (self.dynamics.clone(), self.system.clone(), self.set);
        Worker::new(ranks, Engine::of(all, search, start, none, elapsed))
    }

    /// The first rank of several threads; the others begin.
    pub(super) fn on_threads<S: Precision, P: Precision>(
        &self,
        count: usize,
        particles: Particles,
    ) -> Result<Ranked<S, P, Q, D>, Failure>
    where
        Q: Search<S, P> + 'static,
    {
        let start = Arc::new(particles);
        let per_rank = rayon::current_num_threads();
        let mut rest = local::ranks(count, per_rank);
        let first = Box::new(rest.remove(0));
        let mut threads = vec![];
        for ranks in rest {
            let search = self.search.emptied(0, all_rows(self.search.rows()));
            let Scene { dynamics, system, set, .. } = self;
            let scene = Scene { dynamics: dynamics.clone(), system: system.clone(), set: *set, search };
            let start = start.clone();
            let work = move || serve_one(scene.part::<S, P>(Box::new(ranks), start));
            let pool = rayon::ThreadPoolBuilder::new().num_threads(per_rank).build();
            let spawned = pool.map_err(|error| error.to_string()).and_then(|pool| {
                thread::Builder::new().spawn(move || pool.install(work)).map_err(|error| error.to_string())
            });
            threads.push(spawned.map_err(|error| {
                let what = format!("no thread can be had for a rank: {error}");
                Failure::new(TOO_MANY, what, "take fewer ranks or --threads")
            })?);
        }
        Ranked::of(first, threads, |ranks| self.part(ranks, start))
    }

    /// The part of a process that is not the first, for one simulation after the other, until the first says that there is no other.
    pub(super) fn serve<S: Precision, P: Precision>(
        &self,
        join: fn() -> Box<dyn Ranks>,
        particles: Particles,
    ) -> Failure
    where
        Q: Search<S, P>,
    {
        while let Ok(parcel) = join().tell(None) {
            let mut reader = parcel.read();
            if reader.count() == 0 {
                break;
            }
            let ids: HashSet<u64> = reader.counts().into_iter().collect();
            let there = particles.all().iter().filter(|particle| ids.contains(&particle.id.into()));
            let start = Particles::new(there.copied().collect());
            serve_one(self.part::<S, P>(join(), Arc::new(start)));
        }
        Failure::new(DISMISSED, "this rank is dismissed", "")
    }
}

/// Says how a part has begun, and does what the first rank says.
fn serve_one<S: Precision, P: Precision, Q: Search<S, P>, D: Dynamics>(part: Part<S, P, Q, D>) {
    let mut begun = Parcel::new();
    match part {
        Ok(worker) => {
            put_failure(None, &mut begun);
            if worker.ranks.gather(begun).is_ok() {
                worker.serve();
            }
        }
        Err((ranks, failure)) => {
            put_failure(Some(&failure), &mut begun);
            // Where the first rank has ended there is no one to hear it; else it says that this is the end.
            if ranks.gather(begun).is_ok() {
                let _ = ranks.tell(None);
            }
        }
    }
}
