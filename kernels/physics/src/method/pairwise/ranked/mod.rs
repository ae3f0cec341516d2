//! Several ranks step the discs of one scene, each owning some bands of rows.
//!
//! ```text
//! the first rank    is the simulation that all other code uses; broadcasts orders and adds up in the order of bands
//! the others        execute orders until the simulation ends
//!
//! a step:  advance | halo: neighbours' discs | cells or lists | report | forces of the own bands | report
//! ```
//!
//! Results equal those of one rank to the bit. Bands are a function of the scene, and each is swept whole by the rank that owns it. Forces on its
//! discs from the band below are computed again by that rank, pair by pair, instead of being received as a sum. The assignment of bands changes no
//! bit.

mod distribution;
mod first;
mod layout;
mod orders;
mod shares;
mod wire;
mod worker;

use super::search::PairSearch;
use super::{CompiledDynamics, Dynamics, PairEngine, PairSystem, RemovableDiscs};
use crate::method::{Clock, PhysicsFailure, rank_loss_failure};
use crate::particles::Particles;
use crate::ranks::{self, RankBackend};
use first::{FirstRank, RankThreads};
use shares::RankedScene;
use std::sync::Arc;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend::Precision;

/// Starts stepping discs on as many ranks as [`ranks::current_backend`] has: with a [`PairEngine`] alone, or with several.
///
/// # Errors
/// As [`PairEngine::new`], or if the scene has fewer bands than there are ranks.
pub(crate) fn begin<S, P, Q, D>(
    (dynamics, system, set): (D, PairSystem, InstructionSet),
    search: Q,
    particles: Particles,
) -> Result<Box<dyn RemovableDiscs>, PhysicsFailure>
where
    S: Precision,
    P: Precision,
    Q: PairSearch<S, P> + 'static,
    D: Dynamics + 'static,
{
    let dynamics: Arc<dyn CompiledDynamics<S, P, Q>> = Arc::new(dynamics);
    let crew = ranks::current_backend();
    if crew.count() == 1 {
        return Ok(Box::new(PairEngine::new(dynamics, system, search, set, particles)?));
    }
    let scene = RankedScene { dynamics, system, set, search };
    scene.reject_too_many_ranks(crew.count())?;
    let stepping: Box<dyn RemovableDiscs> = match crew {
        RankBackend::Processes(join) if join().rank() > 0 => return Err(scene.serve_process(join, particles)),
        RankBackend::Processes(join) => {
            let ranks = join();
            let ids: Vec<u32> = particles.all().iter().map(|particle| particle.id).collect();
            let told = ranks.broadcast_message(Some(Some(ids)));
            told.map_err(|lost| rank_loss_failure(lost, Clock::default()))?;
            Box::new(FirstRank::of(ranks, RankThreads(vec![]), |ranks| {
                scene.part(ranks, Arc::new(particles))
            })?)
        }
        RankBackend::One | RankBackend::Threads(_) => Box::new(scene.on_threads(crew.count(), particles)?),
    };
    Ok(stepping)
}
