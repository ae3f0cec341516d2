//! Particles that a long step throws out of the box: how many over the step, and from which step on.

use crate::laboratory::running::{Running, prepared};
use crate::results::{Meter, Progress};
use crate::study::StudyError;
use serde::Serialize;
use std::f64::consts::PI;
use stripmine_physics::method::langevin::keys::{BATH_TEMPERATURE, INTEGRATOR, MOST_LOST, STRENGTH};
use stripmine_physics::method::langevin::options::SchemeKind;
use stripmine_physics::method::observed::UnknownName;
use stripmine_physics::scene::{COUNT, DT, Overrides, SIDES, TEMPERATURE};

/// LAN17's table: step, particles lost in [`STEPS`] steps.
pub const SOURCE: [(f64, u64); 4] = [(1.0, 19_200), (0.1, 6393), (0.01, 754), (0.001, 0)];
/// Steps of every run, as in the source.
pub const STEPS: u64 = 100;
/// LAN17's interactions in steps of 1.
pub const INTERACTIONS: u64 = 43_676;
/// Steps between the source's.
const FINER: [f64; 5] = [0.03, 0.005, 0.004, 0.003, 0.002];
/// The integrators compared.
pub const SCHEMES: [SchemeKind; 2] = [SchemeKind::Stochastic, SchemeKind::Baoab];
/// One of this number of particles, at the same density, is taken for other ε and kT, and its losses are counted for all.
const PART: u64 = 8;
/// The boundary is known to this part of itself.
const TOLERANCE: f64 = 0.05;

/// Losses at a step.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The step (time).
    pub dt: f64,
    /// Lost by the integrators.
    pub lost: [u64; 2],
    /// Lost in the source, where it says.
    pub source: Option<u64>,
}

/// The longest step without a loss, for a pair potential and a temperature.
#[derive(Clone, Debug, Serialize)]
pub struct Boundary {
    /// ε (energy).
    pub strength: f64,
    /// kT (energy).
    pub temperature: f64,
    /// The step (time).
    pub dt: f64,
    /// The source's bound, and the limit by the hardest collisions (time).
    pub bounds: [f64; 2],
}

/// Losses at the source's steps for a pair potential and a temperature.
#[derive(Clone, Debug, Serialize)]
pub struct Choice {
    /// ε (energy).
    pub strength: f64,
    /// kT (energy).
    pub temperature: f64,
    /// Lost by the stochastic integrator at each step of [`SOURCE`].
    pub lost: [u64; 4],
}

/// What came out.
#[derive(Clone, Debug, Serialize)]
pub struct LossTable {
    /// Particles at the start.
    pub particles: u64,
    /// Losses over the step.
    pub rows: Vec<Row>,
    /// Boundaries.
    pub boundaries: Vec<Boundary>,
    /// Pairs nearer than σ, seen from each of the two, that the particles left in the source at steps of 1 make at random places in its 100 steps: at
    /// least its interactions, which are fewer.
    pub least_interactions: f64,
    /// Losses for other ε and kT.
    pub choices: Vec<Choice>,
}

fn overrides(particles: u64, dt: f64) -> Overrides {
    let side = (particles as f64 / 4.0).sqrt();
    let scene = Overrides::new().set(&COUNT, particles).set(&SIDES, [side; 2]);
    scene.set(&DT, dt)
}

/// Particles lost in the source's number of steps; all of them where none is left.
fn lost(particles: u64, overrides: &Overrides) -> Result<u64, StudyError> {
    let mut running = Running::timed("langevin-report", overrides)?;
    Ok(match running.steps(STEPS) {
        Ok(()) => running.observed(["lost"])?[0] as u64,
        Err(_) => particles,
    })
}

/// Counts losses and looks for boundaries, of as many particles.
///
/// # Errors
/// [`StudyError`] if a scene is refused.
pub fn losses(particles: u64, progress: Progress<'_>) -> Result<LossTable, StudyError> {
    let mut steps: Vec<f64> = SOURCE.iter().map(|(dt, _)| *dt).chain(FINER).collect();
    steps.sort_by(|a, b| b.total_cmp(a));
    let places: Vec<(f64, f64)> = [0.1, 1.0, 10.0, 100.0]
        .into_iter()
        .flat_map(|strength| [0.1, 1.0, 10.0].map(|kt| (strength, kt)))
        .collect();
    let all = steps.len() + 2 * places.len();
    let meter = Meter::new(all as f64, progress);
    let rows = meter.each(&steps, |&dt| {
        let mut counts = [0; 2];
        for (count, scheme) in counts.iter_mut().zip(SCHEMES) {
            let scene = overrides(particles, dt).set(&INTEGRATOR, scheme).set(&MOST_LOST, particles);
            *count = lost(particles, &scene)?;
        }
        let source = SOURCE.iter().find(|(there, _)| *there == dt).map(|(_, lost)| *lost);
        Ok::<_, StudyError>(Row { dt, lost: counts, source })
    })?;
    let boundaries =
        meter.each(&places, |&(strength, temperature)| boundary(particles, strength, temperature))?;
    let choices = meter.each(&places, |&(strength, temperature)| choice(particles, strength, temperature))?;
    Ok(LossTable { particles, rows, boundaries, least_interactions: least_interactions(particles), choices })
}

fn least_interactions(particles: u64) -> f64 {
    let (left, density, diameter) = ((particles - SOURCE[0].1) as f64, 4.0, 0.1_f64);
    STEPS as f64 * left.powi(2) / (particles as f64 / density) * PI * diameter.powi(2)
}

/// The scene at a step with an ε and a kT.
fn chosen(particles: u64, dt: f64, strength: f64, temperature: f64) -> Overrides {
    let scene = overrides(particles, dt).set(&STRENGTH, strength);
    scene.set(&BATH_TEMPERATURE, temperature).set(&TEMPERATURE, temperature)
}

fn choice(particles: u64, strength: f64, temperature: f64) -> Result<Choice, StudyError> {
    let mut counts = [0; 4];
    for (count, (dt, _)) in counts.iter_mut().zip(SOURCE) {
        let scene = chosen(particles / PART, dt, strength, temperature).set(&INTEGRATOR, SCHEMES[0]);
        *count = PART * lost(particles / PART, &scene.set(&MOST_LOST, particles))?;
    }
    Ok(Choice { strength, temperature, lost: counts })
}

fn boundary(particles: u64, strength: f64, temperature: f64) -> Result<Boundary, StudyError> {
    let overrides = |dt: f64| chosen(particles, dt, strength, temperature);
    let limits = prepared("langevin-report", &overrides(0.001))?.step_limits;
    let step = |name: &str| {
        let unknown = || UnknownName::new("limit of the step", name, limits.iter().map(|limit| limit.name));
        limits.iter().find(|limit| limit.name == name).map(|limit| limit.step).ok_or_else(unknown)
    };
    let bounds = [step("source-bound")?, step("hardest-collision")?];
    let (mut low, mut high) = (0.05 * bounds[1], 4.0 * bounds[1]);
    while high / low > 1.0 + TOLERANCE {
        let middle = (low * high).sqrt();
        // The first loss ends it.
        match lost(particles, &overrides(middle).set(&MOST_LOST, 0_u64))? {
            0 => low = middle,
            _ => high = middle,
        }
    }
    Ok(Boundary { strength, temperature, dt: (low * high).sqrt(), bounds })
}
