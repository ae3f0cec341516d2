//! Mean square displacement and velocities of particles in a heat bath, compared with exact results.

use super::PARTS;
use crate::console::CommandFailure;
use crate::frame::{FrameBuilder, TableCell};
use crate::laboratory::running::RunningScene;
use crate::results::{FinishedItem, ProgressMeter, StudyEnvironment, StudySize};
use crate::statistics::MeanWithBar;
use crate::study::StudyError;
use std::f64::consts::PI;
use stripmine_physics::method::langevin::keys::INTEGRATOR;
use stripmine_physics::method::langevin::laws::{LAW, PairLaw};
use stripmine_physics::method::langevin::options::SchemeKind;
use stripmine_physics::scene::{COUNT, DT, Overrides, SIDES};
use stripmine_physics::words::Words;

/// Systems of LAN17, figures 3 to 6: particles and side (length).
const SYSTEMS: [(u64, f64); 4] = [(1000, 50.0), (1000, 100.0), (1000, 1000.0), (40_000, 100.0)];
/// σ of LAN17 (length).
const DIAMETER: f64 = 0.1;
/// Step of runs with pairs (time), their duration, and samples in each factor of ten.
const STEP: f64 = 0.001;
const DURATION: f64 = 30.0;
const SAMPLES: f64 = 8.0;
/// Steps at which the temperature of free particles is measured, over m/γ.
const STEPS: [f64; 6] = [0.01, 0.03, 0.1, 0.3, 0.6, 1.0];
/// Time from which velocities are collected, width of a bin, and number of bins on either side of 0.
const THERMAL: f64 = 3.0;
const BIN: f64 = 0.25;
const BINS: i32 = 16;
/// Particles of the starts on a mesh of 890 × 890 positions.
const STARTS: [u64; 4] = [1000, 40_000, 400_000, 890 * 890];
/// Half-width of a 95 % interval in standard errors.
const WIDTH: f64 = 1.96;

/// Exact ⟨r²⟩ of free particles from a thermal start, with D = kT/γ = 1 and τ = m/γ = 1.
fn exact_displacement(time: f64) -> f64 {
    4.0 * (time - 1.0 + (-time).exp())
}

/// Time series of one system.
struct SystemSeries {
    particles: u64,
    side: f64,
    has_pairs: bool,
    times: Vec<f64>,
    /// ⟨r²⟩ from unwrapped positions and from positions inside the box (length²).
    square: Vec<[f64; 2]>,
    /// Probability of the Kolmogorov–Smirnov test that the final velocities have Maxwell's distribution.
    maxwell: f64,
    /// Mean square of the velocity components at the end.
    temperature: f64,
    /// Velocity components at the samples from the time 3 on: more than m/γ apart, and so independent.
    velocities: Vec<f64>,
}

impl SystemSeries {
    fn name(&self) -> String {
        let pairs = if self.has_pairs { "" } else { ", no pairs" };
        format!("N = {}, L = {}{pairs}", self.particles, self.side)
    }

    /// Ratio of ⟨r²⟩ to the exact value without pairs, at the last sample up to `time`.
    fn ratio_to_exact(&self, time: f64) -> f64 {
        let within = self.times.iter().filter(|it| **it <= time * (1.0 + 1e-9)).count();
        self.square[within - 1][0] / exact_displacement(self.times[within - 1])
    }

    /// Enskog's prediction of this ratio at a time: collisions of discs of diameter σ add the friction 2 n σ χ √(π m kT) to γ, with χ the
    /// pair distribution at contact (Henderson); kT = m = γ = 1.
    fn enskog_ratio(&self, time: f64) -> f64 {
        let density = self.particles as f64 / (self.side * self.side);
        let packing = 0.25 * PI * density * DIAMETER * DIAMETER;
        let contact = (1.0 - 7.0 / 16.0 * packing) / (1.0 - packing).powi(2);
        let friction = 1.0 + 2.0 * density * DIAMETER * contact * PI.sqrt();
        exact_displacement(friction * time) / (friction * friction) / exact_displacement(time)
    }

    /// First time at which wrapped positions double the mean square displacement.
    fn doubling(&self) -> Option<f64> {
        let doubled = |[unwrapped, wrapped]: &[f64; 2]| *wrapped > 2.0 * unwrapped;
        self.square.iter().position(doubled).map(|at| self.times[at])
    }

    /// Probability density of the velocity components in a bin, with its standard error.
    fn density(&self, bin: f64) -> [f64; 2] {
        let count = self.velocities.iter().filter(|v| (**v - bin).abs() < 0.5 * BIN).count() as f64;
        let all = self.velocities.len() as f64 * BIN;
        [count / all, count.sqrt() / all]
    }

    fn end(&self) -> f64 {
        self.times.last().copied().unwrap_or_default()
    }

    /// Relative standard error of a mean square. The square of a planar Gaussian vector has a standard deviation equal to its mean.
    fn standard_error(&self) -> f64 {
        (self.particles as f64).sqrt().recip()
    }

    fn variance(&self) -> TableCell {
        TableCell::with_error(self.temperature, Some(WIDTH * self.standard_error() * self.temperature), 4)
    }
}

/// Temperature of free particles over that of the bath, with a scheme and a step in units of m/γ.
struct HeatingPoint {
    scheme: SchemeKind,
    dt: f64,
    temperature: MeanWithBar,
    maxwell: f64,
}

/// Simulates every system.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let schemes = [SchemeKind::Stochastic, SchemeKind::AsPrinted, SchemeKind::Baoab];
    let cases: Vec<(SchemeKind, f64)> =
        schemes.into_iter().flat_map(|scheme| STEPS.map(|dt| (scheme, dt))).collect();
    let meter = ProgressMeter::new((SYSTEMS.len() + 1 + cases.len()) as f64, lab.progress);
    let mut systems =
        meter.run_cases_from_last(&SYSTEMS, |&(particles, side)| simulate_system(particles, side, true))?;
    systems.push(simulate_system(SYSTEMS[0].0, SYSTEMS[0].1, false)?);
    meter.add(1.0);
    let heated = meter.run_cases(&cases, |&(scheme, dt)| measure_heating(scheme, dt))?;
    let starts = STARTS.into_iter().map(mesh_start).collect::<Result<Vec<_>, _>>()?;
    let [thin, dense, free] = [2, 3, 4].map(|at| &systems[at]);
    let off = thin.times.iter().map(|time| (thin.ratio_to_exact(*time) - 1.0).abs() / thin.standard_error());
    let heating = heated.iter().filter(|it| it.scheme != SchemeKind::AsPrinted);
    let heating = heating.map(|it| ((it.temperature.value - 1.0) / it.temperature.bar).abs());
    let samples = systems.iter().flat_map(|it| (0..it.times.len()).map(move |at| (it, at)));
    Ok(FinishedItem::of([
        FrameBuilder::of(&systems)
            .text("system", |it| it.name())
            .number("over exact at 0.1", 3, |it| it.ratio_to_exact(0.1))
            .number("at 1", 3, |it| it.ratio_to_exact(1.0))
            .number("at the end", 3, |it| it.ratio_to_exact(f64::INFINITY))
            .number("by Enskog", 3, |it| it.has_pairs.then(|| it.enskog_ratio(it.end())))
            .number("relative standard error", 3, |it| it.standard_error())
            .number("time", 2, |it| it.end())
            .number("⟨r²⟩", 3, |it| it.square[it.times.len() - 1][0])
            .number("⟨r²⟩ wrapped", 3, |it| it.square[it.times.len() - 1][1])
            .number("first doubled by wrapping", 3, |it| it.doubling())
            .number("temperature", 4, |it| it.temperature)
            .number("p of Maxwell", 3, |it| it.maxwell)
            .frame("displacements", "Displacements over those without pairs, and velocities at the end"),
        FrameBuilder::of(samples)
            .text("system", |(it, _)| it.name())
            .number("time", 3, |(it, at)| it.times[*at])
            .number("mean square displacement", 4, |(it, at)| it.square[*at][0])
            .number("by wrapped positions", 4, |(it, at)| it.square[*at][1])
            .number("without pairs, exact", 4, |(it, at)| exact_displacement(it.times[*at]))
            .cell("over the exact one", |(it, at)| {
                let ratio = it.square[*at][0] / exact_displacement(it.times[*at]);
                TableCell::with_error(ratio, Some(WIDTH * it.standard_error() * ratio), 3)
            })
            .number("by Enskog", 3, |(it, at)| it.has_pairs.then(|| it.enskog_ratio(it.times[*at])))
            .frame("over-time", "Mean square displacement over the time"),
        FrameBuilder::of((-BINS..=BINS).map(|bin| BIN * f64::from(bin)))
            .number("velocity", 2, |bin| *bin)
            .cell("with pairs", |bin| density_cell(dense, *bin))
            .cell("without pairs", |bin| density_cell(free, *bin))
            .number("Maxwell", 4, |bin| (-0.5 * bin * bin).exp() / (2.0 * PI).sqrt())
            .frame("velocities", "Probability density of the velocity components"),
        FrameBuilder::of(STARTS.into_iter().zip(starts))
            .count("particles", |(count, _)| *count)
            .number("potential energy", 3, |(_, energy)| *energy)
            .frame("starts", "Starts on a shuffled mesh in a box of 100"),
        FrameBuilder::of(&heated)
            .text("scheme", |it| it.scheme.word())
            .number("step over m/γ", 2, |it| it.dt)
            .cell("temperature over that of the bath", |it| {
                TableCell::with_error(it.temperature.value, Some(it.temperature.bar), 4)
            })
            .number("p of Maxwell", 3, |it| it.maxwell)
            .frame("heating", "Temperature of free particles"),
        FrameBuilder::of((0..=60).map(|at| 10f64.powf(-2.0 + f64::from(at) / 30.0)))
            .number("step over m/γ", 3, |dt| *dt)
            .number("temperature over that of the bath", 4, |dt| 1.0 / (1.0 - 0.5 * dt))
            .frame("theory", "Temperature by 1/(1 − γ dt/2m)"),
        FrameBuilder::of([()])
            .cell("velocity variance with pairs", |()| dense.variance())
            .cell("velocity variance without pairs", |()| free.variance())
            .number("p of Maxwell with pairs", 3, |()| dense.maxwell)
            .number("p of Maxwell without pairs", 3, |()| free.maxwell)
            .number("standard errors off, thinnest system", 1, |()| off.clone().fold(0.0, f64::max))
            .number("temperature off (half-widths)", 1, |()| heating.clone().fold(0.0, f64::max))
            .frame("summary", "Velocities with and without pairs, and largest differences from theory"),
    ])
    .with_seeds([1]))
}

fn simulate_system(particles: u64, side: f64, has_pairs: bool) -> Result<SystemSeries, StudyError> {
    let law = if has_pairs { PairLaw::Wca } else { PairLaw::None };
    let overrides =
        Overrides::new().set(&COUNT, particles).set(&SIDES, [side; 2]).set(&LAW, law).set(&DT, STEP);
    let mut running = RunningScene::begin("langevin-report", &overrides)?;
    let start = running.simulation.particles();
    let (mut times, mut square, mut velocities) = (vec![], vec![], vec![]);
    for sample in 0.. {
        let time = 0.01 * 10f64.powf(f64::from(sample) / SAMPLES);
        if time > DURATION {
            break;
        }
        let wanted = (time / STEP).round() as u64;
        running.advance_steps(wanted.saturating_sub(running.simulation.clock().steps))?;
        let now = running.simulation.particles();
        let inside = now.all().iter().zip(start.all()).map(|(now, start)| {
            let [x, y] = [0, 1].map(|axis| now.position[axis] - start.position[axis]);
            x * x + y * y
        });
        let inside = inside.sum::<f64>() / particles as f64;
        if time >= THERMAL {
            velocities.extend(now.all().iter().flat_map(|it| it.planar_velocity()));
        }
        times.push(running.simulation.clock().time);
        square.push([running.observed_values(["msd"])?[0], inside]);
    }
    let [temperature] = running.observed_values(["temperature"])?;
    Ok(SystemSeries {
        particles,
        side,
        has_pairs,
        times,
        square,
        maxwell: running.maxwell_probability(1.0),
        temperature,
        velocities,
    })
}

/// Potential energy at the start on a mesh.
fn mesh_start(particles: u64) -> Result<f64, StudyError> {
    let running = RunningScene::begin("langevin-report", &Overrides::new().set(&COUNT, particles))?;
    Ok(running.observed_values(["potential"])?[0])
}

fn density_cell(system: &SystemSeries, bin: f64) -> TableCell {
    let [density, error] = system.density(bin);
    TableCell::with_error(density, Some(WIDTH * error), 4)
}

fn measure_heating(scheme: SchemeKind, dt: f64) -> Result<HeatingPoint, StudyError> {
    let overrides = Overrides::new().set(&COUNT, 4000_u64).set(&INTEGRATOR, scheme).set(&DT, dt);
    let mut running = RunningScene::begin("langevin-free", &overrides)?;
    // Samples are 5 m/γ apart.
    let between = (5.0 / dt).ceil() as u64;
    let mut temperatures = vec![];
    running.advance_steps(2 * between)?;
    for _ in 0..PARTS {
        running.advance_steps(between)?;
        temperatures.push(running.observed_values(["temperature"])?[0]);
    }
    Ok(HeatingPoint {
        scheme,
        dt,
        temperature: MeanWithBar::of_time_series(&temperatures),
        maxwell: running.maxwell_probability(1.0),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Enskog's theory: at four discs of diameter 0.1 per unit of area diffusion falls to about 0.4 kT/γ; a thin system is not slowed.
    #[test]
    fn enskog_friction_slows_dense_systems_only() {
        let [dense, thin] = [(40_000, 100.0), (1000, 1000.0)].map(|(particles, side)| {
            let (times, square) = (vec![20.0], vec![[1.0; 2]]);
            let system = SystemSeries {
                particles,
                side,
                has_pairs: true,
                times,
                square,
                maxwell: 0.5,
                temperature: 1.0,
                velocities: vec![],
            };
            system.enskog_ratio(20.0)
        });
        assert!((dense - 0.411).abs() < 0.005 && thin > 0.999, "{dense}, {thin}");
    }
}
