//! The error of the step: energy, pressure and temperatures of a Lennard-Jones fluid over dt, by both integrators.

use super::{Mean, PARTS};
use crate::laboratory::running::Running;
use crate::results::{Meter, Progress};
use crate::study::StudyError;
use serde::Serialize;
use std::time::Instant;
use stripmine_physics::domain::Domain;
use stripmine_physics::method::langevin::keys::INTEGRATOR;
use stripmine_physics::method::langevin::options::SchemeKind;
use stripmine_physics::particles::{Particle, Particles};
use stripmine_physics::scene::{DT, Overrides};
use stripmine_physics::words::Words;

/// Steps (time), nearly up to the one at which particles are lost, 0.025.
const STEPS: [f64; 6] = [0.005, 0.01, 0.015, 0.0175, 0.02, 0.0225];
/// The integrators.
const SCHEMES: [SchemeKind; 2] = [SchemeKind::Stochastic, SchemeKind::Baoab];
/// Looks in a unit of time.
const LOOKS: f64 = 4.0;
/// The cut-off of the pairs, in diameters; a diameter, ε, the masses and kT are 1.
const REACH: f64 = 2.5;

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
    /// Kinetic energy a particle and dimension, over that of the bath, as it is observed: by baoab after the bath.
    pub temperature: Mean,
    /// The same of the velocities at the end of the step.
    pub at_end: Mean,
    /// What is observed less that, look by look: by baoab what the last half of the kick cools.
    pub cooling: Mean,
    /// ⟨F²⟩/⟨∇²U⟩, which is kT where places are Boltzmann's.
    pub configurational: Mean,
    /// ⟨∇²U⟩ a particle and dimension (energy/length²).
    pub curvature: Mean,
    /// Wall seconds for a unit of time.
    pub cost: f64,
    /// Whether it came to its end; particles were lost otherwise.
    pub is_whole: bool,
}

impl Fluid {
    /// By how much theory has the end of the step colder: dt² kT⟨∇²U⟩/(4 m) by baoab, nothing by the source's scheme, whose velocities
    /// have kT there (exactly in a harmonic trap).
    pub fn foreseen(&self) -> Mean {
        let factor = if self.scheme == SchemeKind::Baoab.word() { 0.25 * self.dt * self.dt } else { 0.0 };
        Mean { value: factor * self.curvature.value, bar: factor * self.curvature.bar }
    }
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

/// The energy at dt = 0, by a line over dt².
fn limit(fluids: &[Fluid]) -> Mean {
    let of = fluids.iter().filter(|fluid| fluid.scheme == SchemeKind::Baoab.word() && fluid.is_whole);
    let points: Vec<(f64, Mean)> = of.map(|fluid| (fluid.dt.powi(2), fluid.potential)).collect();
    line(&points)[0]
}

/// Height at 0 and slope of the straight line through points that are known to their bars, of at least two places.
pub fn line(points: &[(f64, Mean)]) -> [Mean; 2] {
    let (mut w, mut wx, mut wy, mut wxx, mut wxy) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for &(x, Mean { value: y, bar }) in points {
        let weight = bar.powi(-2);
        (w, wx, wy, wxx, wxy) =
            (w + weight, wx + weight * x, wy + weight * y, wxx + weight * x * x, wxy + weight * x * y);
    }
    let determinant = w * wxx - wx * wx;
    let height = Mean { value: (wxx * wy - wx * wxy) / determinant, bar: (wxx / determinant).sqrt() };
    [height, Mean { value: (w * wxy - wx * wy) / determinant, bar: (w / determinant).sqrt() }]
}

fn fluid(scheme: SchemeKind, dt: f64, time: f64) -> Result<Fluid, StudyError> {
    let overrides = Overrides::new().set(&INTEGRATOR, scheme).set(&DT, dt);
    let mut running = Running::begin("langevin-dense", &overrides)?;
    let count = running.simulation.particles().len() as f64;
    // The mesh melts within some units of time.
    let mut done = running.steps((50.0 / dt) as u64);
    let (looks, between) = ((LOOKS * time / PARTS as f64) as usize, (1.0 / (LOOKS * dt)).round() as u64);
    let mut parts: [Vec<f64>; 7] = Default::default();
    let mut cost = 0.0;
    for _ in 0..PARTS {
        let mut sums = [0.0; 5];
        for _ in 0..looks {
            let begun = Instant::now();
            done = done.and_then(|()| running.steps(between));
            cost += begun.elapsed().as_secs_f64() / (between as f64 * dt * (PARTS * looks) as f64);
            let [potential, pressure, temperature] =
                running.observed(["potential", "pressure", "temperature"])?;
            let at_end = kinetic(&running.simulation.particles());
            let seen = [potential / count, pressure, temperature, at_end, temperature - at_end];
            sums.iter_mut().zip(seen).for_each(|(sum, seen)| *sum += seen / looks as f64);
        }
        let [square, curvature] = forces(&running.simulation.particles(), &running.domain);
        let means = sums.into_iter().chain([square / curvature, curvature]);
        parts.iter_mut().zip(means).for_each(|(parts, mean)| parts.push(mean));
    }
    let [potential, pressure, temperature, at_end, cooling, configurational, curvature] =
        parts.map(|parts| Mean::of_course(&parts));
    let (scheme, is_whole) = (scheme.word(), done.is_ok());
    Ok(Fluid {
        scheme,
        dt,
        potential,
        pressure,
        temperature,
        at_end,
        cooling,
        configurational,
        curvature,
        cost,
        is_whole,
    })
}

/// m⟨v²⟩ a particle and dimension, by the velocities as they stand.
fn kinetic(particles: &Particles) -> f64 {
    let squares = particles.all().iter().map(Particle::planar_velocity).map(|[u, v]| u * u + v * v);
    squares.sum::<f64>() / (2 * particles.len()) as f64
}

/// ⟨F²⟩ and ⟨∇²U⟩ a particle and dimension, of all pairs nearer than the cut-off.
fn forces(particles: &Particles, domain: &Domain) -> [f64; 2] {
    let places: Vec<[f64; 2]> = particles.all().iter().map(Particle::place).collect();
    let mut forces = vec![[0.0; 2]; places.len()];
    let mut curvature = 0.0;
    for (first, &from) in places.iter().enumerate() {
        for (second, &to) in places.iter().enumerate().skip(first + 1) {
            let way = domain.displacement(from, to);
            let square = way[0] * way[0] + way[1] * way[1];
            if square >= REACH * REACH {
                continue;
            }
            let sixth = square.powi(-3);
            let repulsion = 24.0 * sixth * (2.0 * sixth - 1.0) / square;
            // U″ + U′/r in the plane, of each of the two.
            curvature += 2.0 * 144.0 * sixth * (4.0 * sixth - 1.0) / square;
            for axis in 0..2 {
                forces[first][axis] -= repulsion * way[axis];
                forces[second][axis] += repulsion * way[axis];
            }
        }
    }
    let square: f64 = forces.iter().map(|[x, y]| x * x + y * y).sum();
    [square, curvature].map(|sum| sum / (2 * places.len()) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laboratory::running::prepared;
    use stripmine_physics::scene::COUNT;

    /// Height and slope of an exact line, and the bars of two points of one bar.
    #[test]
    fn lines_go_through_their_points() {
        let at = |x: f64, bar: f64| (x, Mean { value: 3.0 - 2.0 * x, bar });
        let [height, slope] = line(&[at(0.0, 0.1), at(1.0, 0.1), at(4.0, 0.3)]);
        assert!((height.value - 3.0).abs() < 1e-12 && (slope.value + 2.0).abs() < 1e-12);
        let [height, slope] = line(&[at(0.0, 0.1), at(1.0, 0.1)]);
        assert!((height.bar - 0.1).abs() < 1e-12 && (slope.bar - 0.1 * 2f64.sqrt()).abs() < 1e-12);
    }

    /// Force and curvature are those of the differences of the energy, also across the sides of the box.
    #[test]
    fn forces_and_curvature_are_differences_of_the_energy() {
        let prepared = prepared("langevin-dense", &Overrides::new().set(&COUNT, 300_u64)).unwrap();
        let (start, domain) = (prepared.particles().all().to_vec(), prepared.domain);
        let energy = |all: &[Particle]| -> f64 {
            let pairs = all.iter().enumerate().flat_map(|(at, a)| all[at + 1..].iter().map(move |b| (a, b)));
            let distances = pairs.map(|(a, b)| domain.distance(a.place(), b.place()));
            distances.filter(|r| *r < REACH).map(|r| 4.0 * (r.powi(-12) - r.powi(-6))).sum()
        };
        let (step, middle) = (1e-4, energy(&start));
        let mut expected = [0.0; 2];
        for disc in 0..start.len() {
            for axis in 0..2 {
                let moved = |by: f64| {
                    let mut all = start.clone();
                    all[disc].position[axis] += by;
                    energy(&all)
                };
                let [up, down] = [moved(step), moved(-step)];
                expected[0] += ((up - down) / (2.0 * step)).powi(2);
                expected[1] += (up - 2.0 * middle + down) / (step * step);
            }
        }
        let found = forces(&Particles::new(start), &domain);
        for (found, sum) in found.into_iter().zip(expected) {
            let expected = sum / 600.0;
            assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
        }
    }
}
