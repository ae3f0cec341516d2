//! How long a step may be, by theory.

use super::options::{PairLaw, SchemeKind};
use super::scene::Scene;
use crate::method::{Beyond, StepLimit};
use crate::number::significant;

/// The energy, in kT, of the hardest collisions that are looked at: of a million pairs about fifty meet harder.
const HARDEST: f64 = 10.0;

/// The limits of a scene with particles of a diameter (length) and a mass.
pub(super) fn step_limits(scene: &Scene, diameter: f64, mass: f64) -> Vec<StepLimit> {
    let dt = scene.dt;
    let limit = |name, step: f64, beyond, why: String| StepLimit {
        name,
        step,
        share: dt / step,
        warned_beyond: 1.0,
        beyond,
        why,
    };
    let mut limits = vec![];
    if scene.law != PairLaw::None {
        let (step, force) = bound(scene, diameter, mass);
        limits.push(limit("source-bound", step, Beyond::Unstable, {
            format!(
                "√(2 m r_c/F) with F = 24 ε/σ = {}: necessary, by far not sufficient",
                significant(force, 5)
            )
        }));
        let (step, nearest) = stiffest(scene, diameter, mass);
        limits.push(limit("hardest-collision", step, Beyond::Unstable, {
            format!(
                "2 √(m/(2 U″)) where the potential is {HARDEST} kT, at {:.3} diameters: the pair's spring there throws particles out",
                nearest / diameter
            )
        }));
    }
    if scene.bath.friction > 0.0 && scene.scheme != SchemeKind::Baoab {
        let step = 2.0 * mass / scene.bath.friction;
        limits.push(limit(
            "friction",
            step,
            Beyond::Unstable,
            "2 m/γ: friction reverses the velocity".to_owned(),
        ));
    }
    limits
}

/// The source's bound (time), and the force in it.
pub(super) fn bound(scene: &Scene, diameter: f64, mass: f64) -> (f64, f64) {
    let force = 24.0 * scene.strength / diameter;
    let cutoff = diameter * scene.law.cutoff().unwrap_or(1.0);
    ((2.0 * mass * cutoff / force).sqrt(), force)
}

/// The step (time) at which velocity Verlet loses the spring that a pair is at the end of its hardest collisions, and how near the two are
/// then (length).
fn stiffest(scene: &Scene, diameter: f64, mass: f64) -> (f64, f64) {
    let energy = (HARDEST * scene.bath.temperature).max(scene.strength) / scene.strength;
    // 4 ε (x² − x) = E with x = (σ/r)⁶.
    let x = 0.5 * (1.0 + (1.0 + energy).sqrt());
    let nearest = diameter * x.powf(-1.0 / 6.0);
    let curvature = 4.0 * scene.strength * (156.0 * x * x - 42.0 * x) / (nearest * nearest);
    (2.0 * (0.5 * mass / curvature).sqrt(), nearest)
}
