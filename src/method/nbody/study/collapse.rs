//! A cold sphere that falls in on itself.

use super::Running;
use crate::console::Failure;
use crate::method::Progress;
use serde::Serialize;

/// Bodies.
pub const BODIES: usize = 2048;
/// Looks, and steps between them.
const LOOKS: u64 = 160;
const BETWEEN: u64 = 8;
/// Bodies of the film.
const SHOWN: usize = 700;

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

/// What came out.
#[derive(Clone, Debug, Serialize)]
pub struct Collapse {
    /// Moments, from the start on.
    pub moments: Vec<Moment>,
}

/// Follows the sphere.
///
/// # Errors
/// [`Failure`] if the scene breaks.
pub fn collapse(progress: Progress<'_>) -> Result<Collapse, Failure> {
    let mut running = Running::begin("cold-collapse", &[format!("particles.count={BODIES}")])?;
    let mut moments = vec![];
    for look in 0..=LOOKS {
        if look > 0 {
            running.steps(BETWEEN)?;
        }
        let names = ["time", "virial_ratio", "half_mass_radius", "energy_error", "momentum"];
        let [time, virial_ratio, half_mass_radius, energy_error, momentum] = running.observed(names);
        let particles = running.0.particles();
        let seen = particles.all().iter().take(SHOWN).map(|body| {
            let [x, y, _] = body.position;
            ([x, y], body.velocity.iter().map(|v| v * v).sum::<f64>().sqrt())
        });
        let bodies = seen.collect();
        moments.push(Moment { time, virial_ratio, half_mass_radius, energy_error, momentum, bodies });
        progress(look as f64 / LOOKS as f64);
    }
    Ok(Collapse { moments })
}
