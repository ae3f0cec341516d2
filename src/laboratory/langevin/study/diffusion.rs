//! Mean square displacement and velocities of particles in a bath, beside exact results.

use super::{Mean, PARTS};
use crate::laboratory::running::Running;
use crate::results::{Meter, Progress};
use crate::statistics::kolmogorov_smirnov;
use crate::study::StudyError;
use serde::Serialize;
use stripmine_physics::method::langevin::keys::{INTEGRATOR, LAW};
use stripmine_physics::method::langevin::options::{PairLaw, SchemeKind};
use stripmine_physics::particles::Particle;
use stripmine_physics::scene::{COUNT, DT, Overrides, SIDES};
use stripmine_physics::words::Words;

/// The systems of the source's figures 3 to 6: particles and side (length).
pub const SYSTEMS: [(u64, f64); 4] = [(1000, 50.0), (1000, 100.0), (1000, 1000.0), (40_000, 100.0)];
/// The step of runs with pairs (time), their duration, and looks at them for each factor of ten.
const STEP: f64 = 0.001;
const DURATION: f64 = 30.0;
const LOOKS: f64 = 8.0;
/// Steps at which the bath's temperature is looked at, over m/γ.
const STEPS: [f64; 6] = [0.01, 0.03, 0.1, 0.3, 0.6, 1.0];

/// ⟨r²⟩ from a thermal start, with D = kT/γ and τ = m/γ of 1.
pub fn exact(time: f64) -> f64 {
    4.0 * (time - 1.0 + (-time).exp())
}

/// A system with pairs, followed.
#[derive(Clone, Debug, Serialize)]
pub struct Followed {
    /// Particles.
    pub particles: u64,
    /// Side of the box (length).
    pub side: f64,
    /// Times.
    pub times: Vec<f64>,
    /// ⟨r²⟩ by positions as if there were no sides, and by those inside the box (length²).
    pub square: Vec<[f64; 2]>,
    /// The probability by Kolmogorov and Smirnov that the velocities at the end are Maxwell's, and the temperature.
    pub maxwell: [f64; 2],
}

/// Temperature of free particles by a scheme.
#[derive(Clone, Debug, Serialize)]
pub struct Heated {
    /// The integrator.
    pub scheme: &'static str,
    /// Step over m/γ.
    pub dt: f64,
    /// Temperature over that of the bath.
    pub temperature: Mean,
    /// The probability that the velocities at the end are those of the bath.
    pub maxwell: f64,
}

/// What came out.
#[derive(Clone, Debug, Serialize)]
pub struct Diffusion {
    /// The systems with pairs.
    pub systems: Vec<Followed>,
    /// The same number of particles without pairs: the first system.
    pub free: Followed,
    /// Temperatures over the step.
    pub heated: Vec<Heated>,
}

/// Follows every system.
///
/// # Errors
/// [`StudyError`] if a scene breaks.
pub fn diffusion(progress: Progress<'_>) -> Result<Diffusion, StudyError> {
    let schemes = [SchemeKind::Stochastic, SchemeKind::AsPrinted, SchemeKind::Baoab];
    let cases: Vec<(SchemeKind, f64)> =
        schemes.into_iter().flat_map(|scheme| STEPS.map(|dt| (scheme, dt))).collect();
    let meter = Meter::new((SYSTEMS.len() + 1 + cases.len()) as f64, progress);
    let systems =
        meter.each_from_last(&SYSTEMS, |&(particles, side)| followed(particles, side, PairLaw::Wca))?;
    let free = followed(SYSTEMS[0].0, SYSTEMS[0].1, PairLaw::None)?;
    meter.add(1.0);
    let heated = meter.each(&cases, |&(scheme, dt)| heated(scheme, dt))?;
    Ok(Diffusion { systems, free, heated })
}

fn followed(particles: u64, side: f64, law: PairLaw) -> Result<Followed, StudyError> {
    let overrides =
        Overrides::new().set(&COUNT, particles).set(&SIDES, [side; 2]).set(&LAW, law).set(&DT, STEP);
    let mut running = Running::begin("langevin-report", &overrides)?;
    let start = running.simulation.particles();
    let (mut times, mut square) = (vec![], vec![]);
    let mut look = 0.0;
    loop {
        let time = 0.01 * 10f64.powf(look / LOOKS);
        if time > DURATION {
            break;
        }
        look += 1.0;
        let wanted = (time / STEP).round() as u64;
        running.steps(wanted.saturating_sub(running.simulation.clock().steps))?;
        let now = running.simulation.particles();
        let inside = now.all().iter().zip(start.all()).map(|(now, start)| {
            let [x, y] = [0, 1].map(|axis| now.position[axis] - start.position[axis]);
            x * x + y * y
        });
        let inside = inside.sum::<f64>() / particles as f64;
        times.push(running.simulation.clock().time);
        square.push([running.observed(["msd"])?[0], inside]);
    }
    Ok(Followed {
        particles,
        side,
        times,
        square,
        maxwell: [maxwell(&running), running.observed(["temperature"])?[0]],
    })
}

/// The probability that the components of the velocities are those of a bath of kT = m = 1.
fn maxwell(running: &Running) -> f64 {
    let particles = running.simulation.particles();
    let components = particles.all().iter().flat_map(Particle::planar_velocity);
    kolmogorov_smirnov(components.collect(), |x| 0.5 * libm::erfc(-x / 2f64.sqrt()))
}

fn heated(scheme: SchemeKind, dt: f64) -> Result<Heated, StudyError> {
    let overrides = Overrides::new().set(&COUNT, 4000_u64).set(&INTEGRATOR, scheme).set(&DT, dt);
    let mut running = Running::begin("langevin-free", &overrides)?;
    // Looks five times m/γ apart.
    let between = (5.0 / dt).ceil() as u64;
    let mut temperatures = vec![];
    running.steps(2 * between)?;
    for _ in 0..PARTS {
        running.steps(between)?;
        temperatures.push(running.observed(["temperature"])?[0]);
    }
    Ok(Heated {
        scheme: scheme.word(),
        dt,
        temperature: Mean::of_course(&temperatures),
        maxwell: maxwell(&running),
    })
}
