//! Granular discs in the pairwise engine. The physics equals that of the programs up to rounding, but each pair is visited once, the law is evaluated
//! for contacts only, and corrector and next predictor share one pass. Alternatives to the lattice are sectors and Verlet lists, with the same state,
//! law and integrator.

use super::GranularModel;
use super::programs::{with_law, with_scheme};
use super::wall_law::with_wall_law;
use super::walls::walls_at;
use crate::grid::sectors_of;
use crate::method::PhysicsFailure;
use crate::method::pairwise::search::{LatticeSearch, ListSearch, OnConflict, PairSearch, SectorSearch};
use crate::method::pairwise::{
    self, Dynamics, LawTask, PairSystem, PlaneWalls, PrescribedMotion, SchemeTask, SortSchedule,
    SteppingDiscs,
};
use crate::particles::Particles;
use crate::scene::WallMotion;
use std::sync::Arc;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::isa::Storage;
use stripmine_kernels::noise::NoiseSource;

/// Contact search of the fast engine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FastSearch {
    /// On the lattice with at most one disc a cell.
    Lattice(OnConflict),
    /// In sectors, which hold any number of discs.
    Sectors,
    /// In lists of near partners, rebuilt whenever a disc has moved half the skin.
    Lists {
        /// Largest gap of a listed pair (length).
        skin: f64,
    },
}

/// Places discs with state of precision `S` and forces of precision `P`, and chooses the search once.
///
/// # Errors
/// [`PhysicsFailure`] if the start violates a precondition, or the box does not suit sectors.
pub(super) fn stepping<S: Precision, P: Precision>(
    model: &GranularModel,
    search: FastSearch,
    set: InstructionSet,
    walls: WallMotion,
    particles: Particles,
) -> Result<Box<dyn SteppingDiscs>, PhysicsFailure> {
    let radii = particles.all().iter().map(|disc| disc.radius);
    let (discs, reach) = (particles.len(), reach(&particles));
    let single = S::NAME != f64::NAME || P::NAME != f64::NAME;
    let sectors = |skin: f64| sectors_of(&model.domain(), reach + skin, single, discs);
    match search {
        FastSearch::Lattice(on_conflict) => {
            let search = LatticeSearch::<P>::new::<S>(model.shape, model.frame, on_conflict, radii);
            stepping_with::<S, P, _>(model, search, set, walls, particles)
        }
        FastSearch::Sectors => {
            let search = SectorSearch::<P>::new::<S>(sectors(0.0)?, discs, reach);
            stepping_with::<S, P, _>(model, search, set, walls, particles)
        }
        FastSearch::Lists { skin } => {
            let search = ListSearch::<S, P>::new(sectors(skin)?, discs, reach, skin);
            stepping_with::<S, P, _>(model, search, set, walls, particles)
        }
    }
}

/// Largest distance of two touching discs (length).
pub(super) fn reach(particles: &Particles) -> f64 {
    2.0 * particles.radii().map_or(1.0, |[_, largest]| largest)
}

/// Contact law and integrator of a model, and motion of its walls.
#[derive(Clone)]
struct GranularDynamics {
    model: GranularModel,
    walls: WallMotion,
}

impl Dynamics for GranularDynamics {
    fn with_law<W: LawTask>(&self, work: W) -> W::Output {
        with_law(&self.model, work)
    }

    fn with_scheme<W: SchemeTask>(&self, work: W) -> W::Output {
        with_scheme(&self.model, work)
    }

    fn prescribed(&self, time: f64) -> Option<PrescribedMotion> {
        (self.walls != WallMotion::Fixed).then(|| walls_at(self.walls, time))
    }

    fn walls(&self) -> Option<&Arc<PlaneWalls>> {
        Some(&self.model.walls).filter(|walls| !walls.is_empty())
    }

    fn with_wall_law<W: LawTask>(&self, work: W) -> Option<W::Output> {
        Some(with_wall_law(self.model.wall_law(), work))
    }
}

/// Places the discs with a given search.
fn stepping_with<S: Precision, P: Precision, Q: PairSearch<S, P> + 'static>(
    model: &GranularModel,
    search: Q,
    set: InstructionSet,
    walls: WallMotion,
    particles: Particles,
) -> Result<Box<dyn SteppingDiscs>, PhysicsFailure> {
    let system = PairSystem {
        domain: model.domain(),
        dt: model.dt,
        gravity: model.gravity,
        freedoms: model.freedoms(),
        inertia: model.inertia(),
        inertia_factor: model.inertia_factor,
        radius: model.radius(),
        reach: reach(&particles),
        sort: SortSchedule::WhenNeeded,
        longest_step: model.watch.map_or(f64::INFINITY, |watch| watch.longest_step()),
        crosses_any: false,
        followed: model.counts_crossings(),
        // None of these schemes draws random numbers.
        noise: NoiseSource::new(0),
    };
    let granular = GranularDynamics { model: model.clone(), walls };
    Ok(pairwise::begin::<S, P, Q, _>((granular, system, set), search, particles)?)
}
