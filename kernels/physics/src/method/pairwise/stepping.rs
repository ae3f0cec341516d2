//! Interface of stepped discs for methods, whether one engine, several ranks or vector programs step them.

use super::search::{PairSearch, SearchCells};
use super::{Elapsed, NameableDiscs, PairEngine, Phase, PlaneWalls, PrescribedMotion, WallTouch, wrapped};
use crate::io::checkpoint::CheckpointColumn;
use crate::method::{PerParticle, PhysicsFailure, SteeringError, SteppedState};
use crate::observe::{ObservationSums, SceneProperties};
use crate::particles::{GrainStates, Particle, Particles};
use std::sync::Arc;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::isa::ProgramError;
use stripmine_kernels::law::ObservationRequest;
use stripmine_kernels::ledger::{Ledger, VectorLength};
use stripmine_kernels::single_threaded_if;
use stripmine_kernels::sweep::fast::SweepReport;

/// Work of gravity on a grain, given its number in the scene and its position.
pub(crate) type GravityWork<'w> = dyn Fn(usize, &Particle, [f64; 2]) -> f64 + Sync + 'w;

/// Discs that are stepped.
pub(crate) trait SteppingDiscs: NameableDiscs + PerParticle + Send {
    /// Predicts the next step, after the correction of the last one, and updates the cells. Returns the discs that moved so far that contacts may be
    /// missed, or whose speed is not a number.
    ///
    /// # Errors
    /// [`PhysicsFailure`] if a disc left the box or entered an occupied cell.
    fn advance(&mut self) -> Result<Vec<u32>, PhysicsFailure>;

    /// Computes all forces at the current positions.
    ///
    /// # Errors
    /// [`PhysicsFailure`] if a force is not finite, or the machine rejects the law.
    fn compute_forces(&mut self, asked: ObservationRequest) -> Result<SweepReport, PhysicsFailure>;

    /// Completes the step after its forces are checked, if the corrector waits for it.
    ///
    /// # Errors
    /// [`PhysicsFailure`] if a correction is not finite.
    fn finish(&mut self) -> Result<(), PhysicsFailure> {
        Ok(())
    }

    /// Steps, periods and seconds so far.
    fn elapsed(&self) -> &Elapsed;

    /// Mutable access to steps, periods and seconds.
    fn elapsed_mut(&mut self) -> &mut Elapsed;

    /// Discs at the start.
    fn start(&self) -> &Particles;

    /// Replaces the plane walls by the same walls, joined otherwise and moved, before forces are computed; several ranks have none.
    fn move_plane_walls(&mut self, _walls: &Arc<PlaneWalls>, _motions: &[PrescribedMotion]) {}

    /// Contacts with plane walls when forces were last computed, in the order of the discs' numbers, then of the walls.
    fn wall_touches(&self) -> &[WallTouch] {
        &[]
    }

    /// Number of discs in cells owned by another disc.
    fn shared_cells(&self) -> usize {
        0
    }

    /// Entries of the lists and number of builds; none where there are no lists.
    fn lists(&self) -> Option<(usize, u64)>;

    /// Particles now; positions are consistent with the counted periods.
    fn unwrapped(&self) -> Particles;

    /// Force along x and y and torque on every particle, in the scene's order.
    fn forces(&self) -> Vec<[f64; 3]>;

    /// As [`SteppedState::check_ranks`].
    ///
    /// # Errors
    /// As there.
    fn check_ranks(&self) -> Result<(), PhysicsFailure> {
        Ok(())
    }

    /// Ends the simulation on the other ranks, if any: processes run one simulation after the other. It is unusable afterwards.
    fn end(&mut self) {}

    /// Everything that the next step depends on, by name.
    fn columns(&self) -> Vec<(String, CheckpointColumn)>;

    /// Restores columns of a moment after a number of steps.
    ///
    /// # Errors
    /// Says why, if they are not those of this engine and scene.
    fn restore(&mut self, steps: u64, columns: &[(String, CheckpointColumn)]) -> Result<(), String>;

    /// Takes the end of the step as a start, with the velocities and angular velocities of all discs in the scene's order. Forces must be computed
    /// next, and the step be [finished](Self::finish).
    ///
    /// # Errors
    /// [`SteeringError`] if a disc belongs to no cell, or several ranks step the discs.
    fn restart(&mut self, _motion: &[([f64; 3], f64)]) -> Result<(), SteeringError> {
        let remedy = "use one rank";
        Err(SteeringError::refused("a simulation on several ranks cannot be changed", remedy))
    }

    /// Replaces gravity (length/time²), and counts crossings along these axes from now on, too. Returns false where several ranks step the discs.
    fn set_gravity(&mut self, _gravity: [f64; 2], _followed: [bool; 2]) -> bool {
        false
    }

    /// Sums over the grains and their contacts at the end of the step. `work` returns the work of gravity on a grain (by its number in the scene) at
    /// a position (length) that is consistent with the counted periods; it is called only with gravity.
    fn sums(&self, scenery: &SceneProperties, work: &GravityWork<'_>) -> ObservationSums {
        ObservationSums::over_parts(&self.unwrapped(), scenery, work)
    }

    /// Operations of a step; empty if its work depends on the data, contact by contact.
    fn ledger(&self) -> Ledger {
        Ledger::default()
    }

    /// Vector length of a symbolic length in the last step, unless it follows from the discs and the lattice.
    fn length(&self, _length: VectorLength) -> Option<u64> {
        None
    }
}

/// Discs that can be removed during a run.
pub(crate) trait RemovableDiscs: SteppingDiscs {
    /// Velocities left by the last predictor (length/time), in the scene's order; at the start the initial ones.
    fn predicted_velocities(&self) -> Vec<[f64; 2]>;

    /// Skips the forces of a step in which no pair acts.
    ///
    /// # Errors
    /// [`PhysicsFailure`] if particles cannot be redistributed to their ranks.
    fn skip_forces(&mut self) -> Result<(), PhysicsFailure>;

    /// Returns the particles, by their numbers in the scene and rising, that belong to no cell or have a value that is not finite.
    fn unfit(&self) -> Vec<usize>;

    /// Updates all cells from the predicted positions, before their forces are computed.
    ///
    /// # Errors
    /// [`PhysicsFailure`] if a particle belongs to no cell.
    fn settle(&mut self) -> Result<(), PhysicsFailure>;
}

impl<S: Precision, P: Precision, Q: PairSearch<S, P>> PerParticle for PairEngine<S, P, Q> {
    fn particles(&self) -> Particles {
        wrapped(self.unwrapped(), &self.system.domain)
    }

    fn states(&self, states: &mut GrainStates) {
        self.for_each_at_step_end(0..self.start.len(), |disc, place, velocity| {
            states.store_state(self.state.number(disc), self.system.domain.wrapped(place), velocity);
        });
    }

    fn positions(&self) -> Vec<[f32; 3]> {
        self.step_end_positions()
    }

    fn images(&self) -> Vec<[i32; 2]> {
        self.step_end_images()
    }
}

impl<S: Precision, P: Precision, Q: PairSearch<S, P>> SteppingDiscs for PairEngine<S, P, Q> {
    fn advance(&mut self) -> Result<Vec<u32>, PhysicsFailure> {
        single_threaded_if(self.is_small(), || self.advance_positions())
    }

    fn compute_forces(&mut self, asked: ObservationRequest) -> Result<SweepReport, PhysicsFailure> {
        let mut timings = self.elapsed.timings;
        let met = timings.time(Phase::Forces, || {
            single_threaded_if(self.is_small(), || {
                let met = self.add_forces(asked)?;
                self.add_wall_forces();
                Ok::<_, ProgramError>(met)
            })
        })?;
        self.elapsed.timings = timings;
        self.awaits_forces = false;
        self.reject_not_finite_forces(&met)?;
        Ok(met)
    }

    fn elapsed(&self) -> &Elapsed {
        &self.elapsed
    }

    fn elapsed_mut(&mut self) -> &mut Elapsed {
        &mut self.elapsed
    }

    fn start(&self) -> &Particles {
        &self.start
    }

    fn move_plane_walls(&mut self, walls: &Arc<PlaneWalls>, motions: &[PrescribedMotion]) {
        self.move_walls(walls, motions);
    }

    fn wall_touches(&self) -> &[WallTouch] {
        &self.touches
    }

    fn shared_cells(&self) -> usize {
        self.search.cells().shared_cells(&|_| true)
    }

    fn lists(&self) -> Option<(usize, u64)> {
        self.search.lists().map(|lists| (lists.entries(), lists.made()))
    }

    fn unwrapped(&self) -> Particles {
        self.step_end_particles()
    }

    fn forces(&self) -> Vec<[f64; 3]> {
        let mut forces = vec![[0.0; 3]; self.start.len()];
        for disc in 0..self.start.len() {
            forces[self.state.number(disc)] = self.force_on(disc);
        }
        forces
    }

    fn columns(&self) -> Vec<(String, CheckpointColumn)> {
        self.saved()
    }

    fn restore(&mut self, steps: u64, columns: &[(String, CheckpointColumn)]) -> Result<(), String> {
        self.restore_state(steps, columns)
    }

    fn restart(&mut self, motion: &[([f64; 3], f64)]) -> Result<(), SteeringError> {
        Ok(single_threaded_if(self.is_small(), || self.begin_from_step_end(motion))?)
    }

    fn set_gravity(&mut self, gravity: [f64; 2], followed: [bool; 2]) -> bool {
        self.replace_gravity(gravity, followed);
        true
    }

    fn sums(&self, scenery: &SceneProperties, work: &GravityWork<'_>) -> ObservationSums {
        let corrected = self.corrected_discs();
        let grains = self.grain_sums(&corrected, scenery, work);
        ObservationSums { grains, contacts: self.contact_sums(&corrected) }
    }
}

impl<S: Precision, P: Precision, Q: PairSearch<S, P>> RemovableDiscs for PairEngine<S, P, Q> {
    fn predicted_velocities(&self) -> Vec<[f64; 2]> {
        let mut velocities = vec![[0.0; 2]; self.start.len()];
        (0..velocities.len()).for_each(|disc| velocities[self.state.number(disc)] = self.velocity(disc));
        velocities
    }

    fn skip_forces(&mut self) -> Result<(), PhysicsFailure> {
        self.awaits_forces = false;
        Ok(())
    }

    fn unfit(&self) -> Vec<usize> {
        self.unfit_discs()
    }

    fn settle(&mut self) -> Result<(), PhysicsFailure> {
        self.settle_all().map(drop)
    }
}

impl SteppedState for Box<dyn RemovableDiscs> {
    fn elapsed(&self) -> &Elapsed {
        self.as_ref().elapsed()
    }

    fn per_particle(&self) -> &dyn PerParticle {
        self.as_ref()
    }

    fn check_ranks(&self) -> Result<(), PhysicsFailure> {
        self.as_ref().check_ranks()
    }

    fn columns(&self) -> Vec<(String, CheckpointColumn)> {
        self.as_ref().columns()
    }
}
