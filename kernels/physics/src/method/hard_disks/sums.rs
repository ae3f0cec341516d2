//! Sums over events, and the means over an interval that follow from them.

use super::engine::ExecutedEvent;
use super::event::Arena;
use crate::method::Snapshot;
use crate::observe::{AxisMotion, temperature};
use stripmine_kernels::flight::FlyingDisc;

/// Counts and sums since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct CollisionTotals {
    /// Collisions of pairs.
    pub(super) collisions: u64,
    /// Collisions made elastic by the contact duration.
    pub(super) made_elastic: u64,
    /// Σ impulse · distance (mass · length²/time).
    pub(super) virial: f64,
    /// Energy given by sides, less the energy lost in collisions.
    pub(super) work: f64,
    /// Action of all completed flights (energy · time).
    action: f64,
}

/// Sums at the beginning or end of an interval.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct IntervalMark {
    /// Time of the mark.
    time: f64,
    collisions: u64,
    virial: f64,
    /// Action of all flights up to now (energy · time).
    action: f64,
}

/// Total motion of the discs at a moment.
#[derive(Clone, Copy, Debug)]
pub(super) struct TotalMotion {
    pub(super) count: f64,
    pub(super) mass: f64,
    pub(super) axes: [AxisMotion; 2],
    /// Axes along which the momentum is conserved.
    pub(super) conserved: [bool; 2],
}

/// Means over an interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct IntervalMeans {
    pub(super) compressibility: f64,
    pub(super) collision_rate: f64,
}

impl TotalMotion {
    /// Sums the motion of discs at a time.
    pub(super) fn of<'d>(
        discs: impl Iterator<Item = &'d FlyingDisc>,
        arena: &Arena,
        time: f64,
    ) -> TotalMotion {
        let conserved = arena.conserved_axes();
        let mut motion = TotalMotion { count: 0.0, mass: 0.0, axes: [AxisMotion::default(); 2], conserved };
        for disc in discs {
            motion.count += 1.0;
            motion.mass += disc.mass;
            for (axis, v) in motion.axes.iter_mut().zip(disc.velocity_at(&arena.space, time)) {
                axis.twice_kinetic += disc.mass * v * v;
                axis.momentum += disc.mass * v;
            }
        }
        motion
    }

    /// Temperature kT (energy).
    pub(super) fn temperature(&self) -> f64 {
        temperature(self.axes, self.conserved, self.mass, self.count)
    }

    /// Kinetic energy.
    pub(super) fn kinetic(&self) -> f64 {
        0.5 * self.axes.iter().map(|axis| axis.twice_kinetic).sum::<f64>()
    }
}

impl CollisionTotals {
    /// Adds an event.
    #[inline]
    pub(super) fn add(&mut self, happened: &ExecutedEvent) {
        if let Some(impact) = happened.impact {
            self.collisions += 1;
            self.made_elastic += u64::from(impact.was_made_elastic);
            self.virial += impact.virial;
        }
        self.work += happened.work;
        self.action += happened.action;
    }

    /// Completes the flights of discs at a time that is no event.
    pub(super) fn end_flights<'d>(
        &mut self,
        arena: &Arena,
        discs: impl Iterator<Item = &'d FlyingDisc>,
        time: f64,
    ) {
        if !arena.keeps_kinetic {
            self.action += discs.map(|disc| arena.action(disc, time)).sum::<f64>();
        }
    }

    /// Returns the sums at a time, including the flights in progress.
    pub(super) fn mark<'d>(
        &self,
        arena: &Arena,
        discs: impl Iterator<Item = &'d FlyingDisc>,
        motion: &TotalMotion,
        time: f64,
    ) -> IntervalMark {
        let action = match arena.keeps_kinetic {
            true => 2.0 * motion.kinetic() * time,
            false => self.action + discs.map(|disc| arena.action(disc, time)).sum::<f64>(),
        };
        IntervalMark { time, collisions: self.collisions, virial: self.virial, action }
    }

    /// Adds the sums to a checkpoint.
    pub(super) fn keep(&self, kept: &mut Snapshot) {
        kept.add_count("collisions", self.collisions);
        kept.add_count("made_elastic", self.made_elastic);
        kept.add_sum("virial", self.virial);
        kept.add_sum("work", self.work);
        kept.add_sum("action", self.action);
    }

    /// Reads the sums from a checkpoint written after `events` events.
    ///
    /// # Errors
    /// A message if one is missing.
    pub(super) fn totals_from_snapshot(kept: &Snapshot, events: u64) -> Result<CollisionTotals, String> {
        let collisions = kept.count_at_most("collisions", events)?;
        Ok(CollisionTotals {
            collisions,
            made_elastic: kept.count_at_most("made_elastic", collisions)?,
            virial: kept.sum("virial")?,
            work: kept.sum("work")?,
            action: kept.sum("action")?,
        })
    }
}

impl IntervalMark {
    /// Means over the interval from an earlier mark. Without a collision, or over no time, they are those of an ideal gas.
    pub(super) fn since(&self, before: &IntervalMark, motion: &TotalMotion) -> IntervalMeans {
        let (duration, collisions) = (self.time - before.time, self.collisions - before.collisions);
        if collisions == 0 || duration <= 0.0 {
            return IntervalMeans { compressibility: 1.0, collision_rate: 0.0 };
        }
        // The action sums both axes, so the first axis carries all of ⟨Σ m v²⟩.
        let [x, y] = motion.axes.map(|axis| axis.momentum);
        let twice_kinetic = (self.action - before.action) / duration;
        let axes =
            [AxisMotion { twice_kinetic, momentum: x }, AxisMotion { twice_kinetic: 0.0, momentum: y }];
        let mean_temperature = TotalMotion { axes, ..*motion }.temperature();
        IntervalMeans {
            compressibility: 1.0
                + (self.virial - before.virial) / (2.0 * motion.count * mean_temperature * duration),
            collision_rate: 2.0 * collisions as f64 / (motion.count * duration),
        }
    }

    /// Adds the mark to a checkpoint, under names that begin with `name`.
    pub(super) fn keep(&self, name: &str, kept: &mut Snapshot) {
        kept.add_sum(&format!("{name}.time"), self.time);
        kept.add_count(&format!("{name}.collisions"), self.collisions);
        kept.add_sum(&format!("{name}.virial"), self.virial);
        kept.add_sum(&format!("{name}.action"), self.action);
    }

    /// Reads the mark from a checkpoint.
    ///
    /// # Errors
    /// A message if it is missing or later than the sums.
    pub(super) fn mark_from_snapshot(
        name: &str,
        kept: &Snapshot,
        totals: &CollisionTotals,
    ) -> Result<IntervalMark, String> {
        Ok(IntervalMark {
            time: kept.sum(&format!("{name}.time"))?,
            collisions: kept.count_at_most(&format!("{name}.collisions"), totals.collisions)?,
            virial: kept.sum(&format!("{name}.virial"))?,
            action: kept.sum(&format!("{name}.action"))?,
        })
    }
}
