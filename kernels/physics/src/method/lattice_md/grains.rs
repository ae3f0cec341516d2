//! Granular discs that are stepped: checks and accounting of a step, independent of the engine.

use super::balance::GravityPath;
use super::contacts::{ContactSearch, ProgramExecution};
use super::fast;
use super::flux::Flux;
use super::simulation::LatticeMd;
use super::step_checks::{check_contact_depths, check_step_lengths, check_wall_steps};
use super::wall_checks::WallTouches;
use super::wall_law::with_wall_law;
use super::wall_sums::{WallSums, forces_and_torques};
use super::walls::{plane_wall_power, wall_power};
use super::{GranularModel, GranularTotals, Lengths, Timings};
use crate::io::checkpoint::CheckpointColumn;
use crate::method::pairwise::{PlaneMotion, SteppingDiscs, WallTouch, WallTracks};
use crate::method::stepped::SteppedState;
use crate::method::{Elapsed, PerParticle, PhysicsFailure, SteeringError};
use crate::observe::{ObservationSums, SceneProperties};
use crate::particles::Particles;
use crate::scene::{Precision, WallMotion};
use std::sync::Arc;
use stripmine_kernels::ledger::{Ledger, VectorLength};

/// Granular discs that are stepped. They never print and never write a file.
pub struct SteppedGrains {
    stepping: Box<dyn SteppingDiscs>,
    model: GranularModel,
    walls: WallMotion,
    totals: GranularTotals,
    wall_tracks: WallTracks,
    wall_sums: WallSums,
    flux: Flux,
    /// Pairs visited in the last step.
    met: u64,
}

impl SteppedGrains {
    /// Places `particles` and computes their first forces, in the requested precision.
    ///
    /// # Errors
    /// [`PhysicsFailure`] if the start violates a precondition, or the box does not suit sectors.
    pub fn start(
        precision: Precision,
        model: GranularModel,
        contacts: ContactSearch,
        machine: ProgramExecution,
        walls: WallMotion,
        particles: Particles,
    ) -> Result<SteppedGrains, PhysicsFailure> {
        fn programs<S: stripmine_kernels::backend::Precision, P: stripmine_kernels::backend::Precision>(
            (model, contacts, machine): (&GranularModel, ContactSearch, ProgramExecution),
            walls: WallMotion,
            particles: Particles,
        ) -> Box<dyn SteppingDiscs> {
            Box::new(LatticeMd::<S, P>::new(model.clone(), contacts, machine, walls, particles))
        }
        let stepping = match (contacts, precision) {
            (ContactSearch::Fast(search), Precision::F64) => {
                fast::stepping::<f64, f64>(&model, search, machine.set, walls, particles)?
            }
            (ContactSearch::Fast(search), Precision::F32) => {
                fast::stepping::<f32, f32>(&model, search, machine.set, walls, particles)?
            }
            (ContactSearch::Fast(search), Precision::Mixed) => {
                fast::stepping::<f64, f32>(&model, search, machine.set, walls, particles)?
            }
            (_, Precision::F64) => programs::<f64, f64>((&model, contacts, machine), walls, particles),
            (_, Precision::F32) => programs::<f32, f32>((&model, contacts, machine), walls, particles),
            (_, Precision::Mixed) => programs::<f64, f32>((&model, contacts, machine), walls, particles),
        };
        let (totals, wall_sums) = (GranularTotals::default(), WallSums::default());
        let wall_tracks = WallTracks::new(&model.walls);
        let flux = Flux::new(&model.lines, stepping.as_ref());
        let mut grains =
            SteppedGrains { stepping, model, walls, totals, wall_tracks, wall_sums, flux, met: 0 };
        let power = grains.compute_forces()?;
        grains.stepping.finish()?;
        grains.totals = GranularTotals::starting_with(power, grains.wall_power());
        grains.wall_sums = WallSums::starting_with(&grains.model.walls, grains.stepping.wall_touches());
        grains.wall_tracks.finish(0.0, 0.0, &grains.wall_sums.forces);
        Ok(grains)
    }

    /// Advances by one time step.
    ///
    /// # Errors
    /// [`PhysicsFailure`] says what broke, which particles, where, and what to do. The state is that of the failing step.
    pub fn step(&mut self) -> Result<(), PhysicsFailure> {
        let far = self.stepping.advance()?;
        check_step_lengths(self.stepping.as_ref(), &far, self.model.watch, &mut self.totals)?;
        self.totals.shared_cells += self.stepping.shared_cells() as u64;
        let (dt, time) = (self.model.dt, self.time());
        self.wall_tracks.advance(dt, time);
        check_wall_steps(self.stepping.as_ref(), &self.model, self.wall_tracks.now())?;
        let power = self.compute_forces()?;
        self.wall_sums.add(dt, self.stepping.wall_touches());
        self.wall_tracks.finish(dt, time, &self.wall_sums.forces);
        let wall_power = self.wall_power();
        self.totals.add_work(dt, power, wall_power);
        self.stepping.finish()?;
        let discs = self.stepping.as_ref();
        self.flux.add(discs, discs.start().grains(), &self.model.domain());
        Ok(())
    }

    /// Restarts the integrator at the end of the step, with the velocities and angular velocities of all discs and, if given, another gravity
    /// (length/time²).
    ///
    /// # Errors
    /// [`SteeringError`] if several ranks step the discs, or the forces violate a precondition.
    pub(super) fn restart(
        &mut self,
        motion: &[([f64; 3], f64)],
        gravity: Option<[f64; 2]>,
    ) -> Result<(), SteeringError> {
        self.stepping.restart(motion)?;
        if let Some(gravity) = gravity {
            self.set_gravity(gravity);
        }
        // The contacts of this step are counted already.
        let totals = self.totals;
        let power = self.compute_forces()?;
        self.wall_sums.restart(self.stepping.wall_touches());
        self.wall_tracks.finish(0.0, self.time(), &self.wall_sums.forces);
        self.totals = totals.with_powers(power, self.wall_power());
        Ok(self.stepping.finish()?)
    }

    /// Replaces gravity (length/time²). Returns false where several ranks step the discs.
    pub(super) fn set_gravity(&mut self, gravity: [f64; 2]) -> bool {
        self.model.gravity = gravity;
        self.stepping.set_gravity(gravity, self.model.counts_crossings())
    }

    /// Gives the first walls other prescribed velocities (length/time) from now on.
    pub(super) fn set_wall_velocities(&mut self, velocities: &[[f64; 2]]) {
        self.wall_tracks.set_velocities(velocities, self.time());
        self.rejoin_walls();
    }

    fn rejoin_walls(&mut self) {
        let tracks = &self.wall_tracks;
        if !tracks.are_fixed() {
            self.model.walls = Arc::new(self.model.walls.joined(tracks));
        }
    }

    /// Impulses on the plane walls.
    #[cfg(test)]
    pub(super) fn wall_sums(&self) -> &WallSums {
        &self.wall_sums
    }

    /// Prescribed motions of the plane walls now.
    pub(super) fn wall_motions(&self) -> impl Iterator<Item = PlaneMotion> + '_ {
        self.wall_tracks.motions()
    }

    /// Takes the step after which the integrator began from a checkpoint.
    pub(super) fn begun_after(&mut self, steps: u64) {
        self.stepping.elapsed_mut().begun = steps;
    }

    /// Computes all forces at the current positions; returns the power that contacts dissipate (energy/time).
    fn compute_forces(&mut self) -> Result<f64, PhysicsFailure> {
        if !self.wall_tracks.are_fixed() {
            self.stepping.move_plane_walls(&self.model.walls, self.wall_tracks.now());
        }
        let met = self.stepping.compute_forces(self.model.asked())?;
        self.met = met.pairs;
        let touches = self.stepping.wall_touches();
        check_contact_depths(self.stepping.as_ref(), (&met.deep, touches), &self.model, &mut self.totals)?;
        let at_walls: f64 = match self.model.counts_dissipation() {
            true => touches.iter().map(|touch| touch.power).sum(),
            false => 0.0,
        };
        Ok(met.dissipated + at_walls)
    }

    /// Power of moving walls (energy/time).
    fn wall_power(&self) -> f64 {
        let (grains, time) = (self.stepping.start().grain_count(), self.time());
        let touches = self.stepping.wall_touches();
        let of_discs = wall_power(&self.model, self.walls, time, touches, || {
            let mut forces = self.forces();
            forces.truncate(grains);
            forces
        });
        of_discs + plane_wall_power(&self.model, self.wall_tracks.now(), touches)
    }

    /// Steps done since the start of the scene.
    pub fn steps(&self) -> u64 {
        self.elapsed().steps
    }

    /// Time since the start of the scene.
    pub fn time(&self) -> f64 {
        self.elapsed().time()
    }

    /// Particles now, positions inside the box.
    pub fn particles(&self) -> Particles {
        self.stepping.particles()
    }

    /// Particles as the state stores them: the last correction may have moved a position beyond a periodic side, and no [crossing](Self::crossings)
    /// is counted before the next step.
    pub(crate) fn unwrapped(&self) -> Particles {
        self.stepping.unwrapped()
    }

    /// Periods that each particle has crossed along x and y since the start, in the order of [`particles`](Self::particles); empty where they are not
    /// counted.
    pub fn crossings(&self) -> &[[f64; 2]] {
        self.elapsed().crossings.counts()
    }

    /// Sums over the discs and their contacts now, with the work of gravity since the start. The order of summation depends on the scene alone.
    pub fn sums(&self, scenery: &SceneProperties, path: &GravityPath) -> ObservationSums {
        let crossings = self.crossings();
        let mut sums = self
            .stepping
            .sums(scenery, &|number, grain, position| path.work(number, grain, position, crossings));
        for (touch, _) in self.touches_now() {
            sums.contacts.add(touch.energy, touch.penetration);
        }
        sums
    }

    /// Contacts of grains with plane walls at the end of the step, each with its point.
    fn touches_now(&self) -> Vec<(WallTouch, [f64; 2])> {
        let walls = &self.model.walls;
        if walls.is_empty() {
            return vec![];
        }
        let (particles, motions) = (self.stepping.unwrapped(), self.wall_tracks.now());
        let touches = WallTouches { walls, particles: &particles, domain: self.model.domain(), motions };
        with_wall_law(self.model.wall_law(), touches)
    }

    /// Values of each plane wall and each line in the order of [`names_of`](crate::method::names_of): impulses since the start, forces and torque
    /// now, and position and velocity of one that moves; number and mass since the start.
    pub(super) fn own_values(&self) -> Vec<f64> {
        let (model, motions) = (&self.model, self.wall_tracks.now());
        let now = forces_and_torques(model, &self.touches_now(), motions);
        let each = self.wall_sums.impulses.iter().zip(now).enumerate();
        let of_walls = each.flat_map(|(wall, (impulse, now))| {
            let [middle, velocity] = [model.walls.middle_at(wall, motions), motions[wall].velocity];
            let moving = !model.walls.all()[wall].motion.is_fixed();
            let path = [middle, velocity].concat().into_iter().filter(move |_| moving);
            impulse.iter().copied().chain(now).chain(path)
        });
        of_walls.chain(self.flux.sums.iter().flatten().copied()).collect()
    }

    /// Sums of the plane walls and lines by name, for a checkpoint.
    pub(super) fn own_entries(&self) -> Vec<(String, f64)> {
        let mut entries = self.wall_sums.entries(&self.model.walls);
        entries.extend(self.wall_tracks.entries(&self.model.walls));
        entries.extend(self.flux.entries());
        entries
    }

    /// Restores the sums of the plane walls and lines, found by name, once the discs are restored.
    ///
    /// # Errors
    /// As `find`.
    pub(super) fn restore_own(&mut self, find: impl Fn(&str) -> Result<f64, String>) -> Result<(), String> {
        self.wall_sums = WallSums::from_entries(&self.model.walls, &find)?;
        self.wall_tracks.restore(&self.model.walls, self.stepping.elapsed().time(), &find)?;
        self.rejoin_walls();
        self.flux.restore(self.stepping.as_ref(), find)
    }

    /// Force along x and y and torque on every particle in the last step.
    pub fn forces(&self) -> Vec<[f64; 3]> {
        self.stepping.forces()
    }

    /// Counts and sums since the start.
    pub fn totals(&self) -> GranularTotals {
        self.totals
    }

    /// Restores columns of a state.
    ///
    /// # Errors
    /// Says why, if the columns are not those of these discs.
    pub fn restore(
        &mut self,
        steps: u64,
        totals: GranularTotals,
        columns: &[(String, CheckpointColumn)],
    ) -> Result<(), String> {
        self.stepping.restore(steps, columns)?;
        self.totals = totals;
        Ok(())
    }

    /// Operations of a step.
    pub fn ledger(&self) -> Ledger {
        self.stepping.ledger()
    }

    /// Length of vectors of a symbolic length in the last step.
    pub fn length(&self, length: VectorLength) -> u64 {
        match (self.stepping.length(length), length) {
            (Some(own), _) => own,
            (None, VectorLength::Pairs) => self.met,
            (None, _) => {
                let start = self.stepping.start();
                Lengths::new(&self.model, start.grain_count(), start.len()).range(length).len() as u64
            }
        }
    }

    /// Entries of the neighbour lists and the number of rebuilds; none where there are no lists.
    pub fn lists(&self) -> Option<(usize, u64)> {
        self.stepping.lists()
    }

    /// Seconds spent in each phase.
    pub fn timings(&self) -> &Timings {
        &self.elapsed().timings
    }

    /// Resets the seconds spent so far.
    pub fn reset_timings(&mut self) {
        self.stepping.elapsed_mut().timings = Timings::default();
    }
}

impl SteppedState for SteppedGrains {
    fn elapsed(&self) -> &Elapsed {
        self.stepping.elapsed()
    }

    fn per_particle(&self) -> &dyn PerParticle {
        self.stepping.as_ref()
    }

    fn check_ranks(&self) -> Result<(), PhysicsFailure> {
        self.stepping.check_ranks()
    }

    fn columns(&self) -> Vec<(String, CheckpointColumn)> {
        self.stepping.columns()
    }
}
