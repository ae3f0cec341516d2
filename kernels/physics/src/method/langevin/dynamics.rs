//! Stepper of a scene, assembled from its pair law, integrator and search.

use super::checked::CheckedLangevin;
use super::chosen_search::ChosenSearch;
use super::laws::SweptLaw;
use super::options::{SchemeKind, SortKind};
use crate::domain::Domain;
use crate::method::pairwise::search::{LatticeSearch, ListSearch, OnConflict, PairSearch, SectorSearch};
use crate::method::pairwise::{
    Dynamics, LawTask, PairSystem, RemovableDiscs, SchemeTask, SortSchedule, begin,
};
use crate::method::{FailureKind, PhysicsFailure};
use crate::particles::Particles;
use crate::scene::Precision;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend;
use stripmine_kernels::integrator::Inertia;
use stripmine_kernels::integrator::langevin::{Baoab, Bath, Stochastic};

/// Dynamics of particles of one species in a bath.
#[derive(Clone, Debug)]
pub(super) struct BathDynamics {
    law: SweptLaw,
    scheme: SchemeKind,
    bath: Bath,
    dt: f64,
    mass: f64,
}

impl BathDynamics {
    /// Returns the dynamics of a checked scene.
    pub(super) fn of(checked: &CheckedLangevin) -> BathDynamics {
        let CheckedLangevin { scene, diameter, mass, .. } = checked;
        BathDynamics {
            law: scene.law_at(*diameter),
            scheme: scene.scheme,
            bath: scene.bath,
            dt: scene.dt,
            mass: *mass,
        }
    }
}

impl Dynamics for BathDynamics {
    fn with_law<W: LawTask>(&self, work: W) -> W::Output {
        self.law.clone().with(work)
    }

    fn with_scheme<W: SchemeTask>(&self, work: W) -> W::Output {
        let BathDynamics { scheme, bath, dt, mass, .. } = *self;
        match scheme {
            SchemeKind::Baoab => work.with(Baoab::new(bath, dt, mass)),
            SchemeKind::Stochastic => work.with(Stochastic::<false> { bath }),
            SchemeKind::AsPrinted => work.with(Stochastic::<true> { bath }),
        }
    }
}

/// Creates the stepper of all or some particles of a checked scene, at their start.
///
/// # Errors
/// [`PhysicsFailure`] if the start breaks a precondition, or the processor lacks the instructions.
pub(super) fn stepper(
    checked: &CheckedLangevin,
    particles: Particles,
    follows: bool,
) -> Result<Box<dyn RemovableDiscs>, PhysicsFailure> {
    match checked.scene.precision {
        Precision::F64 => of_precision::<f64, f64>(checked, particles, follows),
        Precision::F32 => of_precision::<f32, f32>(checked, particles, follows),
        Precision::Mixed => of_precision::<f64, f32>(checked, particles, follows),
    }
}

fn of_precision<S: backend::Precision, P: backend::Precision>(
    checked: &CheckedLangevin,
    particles: Particles,
    follows: bool,
) -> Result<Box<dyn RemovableDiscs>, PhysicsFailure> {
    let CheckedLangevin { scene, domain, mass, reach, found, .. } = checked;
    let (domain, mass, reach): (Domain, f64, f64) = (*domain, *mass, *reach);
    let dynamics = BathDynamics::of(checked);
    let system = PairSystem {
        domain,
        dt: scene.dt,
        gravity: [0.0; 2],
        freedoms: 2,
        inertia: Inertia::Equal { inverse_mass: 1.0 / mass, inverse_inertia: 0.0 },
        inertia_factor: 0.5,
        radius: Some(0.5 * reach),
        reach,
        sort: match scene.sort {
            SortKind::EveryStep => SortSchedule::EveryStep,
            SortKind::Auto | SortKind::WhenNeeded => SortSchedule::WhenNeeded,
        },
        longest_step: f64::INFINITY,
        // Without pair forces particles may cross any number of periods.
        crosses_any: !scene.law.has_pairs(),
        followed: [follows; 2],
        noise: checked.noise,
    };
    let count = particles.len();
    let set = scene.instructions();
    fn boxed<S: backend::Precision, P: backend::Precision, Q: PairSearch<S, P> + 'static>(
        (dynamics, system, set): (BathDynamics, PairSystem, InstructionSet),
        search: Q,
        particles: Particles,
    ) -> Result<Box<dyn RemovableDiscs>, PhysicsFailure> {
        begin::<S, P, Q, _>((dynamics, system, set), search, particles)
    }
    let all = (dynamics, system, set);
    match found.clone() {
        ChosenSearch::Lattice(shape, frame) => {
            // The cut-off is each particle's diameter on the lattice; particles nearer than that share a cell.
            let radii = std::iter::repeat_n(0.5 * reach, count);
            let search = LatticeSearch::<P>::new::<S>(shape, frame, OnConflict::Resolve, radii);
            boxed::<S, P, _>(all, search, particles)
        }
        ChosenSearch::Sectors(grid) => {
            boxed::<S, P, _>(all, SectorSearch::<P>::new::<S>(grid, count, reach), particles)
        }
        ChosenSearch::Lists(grid, skin) => {
            boxed::<S, P, _>(all, ListSearch::<S, P>::new(grid, count, reach, skin), particles)
        }
    }
}

/// True if a failure concerns ejected particles, so that a run may continue without them.
pub(super) fn is_loss(failure: &PhysicsFailure) -> bool {
    matches!(failure.kind, FailureKind::OUT_OF_BOX | FailureKind::NOT_FINITE)
}
