//! Granular discs in the pairwise engine: the same physics as the programs, each pair met once, the law asked about contacts
//! only, corrector and next predictor in one pass. Equal to the programs but for rounding. Beside the lattice stand its
//! rivals, sectors and Verlet lists: the same state, law and integrator, and another way of finding contacts.

use super::Model;
use super::programs::{with_law, with_scheme};
use super::walls::walls_at;
use crate::grid::sectors_of;
use crate::method::Failure;
use crate::method::pairwise::search::{LatticeSearch, ListSearch, OnConflict, Search, SectorSearch};
use crate::method::pairwise::{self, Dynamics, Prescribed, Sort, Stepping, System, WithLaw, WithScheme};
use crate::particles::Particles;
use crate::scene::WallMotion;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::isa::Storage;
use stripmine_kernels::noise::NoiseSource;

/// How the fast engine finds contacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FastSearch {
    /// On the lattice with at most one disc a cell.
    Lattice(OnConflict),
    /// In sectors, which hold any number of discs.
    Sectors,
    /// In lists of near partners, made again whenever a disc has moved half the skin.
    Lists {
        /// How much farther than contact a listed pair may be (length).
        skin: f64,
    },
}

/// Lays out discs with state of precision `S` and forces of precision `P`. Which search they have is decided here, once.
///
/// # Errors
/// [`Failure`] if the start breaks a precondition already, or the box is none for sectors.
pub(super) fn stepping<S: Precision, P: Precision>(
    model: &Model,
    search: FastSearch,
    set: InstructionSet,
    walls: WallMotion,
    particles: Particles,
) -> Result<Box<dyn Stepping>, Failure> {
    let radii = particles.all().iter().map(|disc| disc.radius);
    let (discs, reach) = (particles.len(), reach(&particles));
    let single = S::NAME != f64::NAME || P::NAME != f64::NAME;
    let sectors = |skin: f64| sectors_of(&model.domain(), reach + skin, single, discs);
    match search {
        FastSearch::Lattice(on_conflict) => {
            let search = LatticeSearch::<P>::new::<S>(model.shape, model.frame, on_conflict, radii);
            by::<S, P, _>(model, search, set, walls, particles)
        }
        FastSearch::Sectors => {
            let search = SectorSearch::<P>::new::<S>(sectors(0.0)?, discs, reach);
            by::<S, P, _>(model, search, set, walls, particles)
        }
        FastSearch::Lists { skin } => {
            let search = ListSearch::<S, P>::new(sectors(skin)?, discs, reach, skin);
            by::<S, P, _>(model, search, set, walls, particles)
        }
    }
}

/// How far apart two discs may be and touch (length).
pub(super) fn reach(particles: &Particles) -> f64 {
    2.0 * particles.radii().map_or(1.0, |[_, largest]| largest)
}

/// The contact law and the integrator of a model, and the motion of its walls.
#[derive(Clone)]
struct Granular {
    model: Model,
    walls: WallMotion,
}

impl Dynamics for Granular {
    fn with_law<W: WithLaw>(&self, work: W) -> W::Output {
        with_law(&self.model, work)
    }

    fn with_scheme<W: WithScheme>(&self, work: W) -> W::Output {
        with_scheme(&self.model, work)
    }

    fn prescribed(&self, time: f64) -> Option<Prescribed> {
        (self.walls != WallMotion::Fixed).then(|| walls_at(self.walls, time))
    }
}

/// The same with a search.
fn by<S: Precision, P: Precision, Q: Search<S, P> + 'static>(
    model: &Model,
    search: Q,
    set: InstructionSet,
    walls: WallMotion,
    particles: Particles,
) -> Result<Box<dyn Stepping>, Failure> {
    let system = System {
        domain: model.domain(),
        dt: model.dt,
        gravity: model.gravity,
        freedoms: model.freedoms(),
        inertia: model.inertia(),
        inertia_factor: model.inertia_factor,
        radius: model.radius(),
        reach: reach(&particles),
        sort: Sort::WhenNeeded,
        longest_step: model.watch.map_or(f64::INFINITY, |watch| watch.longest_step()),
        crosses_any: false,
        followed: model.counts_crossings(),
        // None of these schemes draws random numbers.
        noise: NoiseSource::new(0),
    };
    let granular = Granular { model: model.clone(), walls };
    Ok(pairwise::begin::<S, P, Q, _>((granular, system, set), search, particles)?)
}
