//! Changes of hard discs by the user: the search for events restarts.

use super::{HardDiskSimulation, IntervalMark, crossing, falling, potential};
use crate::domain::BoxSide;
use crate::method::hard_disks::collapse::CollapseMonitor;
use crate::method::hard_disks::restored::available_energy;
use crate::method::{
    Change, PerParticle, PhysicsFailure, Snapshot, SteeredQuantity, Steering, SteeringError, has_no,
};
use stripmine_kernels::flight::FlyingDisc;

/// Names of the sums at the last change, and of the energy available since then, in a checkpoint.
const CHANGED: &str = "changed";
const AVAILABLE: &str = "changed.available_energy";

impl HardDiskSimulation {
    /// True if anything was changed during the run.
    pub(super) fn is_changed(&self) -> bool {
        self.since != IntervalMark::default() || self.steering != Steering::default()
    }

    /// Kinetic and potential energy.
    fn energy(&self) -> f64 {
        self.motion().kinetic() + potential(self.discs(), &self.arena, self.clock.time)
    }

    /// Makes another engine of discs at a time, and the monitor of collapse.
    pub(super) fn rebuild_engine(&mut self, discs: Vec<FlyingDisc>, time: f64) -> Result<(), PhysicsFailure> {
        let fall = falling(&discs, &self.arena);
        self.watch = CollapseMonitor::new(crossing(discs.iter()), fall, discs.len());
        self.engine = self.configuration.engine(self.arena, discs, time);
        self.may_meet = false;
        self.engine.begin().map_err(|why| self.failure(why))
    }

    /// Refuses a change that does not suit the box.
    fn reject_unsuitable(&self, change: &Change) -> Result<(), SteeringError> {
        let refused =
            |why: &str, remedy: &str| Err(has_no("this scene of hard-disks", change.quantity, why, remedy));
        let Some(gravity) = change.gravity() else {
            return match change.quantity {
                SteeredQuantity::BathTemperature => {
                    refused("its discs are in no bath", "change velocities instead")
                }
                SteeredQuantity::AngularVelocities => {
                    refused("its discs do not rotate", "change velocities instead")
                }
                _ => Ok(()),
            };
        };
        if (0..2).any(|axis| self.arena.domain.is_periodic(axis) && gravity[axis] != 0.0) {
            let why = "nothing stops the fall across a periodic side";
            return refused(why, "start it with domain.periodic = false along gravity");
        }
        if self.arena.domain.sides[1] == BoxSide::Open && gravity[1] >= 0.0 {
            return refused("an open top needs gravity that points down", "give a negative second component");
        }
        Ok(())
    }

    /// As [`Simulation::steer`].
    pub(super) fn make_change(&mut self, change: &Change) -> Result<(), SteeringError> {
        let particles = PerParticle::particles(self);
        change.check(&particles, 0)?;
        self.reject_unsuitable(change)?;
        let (time, before) = (self.clock.time, self.energy());
        let mut discs: Vec<FlyingDisc> = self.discs().copied().collect();
        self.totals.end_flights(&self.arena, discs.iter(), time);
        for (disc, number) in discs.iter_mut().zip(0..) {
            let (position, velocity) =
                (self.arena.position_at(disc, time), disc.velocity_at(&self.arena.space, time));
            (disc.position, disc.velocity, disc.time) = (position, velocity, time);
            if let Some(followed) = &mut self.followed {
                followed.register_crossings(&self.arena, number, disc);
            }
        }
        let motion = change.motion_of(&particles);
        for (disc, number) in discs.iter_mut().zip(0..) {
            let ([u, v, _], _) = motion[self.identities.place(number)];
            disc.velocity = [u, v];
        }
        if let Some(gravity) = change.gravity() {
            self.arena = self.arena.with_gravity(gravity);
        }
        if let Some(followed) = &mut self.followed {
            followed.take_discs(&discs);
        }
        self.rebuild_engine(discs, time)?;
        self.available_energy = available_energy(&self.arena, &PerParticle::particles(self));
        self.steering.add(change, self.energy() - before);
        self.since = self.totals.mark(&self.arena, self.discs(), &self.motion(), time);
        self.row = self.since;
        Ok(())
    }

    /// Adds the changes to a checkpoint.
    pub(super) fn keep_changes(&self, kept: &mut Snapshot) {
        if self.is_changed() {
            self.since.keep(CHANGED, kept);
            kept.add_sum(AVAILABLE, self.available_energy);
            self.steering.keep(kept);
        }
    }

    /// Takes the changes from a checkpoint.
    ///
    /// # Errors
    /// Says which entry is no finite number.
    pub(super) fn take_changes(&mut self, kept: &Snapshot) -> Result<(), String> {
        self.steering = Steering::of(kept)?;
        if kept.counters.contains_key(AVAILABLE) {
            self.available_energy = kept.sum(AVAILABLE)?;
        }
        if let Some(gravity) = self.steering.gravity {
            self.arena = self.arena.with_gravity(gravity);
        }
        Ok(())
    }

    /// Sums of a checkpoint at the last change, or at the start.
    ///
    /// # Errors
    /// A message if they are later than the sums.
    pub(super) fn mark_of_changes(&self, kept: &Snapshot) -> Result<IntervalMark, String> {
        let is_changed = kept.counters.contains_key(AVAILABLE);
        let mark = is_changed.then(|| IntervalMark::mark_from_snapshot(CHANGED, kept, &self.totals));
        Ok(mark.transpose()?.unwrap_or_default())
    }
}
