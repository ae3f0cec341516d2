//! The lattice method in its fast execution: the same physics, each pair met once, the law asked about contacts only,
//! corrector and next predictor in one pass. Equal to the other executions but for rounding. Beside the lattice stand
//! its rivals, sectors and Verlet lists: the same state, law and integrator, and another way of finding contacts.

mod failures;
mod search;
mod state;
mod steps;

use super::crossings::Crossings;
use super::programs::{WithLaw, with_law};
use super::walls::walls_at;
use super::{Engine, Phase, Timings, Totals};
use super::{Model, Scheme};
use crate::grid::sectors_of;
use crate::io::checkpoint::Column;
use crate::method::Failure;
use crate::particles::Particles;
use crate::scene::WallMotion;
pub use search::OnConflict;
use search::{LatticeSearch, ListSearch, Search, SectorSearch};
use state::{Move, State};
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::isa::{ProgramError, Storage};
use stripmine_kernels::keep_awake;
use stripmine_kernels::law::Law;
use stripmine_kernels::ledger::{Ledger, Length};
use stripmine_kernels::sweep::fast::Met;

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
    let (discs, reach) = (particles.len(), 2.0 * particles.radii().map_or(1.0, |[_, largest]| largest));
    let single = S::NAME != f64::NAME || P::NAME != f64::NAME;
    let sectors = |skin: f64| sectors_of(&model.domain(), reach + skin, single, discs);
    Ok(match search {
        FastSearch::Lattice(on_conflict) => {
            let search = LatticeSearch::<P>::new::<S>(model.shape, model.frame, on_conflict, radii);
            Box::new(FastMd::<S, P, _>::new(model, search, set, walls, particles)?)
        }
        FastSearch::Sectors => {
            let search = SectorSearch::<P>::new::<S>(sectors(0.0)?, discs, reach);
            Box::new(FastMd::<S, P, _>::new(model, search, set, walls, particles)?)
        }
        FastSearch::Lists { skin } => {
            let search = ListSearch::<S, P>::new(sectors(skin)?, discs, reach, skin);
            Box::new(FastMd::<S, P, _>::new(model, search, set, walls, particles)?)
        }
    })
}

/// A fast simulation with state of precision `S`, forces of precision `P` and search `Q`.
struct FastMd<S, P, Q> {
    model: Model,
    set: InstructionSet,
    walls: WallMotion,
    start: Particles,
    state: State<S>,
    /// Force along x, along y, torque.
    sums: [Vec<P>; 3],
    search: Q,
    /// Changes of cells since the discs were put in order.
    changes: usize,
    met: u64,
    /// Whether the state is predicted and its forces are not yet known.
    awaits_forces: bool,
    steps: u64,
    totals: Totals,
    crossings: Crossings,
    /// Grains, and moving walls in the same list, that are so near to an open side that lists may last until they have left
    /// through it.
    rim: Vec<u32>,
    timings: Timings,
}

impl<S: Precision, P: Precision, Q: Search<S, P>> FastMd<S, P, Q> {
    /// Lays out `particles` and finds their first forces.
    ///
    /// # Errors
    /// [`Failure`] if the start breaks a precondition already.
    fn new(
        model: Model,
        search: Q,
        set: InstructionSet,
        walls: WallMotion,
        particles: Particles,
    ) -> Result<Self, Failure> {
        let sums = [0, 1, 2].map(|_| vec![P::default(); particles.len()]);
        let crossings = Crossings::new(model.counts_crossings(), particles.len());
        let mut simulation = FastMd {
            state: State::new(&model, &particles),
            sums,
            search,
            set,
            walls,
            start: particles,
            changes: 0,
            met: 0,
            awaits_forces: false,
            steps: 0,
            totals: Totals::default(),
            crossings,
            rim: vec![],
            timings: Timings::default(),
            model,
        };
        simulation.state.turn_walls(walls_at(walls, 0.0).1, simulation.model.dt);
        let positions = simulation.start.all().iter().map(|disc| disc.position);
        let moves = positions.enumerate().map(|(disc, position)| simulation.locate(disc, position));
        let moves: Vec<Move> = moves.collect::<Result<_, _>>()?;
        simulation.rehouse(&moves)?;
        simulation.put_in_order();
        let power = simulation.meet()?;
        simulation.totals = Totals::starting_with(power, simulation.wall_power());
        Ok(simulation)
    }

    /// Numbers the discs in the order of their cells, so that neighbours are near in memory, and makes lists anew where
    /// there are such; gives what each disc was before. No sum depends on the numbers.
    fn put_in_order(&mut self) -> Vec<u32> {
        let grains = self.start.grain_count();
        let mut order = self.search.order();
        // Grains first, as ever.
        order.sort_by_key(|&disc| disc as usize >= grains);
        self.search.renumber(&order);
        self.state.renumber(&order);
        for sum in &mut self.sums {
            *sum = order.iter().map(|&disc| sum[disc as usize]).collect();
        }
        self.search.make_lists(&self.state);
        self.rim = self.discs_at_the_rim();
        self.changes = 0;
        order
    }

    /// What moving walls put in (energy/time): all walls have one velocity, and what they do to the grains is the sum of
    /// the grains' forces, for those of two grains cancel. Summed in the scene's order of the discs.
    fn wall_power(&self) -> f64 {
        if self.walls == WallMotion::Fixed || !self.model.follows_energy() {
            return 0.0;
        }
        let (_, velocity) = walls_at(self.walls, self.time());
        let mut forces = vec![[0.0; 2]; self.start.len()];
        for disc in 0..self.start.grain_count() {
            forces[self.state.number(disc)] = [0, 1].map(|axis| self.sums[axis][disc].to_f64());
        }
        let along = |axis: usize| velocity[axis] * forces.iter().map(|force| force[axis]).sum::<f64>();
        along(0) + along(1)
    }

    /// All forces of the positions as they stand; gives what contacts dissipate (energy/time).
    fn meet(&mut self) -> Result<f64, Failure> {
        let mut timings = self.timings;
        let met = timings.time(Phase::Forces, || self.add_forces())?;
        self.timings = timings;
        self.met = met.pairs;
        self.awaits_forces = false;
        self.judge(&met)?;
        Ok(met.dissipated)
    }

    fn add_forces(&mut self) -> Result<Met, ProgramError> {
        let grains = self.start.grain_count();
        // Grains' sums are zero already.
        self.sums.iter_mut().for_each(|sum| sum[grains..].fill(P::default()));
        let model = self.model.clone();
        with_law(&model, Sweeping(self))
    }

    /// The state at the end of the step, a disc's position and velocity times dt among it.
    fn corrected(&self, freedom: usize, disc: usize) -> [S; 6] {
        let row = self.state.row(freedom, disc);
        if self.steps == 0 || self.awaits_forces || disc >= self.start.grain_count() {
            return row;
        }
        let force = S::from_f64(self.sums[freedom][disc].to_f64());
        steps::corrected(&self.model, &self.state, self.steps, freedom, disc, row, force)
    }
}

/// A sweep with the law of the model.
struct Sweeping<'a, S, P, Q>(&'a mut FastMd<S, P, Q>);

impl<S: Precision, P: Precision, Q: Search<S, P>> WithLaw for Sweeping<'_, S, P, Q> {
    type Output = Result<Met, ProgramError>;

    fn with<L: Law<2> + Send + Sync + 'static>(self, law: L) -> Self::Output {
        let FastMd { model, state, sums, search, set, .. } = self.0;
        let sums = sums.each_mut().map(Vec::as_mut_slice);
        search.sweep(&law, &state.discs(model), sums, model.asked(), *set)
    }
}

impl<S: Precision, P: Precision, Q: Search<S, P>> Engine for FastMd<S, P, Q> {
    fn step(&mut self) -> Result<(), Failure> {
        let first = self.steps == 0;
        let mut timings = self.timings;
        if self.changes > self.start.grain_count() / 4 {
            timings.time(Phase::Index, || _ = self.put_in_order());
        }
        let passed = timings.time(Phase::CorrectPredict, || steps::advance(self, first))?;
        self.steps += 1;
        self.awaits_forces = true;
        self.timings = timings;
        timings.time(Phase::Index, || keep_awake(|| self.keep_index(&passed.left)))?;
        self.timings = timings;
        self.judge_steps(&passed.far)?;
        self.totals.shared_cells += self.search.guests() as u64;
        let power = self.meet()?;
        self.totals.add_work(self.model.dt, power, self.wall_power());
        Ok(())
    }

    fn steps(&self) -> u64 {
        self.steps
    }

    fn time(&self) -> f64 {
        self.steps as f64 * self.model.dt
    }

    fn particles(&self) -> Particles {
        let mut particles = self.start.clone();
        let (grains, freedoms) = (self.start.grain_count(), self.model.freedoms());
        let (_, wall_velocity) = walls_at(self.walls, self.time());
        let domain = self.model.domain();
        for disc in 0..particles.len() {
            let rows = [0, 1, 2].map(|freedom| {
                let row = if freedom < freedoms { self.corrected(freedom, disc) } else { Default::default() };
                row.map(|q| q.to_f64())
            });
            let position = domain.inside(self.position(disc, [rows[0][0], rows[1][0]]));
            let particle = &mut particles.all_mut()[self.state.number(disc)];
            if disc < grains {
                particle.position = position;
                particle.velocity = [rows[0][1] / self.model.dt, rows[1][1] / self.model.dt];
                particle.angle = rows[2][0];
                particle.omega = rows[2][1] / self.model.dt;
            } else {
                particle.position = position;
                particle.velocity = wall_velocity;
            }
        }
        particles
    }

    fn forces(&self) -> Vec<[f64; 3]> {
        let mut forces = vec![[0.0; 3]; self.start.len()];
        for disc in 0..self.start.len() {
            forces[self.state.number(disc)] = [0, 1, 2].map(|sum| self.sums[sum][disc].to_f64());
        }
        forces
    }

    fn totals(&self) -> Totals {
        self.totals
    }

    fn crossings(&self) -> Vec<[f64; 2]> {
        self.crossings.counts().to_vec()
    }

    fn state(&self) -> Vec<(String, Column)> {
        self.columns()
    }

    fn restore(&mut self, steps: u64, totals: Totals, columns: Vec<(String, Column)>) -> Result<(), String> {
        self.take_up(columns)?;
        self.steps = steps;
        self.totals = totals;
        self.state.turn_walls(walls_at(self.walls, self.time()).1, self.model.dt);
        Ok(())
    }

    fn ledger(&self) -> Ledger {
        // Its work depends on the data, contact by contact: no fixed program to count.
        Ledger::default()
    }

    fn length(&self, length: Length) -> u64 {
        match length {
            Length::Pairs => self.met,
            _ => super::Lengths::new(&self.model, self.start.grain_count(), self.start.len())
                .range(length)
                .len() as u64,
        }
    }

    fn lists(&self) -> Option<(usize, u64)> {
        self.search.lists().map(|lists| (lists.entries(), lists.made()))
    }

    fn timings(&self) -> &Timings {
        &self.timings
    }

    fn reset_timings(&mut self) {
        self.timings = Timings::default();
    }
}

/// How many derivatives a scheme hands on from step to step.
fn carried(scheme: Scheme) -> usize {
    match scheme {
        Scheme::Gear(values) => values.count(),
        Scheme::VelocityVerlet => 2,
    }
}
