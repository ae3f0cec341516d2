//! The error of the step: energy and pressure of a Lennard-Jones fluid over dt, by both integrators.

use super::{Mean, PARTS};
use crate::laboratory::running::Running;
use crate::results::{Meter, Progress};
use crate::study::StudyError;
use serde::Serialize;
use std::time::Instant;
use stripmine_physics::method::langevin::keys::INTEGRATOR;
use stripmine_physics::method::langevin::options::SchemeKind;
use stripmine_physics::scene::{DT, Overrides};
use stripmine_physics::words::Words;

/// Steps (time); the shortest is the reference of both integrators together.
const STEPS: [f64; 5] = [0.0025, 0.005, 0.0075, 0.01, 0.0125];
/// The integrators.
const SCHEMES: [SchemeKind; 2] = [SchemeKind::Stochastic, SchemeKind::Baoab];

/// A fluid at a step.
#[derive(Clone, Debug, Serialize)]
pub struct Fluid {
    /// The integrator.
    pub scheme: &'static str,
    /// Step (time).
    pub dt: f64,
    /// Energy of the pairs over the particles (energy).
    pub potential: Mean,
    /// Pressure (force/length).
    pub pressure: Mean,
    /// Kinetic energy a particle and dimension, over that of the bath.
    pub temperature: Mean,
    /// Wall seconds for a unit of time.
    pub cost: f64,
    /// Whether it came to its end; particles were lost otherwise.
    pub is_whole: bool,
}

/// What came out.
#[derive(Clone, Debug, Serialize)]
pub struct Accuracy {
    /// Particles.
    pub particles: usize,
    /// The time that is measured over.
    pub time: f64,
    /// The fluids.
    pub fluids: Vec<Fluid>,
    /// Energy over the particles in the limit of short steps, by a fit of the BAOAB energies with dt² (energy).
    pub limit: Mean,
}

/// Measures every step over a time.
///
/// # Errors
/// [`StudyError`] if a scene is refused.
pub fn accuracy(time: f64, progress: Progress<'_>) -> Result<Accuracy, StudyError> {
    let cases: Vec<(SchemeKind, f64)> =
        STEPS.iter().flat_map(|&dt| SCHEMES.map(|scheme| (scheme, dt))).collect();
    let meter = Meter::new(cases.len() as f64, progress);
    let fluids = meter.each(&cases, |&(scheme, dt)| fluid(scheme, dt, time))?;
    let particles = Running::timed("langevin-dense", &[])?.simulation.particles().len();
    let limit = limit(&fluids);
    Ok(Accuracy { particles, time, fluids, limit })
}

/// The energy at dt = 0 and its error by a weighted line over dt².
fn limit(fluids: &[Fluid]) -> Mean {
    let of = fluids.iter().filter(|fluid| fluid.scheme == SchemeKind::Baoab.word() && fluid.is_whole);
    let (mut w, mut wx, mut wy, mut wxx, mut wxy) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for fluid in of {
        let (x, y, weight) = (fluid.dt.powi(2), fluid.potential.value, fluid.potential.bar.powi(-2));
        (w, wx, wy, wxx, wxy) =
            (w + weight, wx + weight * x, wy + weight * y, wxx + weight * x * x, wxy + weight * x * y);
    }
    let determinant = w * wxx - wx * wx;
    Mean { value: (wxx * wy - wx * wxy) / determinant, bar: (wxx / determinant).sqrt() }
}

fn fluid(scheme: SchemeKind, dt: f64, time: f64) -> Result<Fluid, StudyError> {
    let overrides = Overrides::new().set(&INTEGRATOR, scheme).set(&DT, dt);
    let mut running = Running::begin("langevin-dense", &overrides)?;
    let count = running.simulation.particles().len() as f64;
    // The mesh melts within some units of time.
    let mut done = running.steps((50.0 / dt) as u64);
    let (looks, between) = ((time / PARTS as f64) as usize, (1.0 / dt).round() as u64);
    let mut parts = [vec![], vec![], vec![]];
    let begun = Instant::now();
    for _ in 0..PARTS {
        let mut sums = [0.0; 3];
        for _ in 0..looks {
            done = done.and_then(|()| running.steps(between));
            let seen = running.observed(["potential", "pressure", "temperature"])?;
            sums.iter_mut().zip(seen).for_each(|(sum, seen)| *sum += seen / looks as f64);
        }
        let [potential, pressure, temperature] = sums;
        let means = [potential / count, pressure, temperature];
        parts.iter_mut().zip(means).for_each(|(parts, mean)| parts.push(mean));
    }
    let cost = begun.elapsed().as_secs_f64() / (PARTS * looks) as f64;
    let [potential, pressure, temperature] = parts.map(|parts| Mean::of(&parts));
    Ok(Fluid { scheme: scheme.word(), dt, potential, pressure, temperature, cost, is_whole: done.is_ok() })
}
