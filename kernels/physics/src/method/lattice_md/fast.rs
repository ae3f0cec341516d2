//! Granular discs in the pairwise engine: the same physics as the programs, each pair met once, the law asked about contacts
//! only, corrector and next predictor in one pass. Equal to the programs but for rounding. Beside the lattice stand its
//! rivals, sectors and Verlet lists: the same state, law and integrator, and another way of finding contacts.

use super::balance::Way;
use super::judge::{judge_depth, judge_steps};
use super::programs::{with_law, with_scheme};
use super::walls::{wall_power, walls_at};
use super::{Engine, Lengths, Model, Totals};
use crate::grid::sectors_of;
use crate::io::checkpoint::Column;
use crate::method::Failure;
use crate::method::pairwise::search::{LatticeSearch, ListSearch, OnConflict, Search, SectorSearch};
use crate::method::pairwise::{
    self, Dynamics, Elapsed, Prescribed, Sort, Stepping, System, WithLaw, WithScheme,
};
use crate::observe::{Scenery, Sums};
use crate::particles::{Particles, States};
use crate::scene::WallMotion;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::isa::Storage;
use stripmine_kernels::ledger::{Ledger, Length};
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

/// Begins a fast simulation with state of precision `S` and forces of precision `P`. Which search it has is decided here,
/// once.
///
/// # Errors
/// [`Failure`] if the start breaks a precondition already, or the box is none for sectors.
pub(super) fn start<S: Precision, P: Precision>(
    model: Model,
    search: FastSearch,
    set: InstructionSet,
    walls: WallMotion,
    particles: Particles,
) -> Result<Box<dyn Engine>, Failure> {
    let radii = particles.all().iter().map(|disc| disc.radius);
    let (discs, reach) = (particles.len(), reach(&particles));
    let single = S::NAME != f64::NAME || P::NAME != f64::NAME;
    let sectors = |skin: f64| sectors_of(&model.domain(), reach + skin, single, discs);
    let stepping = match search {
        FastSearch::Lattice(on_conflict) => {
            let search = LatticeSearch::<P>::new::<S>(model.shape, model.frame, on_conflict, radii);
            stepping::<S, P, _>(&model, search, set, walls, particles)?
        }
        FastSearch::Sectors => {
            let search = SectorSearch::<P>::new::<S>(sectors(0.0)?, discs, reach);
            stepping::<S, P, _>(&model, search, set, walls, particles)?
        }
        FastSearch::Lists { skin } => {
            let search = ListSearch::<S, P>::new(sectors(skin)?, discs, reach, skin);
            stepping::<S, P, _>(&model, search, set, walls, particles)?
        }
    };
    Ok(Box::new(FastMd::new(stepping, model, walls)?))
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

/// The engine for a search.
fn stepping<S: Precision, P: Precision, Q: Search<S, P> + 'static>(
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
    pairwise::begin::<S, P, Q, _>((granular, system, set), search, particles)
}

/// A fast simulation.
struct FastMd {
    stepping: Box<dyn Stepping>,
    model: Model,
    walls: WallMotion,
    totals: Totals,
    /// Pairs met in the last step.
    met: u64,
}

impl FastMd {
    /// Finds the first forces.
    ///
    /// # Errors
    /// [`Failure`] if the start breaks a precondition already.
    fn new(stepping: Box<dyn Stepping>, model: Model, walls: WallMotion) -> Result<Self, Failure> {
        let mut simulation = FastMd { stepping, model, walls, totals: Totals::default(), met: 0 };
        let power = simulation.compute_forces()?;
        simulation.totals = Totals::starting_with(power, simulation.wall_power());
        Ok(simulation)
    }

    /// All forces of the positions as they stand; gives what contacts dissipate (energy/time).
    fn compute_forces(&mut self) -> Result<f64, Failure> {
        let met = self.stepping.compute_forces(self.model.asked())?;
        self.met = met.pairs;
        let deep = met.deep.iter().map(|pair| pair.map(|disc| disc as usize));
        judge_depth(self.stepping.as_ref(), deep, self.model.watch, &mut self.totals)?;
        Ok(met.dissipated)
    }

    /// What moving walls put in (energy/time).
    fn wall_power(&self) -> f64 {
        wall_power(&self.model, self.walls, self.time(), self.stepping.grain_count(), || {
            self.stepping.forces()
        })
    }
}

impl Engine for FastMd {
    fn step(&mut self) -> Result<(), Failure> {
        let far = self.stepping.advance()?;
        let far = far.into_iter().map(|disc| disc as usize);
        judge_steps(self.stepping.as_ref(), far, self.model.watch, &mut self.totals)?;
        self.totals.shared_cells += self.stepping.shared_cells() as u64;
        let power = self.compute_forces()?;
        self.totals.add_work(self.model.dt, power, self.wall_power());
        Ok(())
    }

    fn elapsed(&self) -> &Elapsed {
        self.stepping.elapsed()
    }

    fn elapsed_mut(&mut self) -> &mut Elapsed {
        self.stepping.elapsed_mut()
    }

    fn particles(&self) -> Particles {
        self.stepping.particles()
    }

    fn states(&self, states: &mut States) {
        self.stepping.states(states);
    }

    fn positions(&self) -> Vec<[f32; 3]> {
        self.stepping.positions()
    }

    fn images(&self) -> Vec<[i32; 2]> {
        self.stepping.images()
    }

    fn unwrapped(&self) -> Particles {
        self.stepping.unwrapped()
    }

    fn sums(&self, scenery: &Scenery, way: &Way) -> Sums {
        let crossings = self.crossings();
        self.stepping.sums(scenery, &|number, grain, position| way.work(number, grain, position, crossings))
    }

    fn forces(&self) -> Vec<[f64; 3]> {
        self.stepping.forces()
    }

    fn totals(&self) -> Totals {
        self.totals
    }

    fn state(&self) -> Vec<(String, Column)> {
        self.stepping.columns()
    }

    fn restore(&mut self, steps: u64, totals: Totals, columns: Vec<(String, Column)>) -> Result<(), String> {
        self.stepping.restore(steps, &columns)?;
        self.totals = totals;
        Ok(())
    }

    fn ledger(&self) -> Ledger {
        // Its work depends on the data, contact by contact: no fixed program to count.
        Ledger::default()
    }

    fn length(&self, length: Length) -> u64 {
        match length {
            Length::Pairs => self.met,
            _ => {
                let [grains, discs] = [self.stepping.grain_count(), self.stepping.discs()];
                Lengths::new(&self.model, grains, discs).range(length).len() as u64
            }
        }
    }

    fn lists(&self) -> Option<(usize, u64)> {
        self.stepping.lists()
    }
}
