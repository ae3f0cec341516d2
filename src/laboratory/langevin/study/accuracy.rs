//! Step bias: energy, pressure and temperatures of a Lennard-Jones fluid against dt, with both integrators.

use super::PARTS;
use crate::console::CommandFailure;
use crate::frame::{FrameBuilder, TableCell};
use crate::laboratory::running::RunningScene;
use crate::results::{FinishedItem, ProgressMeter, StudyEnvironment, StudySize};
use crate::statistics::{MeanWithBar, student};
use crate::study::StudyError;
use std::time::Instant;
use stripmine_physics::domain::Domain;
use stripmine_physics::method::langevin::keys::INTEGRATOR;
use stripmine_physics::method::langevin::options::SchemeKind;
use stripmine_physics::particles::{Particle, Particles};
use stripmine_physics::scene::{DT, Overrides};
use stripmine_physics::words::Words;

/// Steps (time), up to just below the step at which particles are lost, 0.025.
const STEPS: [f64; 6] = [0.005, 0.01, 0.015, 0.0175, 0.02, 0.0225];
const SCHEMES: [SchemeKind; 2] = [SchemeKind::Stochastic, SchemeKind::Baoab];
/// Measured time.
const TIME: f64 = 640.0;
/// Samples per unit of time.
const SAMPLES: f64 = 4.0;
/// Cut-off of the pairs, in diameters; a diameter, ε, the masses and kT are 1.
const REACH: f64 = 2.5;
/// Minimum number of significant errors for fitting an order, and largest half-width of a reported order.
const LEAST: usize = 3;
const ORDER_WITHIN: f64 = 0.5;

/// Measurements of the fluid with one scheme and step.
struct FluidAtStep {
    scheme: SchemeKind,
    dt: f64,
    /// Pair energy per particle (energy).
    potential: MeanWithBar,
    /// Pressure (force/length).
    pressure: MeanWithBar,
    /// Observed kinetic temperature over that of the bath; with baoab it is sampled after the bath.
    temperature: MeanWithBar,
    /// Temperature of the velocities at the end of the step.
    at_end: MeanWithBar,
    /// Difference of the two, sample by sample: with baoab the cooling of the last half kick.
    cooling: MeanWithBar,
    /// ⟨F²⟩/⟨∇²U⟩, which is kT for Boltzmann-distributed positions.
    configurational: MeanWithBar,
    /// ⟨∇²U⟩ per particle and dimension (energy/length²).
    curvature: MeanWithBar,
    /// Wall seconds per unit of time.
    cost: f64,
    /// True if no particle was lost.
    is_whole: bool,
}

impl FluidAtStep {
    /// Theoretical cooling: dt² kT⟨∇²U⟩/(4 m) with baoab, zero with LAN17's scheme, whose velocities have kT at the end of the step (exactly in
    /// a harmonic trap).
    fn theoretical_cooling(&self) -> MeanWithBar {
        let factor = if self.scheme == SchemeKind::Baoab { 0.25 * self.dt * self.dt } else { 0.0 };
        MeanWithBar { value: factor * self.curvature.value, bar: factor * self.curvature.bar }
    }

    /// Difference of measured and theoretical cooling in standard errors; `None` with LAN17's scheme.
    fn cooling_deviation(&self) -> Option<f64> {
        let error = self.cooling.bar.hypot(self.theoretical_cooling().bar) / student(0.95, PARTS - 1);
        (self.theoretical_cooling().value > 0.0)
            .then(|| (self.cooling.value - self.theoretical_cooling().value) / error)
    }

    /// Error of the energy relative to the limit of short steps, including the half-width of the limit.
    fn error(&self, limit: MeanWithBar) -> MeanWithBar {
        MeanWithBar { value: self.potential.value - limit.value, bar: self.potential.bar.hypot(limit.bar) }
    }
}

/// Measures every step.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let cases: Vec<(SchemeKind, f64)> =
        STEPS.iter().flat_map(|&dt| SCHEMES.map(|scheme| (scheme, dt))).collect();
    let meter = ProgressMeter::new(cases.len() as f64, lab.progress);
    let fluids = meter.run_cases(&cases, |&(scheme, dt)| measure_fluid(scheme, dt))?;
    let limit = short_step_energy(&fluids);
    let orders = SCHEMES.map(|scheme| error_order(&fluids, scheme, limit));
    let cell = |MeanWithBar { value, bar }: MeanWithBar| TableCell::with_error(value, Some(bar), 4);
    Ok(FinishedItem::of([
        FrameBuilder::of(&fluids)
            .text("scheme", |it| it.scheme.word())
            .number("dt", 4, |it| it.dt)
            .mean("energy", 4, |it| it.potential)
            .mean("pressure", 4, |it| it.pressure)
            .mean("temperature", 4, |it| it.temperature)
            .number("at the end of the step", 4, |it| it.at_end.value)
            .number("by theory", 4, |it| 1.0 - it.theoretical_cooling().value)
            .mean("colder by", 4, |it| it.cooling)
            .number("by theory", 4, |it| it.theoretical_cooling().value)
            .number("standard errors off", 1, |it| it.cooling_deviation())
            .mean("⟨F²⟩/⟨∇²U⟩", 3, |it| it.configurational)
            .number("⟨∇²U⟩/2", 1, |it| it.curvature.value)
            .number("ms a unit of time", 1, |it| 1e3 * it.cost)
            .frame("accuracy", "Energy of the pairs a particle, pressure and temperatures"),
        FrameBuilder::of(fluids.iter().filter(|it| it.is_whole))
            .text("scheme", |it| it.scheme.word())
            .number("dt", 4, |it| it.dt)
            .number("wall time of a unit of time (s)", 4, |it| it.cost)
            .cell("error of the energy", |it| cell(it.error(limit)))
            .cell("temperature", |it| cell(it.temperature))
            .cell("at the end of the step", |it| cell(it.at_end))
            .cell("by theory", |it| {
                cell(MeanWithBar { value: 1.0 - it.theoretical_cooling().value, ..it.theoretical_cooling() })
            })
            .cell("⟨F²⟩/⟨∇²U⟩", |it| cell(it.configurational))
            .frame("errors", "Error of the energy, and temperatures, of runs that lost no particle"),
        FrameBuilder::of([()])
            .mean("energy at short steps", 4, |()| limit)
            .mean("order of stochastic", 1, |()| orders[0])
            .mean("order of BAOAB", 1, |()| orders[1])
            .frame("summary", "Limit of short steps, and orders of the errors"),
    ])
    .with_seeds([1]))
}

/// Energy at dt = 0, from a linear fit in dt² to the energies of BAOAB.
fn short_step_energy(fluids: &[FluidAtStep]) -> MeanWithBar {
    let of = fluids.iter().filter(|fluid| fluid.scheme == SchemeKind::Baoab && fluid.is_whole);
    let points: Vec<(f64, MeanWithBar)> = of.map(|fluid| (fluid.dt.powi(2), fluid.potential)).collect();
    weighted_line(&points)[0]
}

/// Order of a scheme's error in the step. `None` if fewer than three errors exceed their half-widths, or if the order is known too poorly.
fn error_order(fluids: &[FluidAtStep], scheme: SchemeKind, limit: MeanWithBar) -> Option<MeanWithBar> {
    let of = fluids.iter().filter(|it| it.scheme == scheme && it.is_whole);
    let seen = of.map(|it| (it.dt, it.error(limit))).filter(|(_, error)| error.value.abs() > error.bar);
    let logarithm = |MeanWithBar { value, bar }: MeanWithBar| MeanWithBar {
        value: value.abs().ln(),
        bar: bar / value.abs(),
    };
    let points: Vec<(f64, MeanWithBar)> = seen.map(|(dt, error)| (dt.ln(), logarithm(error))).collect();
    let [_, slope] = (points.len() >= LEAST).then(|| weighted_line(&points))?;
    (slope.bar < ORDER_WITHIN).then_some(slope)
}

/// Intercept and slope of the weighted least-squares line through at least two points with half-widths.
fn weighted_line(points: &[(f64, MeanWithBar)]) -> [MeanWithBar; 2] {
    let (mut w, mut wx, mut wy, mut wxx, mut wxy) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for &(x, MeanWithBar { value: y, bar }) in points {
        let weight = bar.powi(-2);
        (w, wx, wy, wxx, wxy) =
            (w + weight, wx + weight * x, wy + weight * y, wxx + weight * x * x, wxy + weight * x * y);
    }
    let determinant = w * wxx - wx * wx;
    let height = MeanWithBar { value: (wxx * wy - wx * wxy) / determinant, bar: (wxx / determinant).sqrt() };
    [height, MeanWithBar { value: (w * wxy - wx * wy) / determinant, bar: (w / determinant).sqrt() }]
}

fn measure_fluid(scheme: SchemeKind, dt: f64) -> Result<FluidAtStep, StudyError> {
    let overrides = Overrides::new().set(&INTEGRATOR, scheme).set(&DT, dt);
    let mut running = RunningScene::begin("langevin-dense", &overrides)?;
    let count = running.simulation.particles().len() as f64;
    // The initial mesh melts within some units of time.
    let mut done = running.advance_steps((50.0 / dt) as u64);
    let (samples, between) =
        ((SAMPLES * TIME / PARTS as f64) as usize, (1.0 / (SAMPLES * dt)).round() as u64);
    let mut parts: [Vec<f64>; 7] = Default::default();
    let mut cost = 0.0;
    for _ in 0..PARTS {
        let mut sums = [0.0; 5];
        for _ in 0..samples {
            let begun = Instant::now();
            done = done.and_then(|()| running.advance_steps(between));
            cost += begun.elapsed().as_secs_f64() / (between as f64 * dt * (PARTS * samples) as f64);
            let [potential, pressure, temperature] =
                running.observed_values(["potential", "pressure", "temperature"])?;
            let at_end = kinetic_temperature(&running.simulation.particles());
            let seen = [potential / count, pressure, temperature, at_end, temperature - at_end];
            sums.iter_mut().zip(seen).for_each(|(sum, seen)| *sum += seen / samples as f64);
        }
        let [square, curvature] =
            squared_force_and_curvature(&running.simulation.particles(), &running.domain);
        let means = sums.into_iter().chain([square / curvature, curvature]);
        parts.iter_mut().zip(means).for_each(|(parts, mean)| parts.push(mean));
    }
    let [potential, pressure, temperature, at_end, cooling, configurational, curvature] =
        parts.map(|parts| MeanWithBar::of_time_series(&parts));
    let is_whole = done.is_ok();
    Ok(FluidAtStep {
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

/// m⟨v²⟩ per particle and dimension, from the present velocities.
fn kinetic_temperature(particles: &Particles) -> f64 {
    let squares = particles.all().iter().map(Particle::planar_velocity).map(|[u, v]| u * u + v * v);
    squares.sum::<f64>() / (2 * particles.len()) as f64
}

/// ⟨F²⟩ and ⟨∇²U⟩ per particle and dimension, over all pairs within the cut-off.
fn squared_force_and_curvature(particles: &Particles, domain: &Domain) -> [f64; 2] {
    let places: Vec<[f64; 2]> = particles.all().iter().map(Particle::planar_position).collect();
    let mut forces = vec![[0.0; 2]; places.len()];
    let mut curvature = 0.0;
    for (first, &from) in places.iter().enumerate() {
        for (second, &to) in places.iter().enumerate().skip(first + 1) {
            let displacement = domain.displacement(from, to);
            let square = displacement[0] * displacement[0] + displacement[1] * displacement[1];
            if square >= REACH * REACH {
                continue;
            }
            let sixth = square.powi(-3);
            let repulsion = 24.0 * sixth * (2.0 * sixth - 1.0) / square;
            // U″ + U′/r in the plane, for both particles.
            curvature += 2.0 * 144.0 * sixth * (4.0 * sixth - 1.0) / square;
            for axis in 0..2 {
                forces[first][axis] -= repulsion * displacement[axis];
                forces[second][axis] += repulsion * displacement[axis];
            }
        }
    }
    let square: f64 = forces.iter().map(|[x, y]| x * x + y * y).sum();
    [square, curvature].map(|sum| sum / (2 * places.len()) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laboratory::running::prepare_preset;
    use stripmine_physics::scene::COUNT;

    /// Fluids with BAOAB whose energies have the error `factor` dt² and the half-width `bar`. Their velocities at the end of the step are
    /// colder than in theory by `off`.
    fn fluids(factor: f64, bar: f64, off: f64) -> Vec<FluidAtStep> {
        let mean = |value: f64| MeanWithBar { value, bar };
        let fluid = |dt: f64| FluidAtStep {
            scheme: SchemeKind::Baoab,
            dt,
            potential: mean(-1.0 + factor * dt * dt),
            pressure: mean(1.0),
            temperature: mean(1.0),
            at_end: mean(1.0),
            cooling: mean(100.0 * dt * dt + off),
            configurational: mean(1.0),
            curvature: mean(400.0),
            cost: 1.0,
            is_whole: true,
        };
        [0.0025, 0.005, 0.01, 0.02].map(fluid).into()
    }

    #[test]
    fn order_within_the_noise_is_none() {
        let known = fluids(100.0, 1e-5, 0.0);
        let MeanWithBar { value, bar } =
            error_order(&known, SchemeKind::Baoab, short_step_energy(&known)).unwrap();
        assert!((value - 2.0).abs() < 0.05 && bar < 0.05, "{value} {bar}");
        let lost = fluids(1.0, 1e-3, 0.0);
        assert!(error_order(&lost, SchemeKind::Baoab, short_step_energy(&lost)).is_none());
    }

    #[test]
    fn cooling_is_compared_with_theory() {
        let off = |off: f64| fluids(100.0, 1e-5, off)[3].cooling_deviation().unwrap();
        assert!(off(0.0).abs() < 1e-9 && off(0.001) > 3.0, "{} {}", off(0.0), off(0.001));
    }

    /// Intercept and slope of an exact line, and the error bars for two points with equal error bars.
    #[test]
    fn lines_go_through_their_points() {
        let at = |x: f64, bar: f64| (x, MeanWithBar { value: 3.0 - 2.0 * x, bar });
        let [height, slope] = weighted_line(&[at(0.0, 0.1), at(1.0, 0.1), at(4.0, 0.3)]);
        assert!((height.value - 3.0).abs() < 1e-12 && (slope.value + 2.0).abs() < 1e-12);
        let [height, slope] = weighted_line(&[at(0.0, 0.1), at(1.0, 0.1)]);
        assert!((height.bar - 0.1).abs() < 1e-12 && (slope.bar - 0.1 * 2f64.sqrt()).abs() < 1e-12);
    }

    /// Force and curvature equal finite differences of the energy, also across the sides of the box.
    #[test]
    fn forces_and_curvature_are_energy_differences() {
        let prepared = prepare_preset("langevin-dense", &Overrides::new().set(&COUNT, 300_u64)).unwrap();
        let (start, domain) = (prepared.particles().all().to_vec(), prepared.domain);
        let energy = |all: &[Particle]| -> f64 {
            let pairs = all.iter().enumerate().flat_map(|(at, a)| all[at + 1..].iter().map(move |b| (a, b)));
            let distances = pairs.map(|(a, b)| domain.distance(a.planar_position(), b.planar_position()));
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
        let found = squared_force_and_curvature(&Particles::new(start), &domain);
        for (found, sum) in found.into_iter().zip(expected) {
            let expected = sum / 600.0;
            assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
        }
    }
}
