//! Bias of a step estimated from single collisions of two particles of the scene. Each collision is compared with one at a far shorter step, averaged
//! over the phase within a step at which the contact begins. A relative error of collisions causes about the same relative error of means, and needs
//! no long run.

use super::findings::{MeasuredConfiguration, SceneTrials};
use super::mean::TrialMean;
use crate::study::StudyCase;
use crate::study::state::delayed_scene;
use std::sync::atomic::Ordering;
use stripmine_physics::domain::Domain;
use stripmine_physics::method::{EncounterGeometry, StartPurpose, Until};
use stripmine_physics::particles::{Particle, Particles};
use stripmine_physics::scene::Overrides;

/// Impact parameters, in sums of the radii: equally likely in a plane.
const OFFSETS: [f64; 4] = [0.125, 0.375, 0.625, 0.875];
/// Phases within a step at which contacts begin.
const PHASES: u32 = 8;
/// The step of the reference, in parts of the step.
const REFERENCE: f64 = 1.0 / 32.0;
/// Most steps of a collision.
const MOST: f64 = 2e4;
/// Collisions that lose less than this part of the energy count as elastic.
const LOSSLESS: f64 = 1e-3;

/// Change in a collision: velocity of the first particle and speed of its surface (length/time), and the part of the energy lost.
#[derive(Clone, Copy, Debug, Default)]
struct CollisionChange {
    impulse: [f64; 3],
    lost: f64,
}

impl SceneTrials<'_> {
    /// Returns the relative error of collisions at a step of a configuration, in impulses and spin and in the energy lost. None where particles do
    /// not touch or a collision fails.
    pub(super) fn error_of_collisions(
        &self,
        configuration: &MeasuredConfiguration,
        step: f64,
        mean: &TrialMean,
    ) -> Option<f64> {
        let trials = self.case.entry.trials?;
        let speed = mean_approach_speed(&mean.states, &self.case.prepared.domain);
        let reference = self.choice(configuration).with(trials.references[0]).overrides();
        let (mut off, mut all, mut lost) = ([0.0; 3], 0.0, [0.0; 2]);
        for offset in OFFSETS {
            let text = (trials.encounter)(&self.case.prepared, EncounterGeometry { speed, offset })?;
            let case = self.case.with_text_of(&text).ok()?;
            // Grains at rest hardly collide.
            if case.duration()? > MOST * step {
                return None;
            }
            let exact =
                self.collision_change(&case, reference.clone().set(trials.step, REFERENCE * step), 0.0)?;
            let overrides = configuration.choice(&case).overrides().set(trials.step, step);
            let mut own = CollisionChange::default();
            for phase in 0..PHASES {
                let late = f64::from(phase) / f64::from(PHASES) * step;
                let change = self.collision_change(&case, overrides.clone(), late)?;
                for (sum, part) in own.impulse.iter_mut().zip(change.impulse) {
                    *sum += part / f64::from(PHASES);
                }
                own.lost += change.lost / f64::from(PHASES);
            }
            for ((off, own), exact) in off.iter_mut().zip(own.impulse).zip(exact.impulse) {
                *off += (own - exact).abs();
                all += exact.abs();
            }
            lost = [lost[0] + own.lost - exact.lost, lost[1] + exact.lost];
        }
        let of_impulse = off.iter().sum::<f64>() / all;
        let of_loss = if lost[1] > LOSSLESS * OFFSETS.len() as f64 { (lost[0] / lost[1]).abs() } else { 0.0 };
        Some(of_impulse.max(of_loss)).filter(|part| part.is_finite())
    }

    /// Runs a collision delayed by a time.
    fn collision_change(&self, case: &StudyCase, overrides: Overrides, late: f64) -> Option<CollisionChange> {
        let prepared = case.prepared_with(&overrides).ok()?;
        let prepared = delayed_scene(&prepared, late);
        let mut simulation = prepared.start(StartPurpose::Run).ok()?;
        let end = Until::Time(case.duration()?);
        simulation.advance(&[end], self.trial.stop).ok()?;
        let is_over = end.has_been_reached(&simulation.clock()) && !self.trial.stop.load(Ordering::Relaxed);
        // Particles that do not rotate have no rotational energy.
        let inertia =
            self.case.entry.trials.and_then(|trials| (trials.inertia)(&self.case.values)).unwrap_or(0.0);
        let energy = |particles: &Particles| {
            let of = |it: &Particle| {
                let [x, y] = it.planar_velocity();
                it.mass * (x * x + y * y + inertia * (it.omega * it.radius).powi(2))
            };
            particles.grains().iter().map(of).sum::<f64>()
        };
        let (before, after) = (prepared.particles(), simulation.particles());
        let [own, now] = [before.grains().first()?, after.grains().first()?];
        let [u, v] = [own.planar_velocity(), now.planar_velocity()];
        is_over.then(|| CollisionChange {
            impulse: [v[0] - u[0], v[1] - u[1], (now.omega - own.omega) * own.radius],
            lost: 1.0 - energy(&after) / energy(before),
        })
    }
}

/// Most particles of a state that are paired with their nearest neighbour, and most states.
const LOOKED_AT: [usize; 2] = [64, 8];

/// Speed at which neighbours approach (length/time): root mean square of the velocity of each particle relative to its nearest neighbour.
fn mean_approach_speed(states: &[Particles], domain: &Domain) -> f64 {
    let some = states.iter().step_by(states.len().div_ceil(LOOKED_AT[1]).max(1));
    let all: Vec<f64> = some.flat_map(|state| squared_relative_speeds(state, domain)).collect();
    (all.iter().sum::<f64>() / all.len() as f64).sqrt()
}

/// Squared velocities of some particles relative to their nearest neighbour (length²/time²).
fn squared_relative_speeds(state: &Particles, domain: &Domain) -> Vec<f64> {
    let grains = state.grains();
    let every = grains.len().div_ceil(LOOKED_AT[0]).max(1);
    let of = |own: &Particle| {
        let distance = |other: &Particle| {
            let [x, y] = domain.displacement(own.planar_position(), other.planar_position());
            x.hypot(y) - other.radius
        };
        let others = grains.iter().filter(|other| other.id != own.id);
        let next = others.min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        let [u, v] = [own, next].map(Particle::planar_velocity);
        Some((u[0] - v[0]).powi(2) + (u[1] - v[1]).powi(2))
    };
    grains.iter().step_by(every).filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_physics::method::{METHODS, load};

    /// Two discs that approach at 1, each the other's nearest; with a state of half that speed the mean square is (1 + 0.25)/2.
    #[test]
    fn the_speed_of_approach_is_that_of_neighbours() {
        let (prepared, _) = load("two-discs", &[], METHODS).unwrap();
        let fast = prepared.particles().clone();
        assert!((mean_approach_speed(std::slice::from_ref(&fast), &prepared.domain) - 1.0).abs() < 1e-12);
        let mut slow = fast.clone();
        slow.all_mut()[0].velocity[0] = 0.5;
        let both = mean_approach_speed(&[fast, slow], &prepared.domain);
        assert!((both - f64::sqrt(0.625)).abs() < 1e-12, "{both}");
    }
}
