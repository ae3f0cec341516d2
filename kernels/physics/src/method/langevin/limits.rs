//! Theoretical stability limits of the step.

use super::options::SchemeKind;
use super::scene::LangevinScene;
use crate::method::{LimitConsequence, StepLimit};
use crate::number::significant;
use std::f64::consts::PI;

/// Lower bound of the hardest collision energy considered, in kT: about fifty of a million pairs collide harder.
const HARDEST: f64 = 10.0;

/// Particles of one species in a run.
#[derive(Clone, Copy, Debug)]
pub(super) struct CollidingParticles {
    pub(super) diameter: f64,
    pub(super) mass: f64,
    pub(super) count: usize,
    /// Area of the box.
    pub(super) area: f64,
}

pub(super) fn step_limits(scene: &LangevinScene, particles: CollidingParticles) -> Vec<StepLimit> {
    let (dt, CollidingParticles { diameter, mass, .. }) = (scene.dt, particles);
    let limit = |name, step: f64, beyond, why: String| StepLimit {
        name,
        step,
        share: dt / step,
        warned_beyond: 1.0,
        beyond,
        why,
    };
    let mut limits = vec![];
    if scene.law.has_pairs() {
        let (step, force) = lan17_step_bound(scene, diameter, mass);
        limits.push(limit("source-bound", step, LimitConsequence::Unstable, {
            format!(
                "√(2 m r_c/F) with F = {} at a distance of σ: necessary, but far from sufficient",
                significant(force, 5)
            )
        }));
        let energy = hardest_collision_energy(scene, particles);
        let (step, nearest) = stiffest_pair_limit(scene, particles, energy);
        limits.push(limit("hardest-collision", step, LimitConsequence::Unstable, {
            format!(
                "2 √(m/(2 U″)) where the potential is {} kT, at {:.3} diameters: a longer step ejects pairs of this stiffness",
                significant(energy, 3),
                nearest / diameter
            )
        }));
    }
    // A table may attract at σ, or have no stiffness.
    limits.retain(|limit: &StepLimit| limit.step.is_finite());
    if scene.bath.friction > 0.0 && scene.scheme != SchemeKind::Baoab {
        let step = 2.0 * mass / scene.bath.friction;
        limits.push(limit(
            "friction",
            step,
            LimitConsequence::Unstable,
            "2 m/γ: with a longer step friction reverses the velocity".to_owned(),
        ));
    }
    limits
}

/// LAN17's bound of the step (time), and the force in it.
pub(super) fn lan17_step_bound(scene: &LangevinScene, diameter: f64, mass: f64) -> (f64, f64) {
    let law = scene.law_at(diameter);
    let force = law.potential().force(diameter);
    ((2.0 * mass * law.cutoff() / force).sqrt(), force)
}

/// Energy, in kT, of the hardest collision expected in a run: one in M collisions exceeds ln M.
///
/// Each of N particles collides 2 √π n σ √(kT/m) times per unit of time at a number density n, as in a dilute gas. The logarithm hardly depends on this rate.
pub(super) fn hardest_collision_energy(
    scene: &LangevinScene,
    CollidingParticles { diameter, mass, count, area }: CollidingParticles,
) -> f64 {
    let [count, time] = [count as f64, scene.run.steps as f64 * scene.dt];
    let rate = 2.0 * (PI * scene.bath.temperature / mass).sqrt() * diameter * count / area;
    libm::log(0.5 * count * rate * time).max(HARDEST)
}

/// Stability limit (time) of velocity Verlet for the stiffness of a pair at the end of its hardest collision, of an energy in kT; and the
/// distance of the two there (length).
fn stiffest_pair_limit(
    scene: &LangevinScene,
    CollidingParticles { diameter, mass, .. }: CollidingParticles,
    energy: f64,
) -> (f64, f64) {
    let law = scene.law_at(diameter);
    let nearest = law.potential().closest((energy * scene.bath.temperature).max(scene.parameters.strength));
    (2.0 * (0.5 * mass / law.potential().stiffness(nearest)).sqrt(), nearest)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Calculated by hand: 1000 particles of density 1 collide 3.545 times each in a time of 1, as half as many pairs. In a time of 1000 the hardest has
    /// ln(1772.5 · 1000) = 14.388 kT. With ε = kT, x = (1 + √15.388)/2 = 2.4614; U″ = 4 (156 x² − 42 x) x^(1/3) = 4546.0; the step is 2 √(1/(2 U″)) = 0.020975.
    #[test]
    fn longer_runs_have_harder_collisions() {
        let of_time = |time: f64| {
            let mut scene = LangevinScene { dt: 0.01, ..LangevinScene::default() };
            scene.run.steps = (time / scene.dt).round() as u64;
            let particles = CollidingParticles { diameter: 1.0, mass: 1.0, count: 1000, area: 1000.0 };
            (
                hardest_collision_energy(&scene, particles),
                stiffest_pair_limit(&scene, particles, hardest_collision_energy(&scene, particles)).0,
            )
        };
        let (energy, step) = of_time(1000.0);
        assert!((energy - 14.388).abs() < 1e-3, "{energy}");
        assert!((step - 0.020_975).abs() < 1e-5, "{step}");
        assert_eq!(of_time(1.0).0, HARDEST);
    }
}
