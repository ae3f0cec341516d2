//! Mean square displacement and velocities of particles in a bath, beside exact results.

use super::{Mean, PARTS};
use crate::console::Failure;
use crate::laboratory::running::Running;
use crate::results::Progress;
use crate::statistics::kolmogorov_smirnov;
use rayon::iter::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};
use serde::Serialize;
use std::sync::atomic::{AtomicUsize, Ordering};
use stripmine_physics::method::langevin::options::SchemeKind;
use stripmine_physics::particles::Particle;
use stripmine_physics::words::Words;

/// The systems of the source's figures 3 to 6: particles and side (length).
pub const SYSTEMS: [(u64, f64); 4] = [(1000, 50.0), (1000, 100.0), (1000, 1000.0), (40_000, 100.0)];
/// The step of runs with pairs (time), their duration, and looks at them for each factor of ten.
const DT: f64 = 0.001;
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
/// [`Failure`] if a scene breaks.
pub fn diffusion(progress: Progress<'_>) -> Result<Diffusion, Failure> {
    let schemes = [SchemeKind::Stochastic, SchemeKind::AsPrinted, SchemeKind::Baoab];
    let cases: Vec<(SchemeKind, f64)> =
        schemes.into_iter().flat_map(|scheme| STEPS.map(|dt| (scheme, dt))).collect();
    let (done, all) = (AtomicUsize::new(0), (SYSTEMS.len() + 1 + cases.len()) as f64);
    let tick = || progress((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / all);
    // The largest first.
    let mut systems = SYSTEMS
        .par_iter()
        .rev()
        .map(|&(particles, side)| {
            let followed = followed(particles, side, "wca")?;
            tick();
            Ok(followed)
        })
        .collect::<Result<Vec<Followed>, Failure>>()?;
    systems.reverse();
    let free = followed(SYSTEMS[0].0, SYSTEMS[0].1, "none")?;
    tick();
    let heated = cases.par_iter().map(|&(scheme, dt)| {
        let heated = heated(scheme, dt)?;
        tick();
        Ok(heated)
    });
    Ok(Diffusion { systems, free, heated: heated.collect::<Result<_, Failure>>()? })
}

fn followed(particles: u64, side: f64, law: &str) -> Result<Followed, Failure> {
    let overrides = [
        format!("particles.count={particles}"),
        format!("domain.sides=[{side:?}, {side:?}]"),
        format!("law.kind={law}"),
        format!("integrator.dt={DT:?}"),
    ];
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
        let wanted = (time / DT).round() as u64;
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

fn heated(scheme: SchemeKind, dt: f64) -> Result<Heated, Failure> {
    let overrides = [
        "particles.count=4000".to_owned(),
        format!("integrator.kind={}", scheme.word()),
        format!("integrator.dt={dt:?}"),
    ];
    let mut running = Running::begin("langevin-free", &overrides)?;
    // Looks five times m/γ apart.
    let between = (5.0 / dt).ceil() as u64;
    let mut temperatures = vec![];
    running.steps(2 * between)?;
    for _ in 0..PARTS {
        running.steps(between)?;
        temperatures.push(running.observed(["temperature"])?[0]);
    }
    Ok(Heated { scheme: scheme.word(), dt, temperature: Mean::of(&temperatures), maxwell: maxwell(&running) })
}
