//! Pairwise engine: computes all forces, then corrects and predicts in one pass.

use super::compiled::{CompiledDynamics, CorrectionArguments, PassArguments, SweepArguments, WallArguments};
use super::search::{PairSearch, SearchCells};
use super::state::{CellMove, Members, MovingDiscs, StepEndRow};
use super::{
    Crossings, Elapsed, NameableDiscs, PairSystem, Phase, PlaneWalls, PrescribedMotion, SortSchedule,
    WallGrid, WallTouch, not_finite,
};
use crate::domain::Domain;
use crate::method::{Clock, PhysicsFailure};
use crate::particles::Particles;
use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::isa::ProgramError;
use stripmine_kernels::law::ObservationRequest;
use stripmine_kernels::sweep::fast::{ForceRecords, PassReport, SweepReport};
use stripmine_kernels::{keep_awake, over_parts, single_threaded_if};

/// Number of discs below which one thread does all the work, because a step is over before other threads start. Measured on two cores: 2000 discs
/// took twice as long on two threads, 4000 as long as on one, 8000 were faster by a fifth.
const FEW: usize = 5000;

/// Dynamics, system, and the instruction set of their loops.
pub(super) type EngineParts<S, P, Q> = (Arc<dyn CompiledDynamics<S, P, Q>>, PairSystem, InstructionSet);

/// Largest distance by which a position is rounded out of its cell, relative to the cell.
const BESIDE: f64 = 1e-3;

/// Alignment number of the sums; columns of the state have smaller ones.
const SUMS: usize = 24;

/// Discs with state of precision `S`, forces of precision `P` and search `Q`.
pub(crate) struct PairEngine<S, P, Q> {
    pub(super) dynamics: Arc<dyn CompiledDynamics<S, P, Q>>,
    pub(super) system: PairSystem,
    pub(super) set: InstructionSet,
    /// All particles of the scene at its start.
    pub(super) start: Arc<Particles>,
    pub(super) state: MovingDiscs<S>,
    pub(super) sums: ForceRecords<P>,
    pub(super) search: Q,
    /// Changes of cells since the discs were sorted.
    pub(super) changes: usize,
    /// Number of sorts.
    pub(super) orders: u64,
    /// True if the state is predicted and its forces are not yet computed.
    pub(super) awaits_forces: bool,
    /// Discs so near to an open side that they may leave through it before lists are rebuilt.
    pub(super) boundary_candidates: Vec<u32>,
    pub(super) elapsed: Elapsed,
    /// Plane walls in the cells, if there are any, and their contacts when forces were last computed.
    walls: Option<WallGrid<P>>,
    pub(super) touches: Vec<WallTouch>,
}

impl<S: Precision, P: Precision, Q: PairSearch<S, P>> PairEngine<S, P, Q> {
    /// Places `particles`. Their forces are unknown until [`compute_forces`](super::SteppingDiscs::compute_forces).
    ///
    /// # Errors
    /// [`PhysicsFailure`] if a disc is outside the box, or in an occupied cell.
    pub(super) fn new(
        dynamics: Arc<dyn CompiledDynamics<S, P, Q>>,
        system: PairSystem,
        search: Q,
        set: InstructionSet,
        particles: Particles,
    ) -> Result<Self, PhysicsFailure> {
        let members = Members::all(&particles);
        let crossings = Crossings::new(system.followed, particles.len());
        let elapsed = Elapsed::new(system.dt, crossings);
        let mut engine =
            PairEngine::of((dynamics, system, set), search, Arc::new(particles), members, elapsed);
        engine.place_discs()?;
        Ok(engine)
    }

    /// Builds an engine of some of the particles of a scene, not yet in cells.
    pub(super) fn of(
        (dynamics, system, set): EngineParts<S, P, Q>,
        search: Q,
        start: Arc<Particles>,
        members: Members,
        elapsed: Elapsed,
    ) -> Self {
        let carried = dynamics.carried(system.dt);
        let sums = ForceRecords::zeros(SUMS, members.numbers.len());
        let walls = dynamics.walls().map(|walls| {
            let grid = search.cells().grid();
            let [x, y] = grid.frame.edge;
            let margin = search.lists().map_or(BESIDE * x.min(y), |lists| 0.5 * lists.skin());
            WallGrid::new(walls.clone(), grid, margin)
        });
        let mut engine = PairEngine {
            state: MovingDiscs::new(&system, &carried, &start, members),
            sums,
            elapsed,
            dynamics,
            system,
            search,
            set,
            start,
            changes: 0,
            orders: 0,
            awaits_forces: false,
            boundary_candidates: vec![],
            walls,
            touches: vec![],
        };
        engine.update_wall_velocity();
        engine
    }

    /// Replaces the members; the new ones are at the start and not yet in cells.
    pub(super) fn replace_members(&mut self, members: Members, search: Q) {
        let carried = self.dynamics.carried(self.system.dt);
        self.sums = ForceRecords::zeros(SUMS, members.numbers.len());
        self.state = MovingDiscs::new(&self.system, &carried, &self.start, members);
        self.search = search;
        self.changes = 0;
        self.awaits_forces = false;
        self.boundary_candidates.clear();
        self.update_wall_velocity();
    }

    /// Places all discs in the cells of their start positions.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub(super) fn place_discs(&mut self) -> Result<(), PhysicsFailure> {
        let located = |discs: Range<usize>| -> Result<Vec<CellMove>, PhysicsFailure> {
            discs
                .map(|disc| self.locate(disc, self.start.all()[self.state.number(disc)].planar_position()))
                .collect()
        };
        let moves = single_threaded_if(self.is_small(), || over_parts(0..self.state.len(), located));
        let moves: Vec<Vec<CellMove>> = moves.into_iter().collect::<Result<_, _>>()?;
        self.change_cells(&moves.concat())?;
        self.sort_by_cell();
        Ok(())
    }

    /// True if one thread does all the work for so few discs.
    pub(super) fn is_small(&self) -> bool {
        self.state.len() < FEW
    }

    /// Returns the prescribed motion of discs that no force moves, if they move.
    pub(super) fn prescribed(&self) -> Option<PrescribedMotion> {
        self.dynamics.prescribed(self.elapsed.time())
    }

    pub(super) fn update_wall_velocity(&mut self) {
        let velocity = self.prescribed().unwrap_or_default().velocity;
        self.state.set_wall_velocity(velocity);
    }

    /// Sorts the discs by cell, so that neighbours are close in memory, and rebuilds the lists; returns the previous index of each disc. No sum
    /// depends on the order.
    pub(super) fn sort_by_cell(&mut self) -> Vec<u32> {
        let (moving, grains) = (self.state.moving(), self.state.grains());
        let mut order = self.search.cells().order();
        if moving < order.len() {
            // Owned grains stay first, and all grains before the walls.
            let kind = |disc: usize| (disc >= moving, disc >= grains);
            order.sort_by_key(|&disc| kind(disc as usize));
        }
        self.search.cells_mut().renumber(&order);
        self.state.renumber(&order);
        self.sums.renumber(&order);
        self.make_lists();
        self.changes = 0;
        self.orders += 1;
        order
    }

    /// Makes the lists, if the search has some, and finds the discs near open sides.
    pub(super) fn make_lists(&mut self) {
        self.search.make_lists(&self.state);
        self.boundary_candidates = self.discs_near_open_sides();
    }

    pub(super) fn advance_positions(&mut self) -> Result<Vec<u32>, PhysicsFailure> {
        self.sort_if_due();
        let passed = self.pass(0..self.state.moving())?;
        self.finish_advance();
        let mut timings = self.elapsed.timings;
        let kept = timings.time(Phase::Index, || keep_awake(|| self.update_cells_and_lists(&passed.left)));
        self.elapsed.timings = timings;
        kept?;
        Ok(passed.far)
    }

    /// Sorts the discs if many have changed cells since the last sort.
    pub(super) fn sort_if_due(&mut self) {
        if self.system.sort == SortSchedule::EveryStep || self.changes > self.state.grains() / 4 {
            let mut timings = self.elapsed.timings;
            timings.time(Phase::Index, || _ = self.sort_by_cell());
            self.elapsed.timings = timings;
        }
    }

    /// Advances some discs by one step; their cells are updated later.
    pub(super) fn pass(&mut self, discs: Range<usize>) -> Result<PassReport, ProgramError> {
        let begun = Instant::now();
        let PairEngine { dynamics, system, state, sums, search, set, elapsed, .. } = self;
        let (steps, is_beginning) = (elapsed.steps, elapsed.is_beginning());
        let passed = dynamics.pass(PassArguments {
            discs,
            system,
            state,
            sums,
            search,
            steps,
            is_beginning,
            set: *set,
        });
        elapsed.timings.add(Phase::CorrectPredict, begun.elapsed().as_secs_f64());
        passed
    }

    /// Records that all discs have been advanced by one step.
    pub(super) fn finish_advance(&mut self) {
        self.elapsed.steps += 1;
        self.awaits_forces = true;
    }

    pub(super) fn add_forces(&mut self, asked: ObservationRequest) -> Result<SweepReport, ProgramError> {
        let PairEngine { dynamics, state, sums, search, set, .. } = self;
        // Sums of owned discs are zero already.
        sums.clear(state.moving()..state.len());
        dynamics.sweep(SweepArguments { state, sums, search, asked, set: *set })
    }

    /// Moves the plane walls, if there are any.
    pub(super) fn move_walls(&mut self, to: &Arc<PlaneWalls>, motions: &[PrescribedMotion]) {
        self.walls.iter_mut().for_each(|walls| walls.move_walls(to, motions));
    }

    /// Finds the contacts with plane walls and adds their forces, disc by disc in the order of the walls.
    pub(super) fn add_wall_forces(&mut self) {
        let PairEngine { dynamics, system, state, sums, search, walls: Some(walls), touches, .. } = self
        else {
            return;
        };
        let inertia = system.inertia;
        *touches = dynamics.touch_walls(WallArguments { state, inertia, search, walls });
        for WallTouch { disc, sums: added, .. } in &*touches {
            let disc = *disc as usize;
            let before = sums.of(disc);
            for (sum, &added) in added.iter().enumerate() {
                sums.set(sum, disc, before[sum] + P::from_f64(added));
            }
        }
        // The sort keeps the order of the walls of a disc.
        touches.sort_by_key(|touch| state.number(touch.disc as usize));
    }

    /// Fails at pairs with a grain whose force is not finite.
    pub(super) fn reject_not_finite_forces(&self, met: &SweepReport) -> Result<(), PhysicsFailure> {
        let grains = self.state.grains();
        let pairs = met.not_finite.iter().map(|pair| pair.map(|disc| disc as usize));
        // Two fixed discs have no effective mass: their force is meaningless.
        let of_grains = pairs.filter(|pair| pair.iter().any(|&disc| disc < grains));
        let lost: BTreeSet<usize> = of_grains.flatten().collect();
        // A disc that is lost itself is named before a disc that only touches it.
        let is_lost = |disc: usize| {
            (0..self.system.freedoms).any(|freedom| !self.state.row(freedom, disc)[1].to_f64().is_finite())
        };
        match lost.iter().min_by_key(|&&disc| (!is_lost(disc), self.state.number(disc))) {
            Some(&first) => Err(not_finite(self.clock(), lost.len() as u64, self.culprit(first))),
            None => Ok(()),
        }
    }

    /// Returns the force along x and y and the torque on a disc.
    pub(super) fn force_on(&self, disc: usize) -> [f64; 3] {
        self.sums.of(disc).map(|sum| sum.to_f64())
    }

    /// Computes some discs at the end of the step. The state is not changed.
    pub(super) fn correct(&self, discs: &[u32], to: &mut [StepEndRow]) {
        let PairEngine { system, state, sums, .. } = self;
        let steps = self.elapsed.steps;
        let moving = if self.elapsed.is_beginning() || self.awaits_forces { 0 } else { state.moving() };
        self.dynamics.correct(CorrectionArguments { system, state, sums, steps, moving, discs, to });
    }
}

impl<S: Precision, P: Precision, Q: PairSearch<S, P>> NameableDiscs for PairEngine<S, P, Q> {
    fn clock(&self) -> Clock {
        self.elapsed.clock()
    }

    fn domain(&self) -> Domain {
        self.system.domain
    }

    fn grains(&self) -> Range<usize> {
        0..self.state.grains()
    }

    fn number(&self, disc: usize) -> usize {
        self.state.number(disc)
    }

    fn id(&self, disc: usize) -> u32 {
        self.state.id(disc)
    }

    fn position(&self, disc: usize) -> [f64; 2] {
        self.absolute_position(disc, self.state.place(disc))
    }

    fn velocity(&self, disc: usize) -> [f64; 2] {
        [0, 1].map(|axis| self.state.rate(&self.state.row(axis, disc)))
    }

    fn radius(&self, disc: usize) -> f64 {
        self.state.radius(disc)
    }
}
