//! A cold sphere that falls in on itself.

use crate::laboratory::running::Running;
use crate::results::{Meter, Progress};
use crate::study::StudyError;
use serde::Serialize;
use stripmine_physics::method::nbody::keys::{COUNT, SEED};
use stripmine_physics::particles::{Particle, Particles};
use stripmine_physics::scene::Overrides;

/// Bodies.
pub const BODIES: usize = 2048;
/// Looks, and steps between them.
const LOOKS: u64 = 320;
const BETWEEN: u64 = 8;
/// From this time on the bodies that are bound are looked at: they have swung several times.
pub const LATE: f64 = 6.0;
/// Bodies that are shown.
const SHOWN: usize = 700;
/// Seeds of the start.
pub const SEEDS: [u64; 4] = [1, 2, 3, 4];

/// The sphere at a moment.
#[derive(Clone, Debug, Serialize)]
pub struct Moment {
    /// The time.
    pub time: f64,
    /// Kinetic over potential energy.
    pub virial_ratio: f64,
    /// Radius of half of the mass.
    pub half_mass_radius: f64,
    /// ΔE/E.
    pub energy_error: f64,
    /// Magnitude of the momentum.
    pub momentum: f64,
    /// Positions along x and y and the speed of the first bodies.
    #[serde(skip)]
    pub bodies: Vec<([f64; 2], f64)>,
}

/// The bodies that are still bound.
#[derive(Clone, Debug, Serialize)]
pub struct Bound {
    /// The time.
    pub time: f64,
    /// The part of all bodies that they are.
    pub share: f64,
    /// Their kinetic over their potential energy, about their own mean motion.
    pub virial_ratio: f64,
    /// Their kinetic energy over Σ r·F, Clausius' virial, which is the potential energy where nothing is softened.
    pub clausius_ratio: f64,
}

/// A sphere.
#[derive(Clone, Debug, Serialize)]
pub struct Collapse {
    /// Seed of its start.
    pub seed: u64,
    /// Bound bodies at late moments.
    pub bound: Vec<Bound>,
    /// Moments, from the start on.
    pub moments: Vec<Moment>,
}

/// Follows a sphere of each seed.
///
/// # Errors
/// [`StudyError`] if a scene breaks.
pub fn collapses(progress: Progress<'_>) -> Result<Vec<Collapse>, StudyError> {
    let meter = Meter::new(SEEDS.len() as f64, progress);
    meter.each(&SEEDS, |&seed| collapse(seed))
}

fn collapse(seed: u64) -> Result<Collapse, StudyError> {
    let mut running =
        Running::timed("cold-collapse", &Overrides::new().set(&COUNT, BODIES).set(&SEED, seed))?;
    let (mut moments, mut late) = (vec![], vec![]);
    for look in 0..=LOOKS {
        if look > 0 {
            running.steps(BETWEEN)?;
        }
        let names = ["time", "virial_ratio", "half_mass_radius", "energy_error", "momentum"];
        let [time, virial_ratio, half_mass_radius, energy_error, momentum] = running.observed(names)?;
        let particles = running.simulation.particles();
        let seen = particles.all().iter().take(SHOWN).map(|body| {
            let [x, y, _] = body.position;
            ([x, y], body.velocity.iter().map(|v| v * v).sum::<f64>().sqrt())
        });
        let bodies = seen.collect();
        if time > LATE && look.is_multiple_of(8) {
            late.push(bound(time, &particles));
        }
        moments.push(Moment { time, virial_ratio, half_mass_radius, energy_error, momentum, bodies });
    }
    Ok(Collapse { seed, bound: late, moments })
}

/// The bodies that stay when those whose energy is positive are taken away, again and again.
fn bound(time: f64, particles: &Particles) -> Bound {
    // As the preset has it.
    const SOFTENING: f64 = 0.03;
    let mut inside: Vec<&Particle> = particles.all().iter().collect();
    loop {
        let mass: f64 = inside.iter().map(|body| body.mass).sum();
        let drift: [f64; 3] = [0, 1, 2]
            .map(|axis| inside.iter().map(|body| body.mass * body.velocity[axis]).sum::<f64>() / mass);
        let energies = inside.iter().map(|body| {
            let speed: f64 = (0..3).map(|axis| (body.velocity[axis] - drift[axis]).powi(2)).sum();
            let others = inside.iter().filter(|other| other.id != body.id).map(|other| {
                let square: f64 =
                    (0..3).map(|axis| (body.position[axis] - other.position[axis]).powi(2)).sum();
                let softened = square + SOFTENING * SOFTENING;
                let potential = -other.mass / softened.sqrt();
                [potential, potential * square / softened]
            });
            let [potential, virial] = others.fold([0.0; 2], |sum, more| [sum[0] + more[0], sum[1] + more[1]]);
            [0.5 * speed, potential, virial]
        });
        let energies: Vec<[f64; 3]> = energies.collect();
        let before = inside.len();
        if energies.iter().all(|[kinetic, potential, _]| kinetic + potential < 0.0) {
            let sum = |which: usize| {
                inside.iter().zip(&energies).map(|(body, energies)| body.mass * energies[which]).sum::<f64>()
            };
            let [virial_ratio, clausius_ratio] = [1, 2].map(|which| sum(0) / (0.5 * sum(which)).abs());
            let share = before as f64 / particles.len() as f64;
            return Bound { time, share, virial_ratio, clausius_ratio };
        }
        let stays = energies.iter().map(|[kinetic, potential, _]| kinetic + potential < 0.0);
        inside = inside.into_iter().zip(stays).filter(|(_, stays)| *stays).map(|(body, _)| body).collect();
    }
}
