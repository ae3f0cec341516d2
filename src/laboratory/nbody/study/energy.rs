//! What integrators do to the energy of an orbit: the error over the step and the cost, and where the orbit is lost.

use crate::laboratory::running::Running;
use crate::results::{Meter, Progress};
use crate::study::StudyError;
use serde::Serialize;
use stripmine_physics::method::nbody::keys::{DAMPING, ECCENTRICITY, INTEGRATOR};
use stripmine_physics::method::nbody::schemes::SchemeName;
use stripmine_physics::method::nbody::starts::ORBIT;
use stripmine_physics::scene::{DT, Overrides};
use stripmine_physics::words::Words;

/// Orbits that are followed.
const ORBITS: u64 = 100;
/// Steps of an orbit in the table of errors.
pub const STEPS: [u64; 4] = [64, 256, 1024, 4096];
/// Eccentricities at which it is looked for where orbits are lost.
const ECCENTRICITIES: [f64; 5] = [0.0, 0.3, 0.5, 0.7, 0.9];
/// An orbit is lost where the energy is off by more than this part of itself, or positive.
const LOST: f64 = 0.5;
/// Looks at an orbit, at most.
const LOOKS: u64 = 256;
/// Most steps of an orbit that are tried.
const MOST: u64 = 16_384;

/// The largest |ΔE/E| that other programs have measured, for the steps of an orbit of the table; the last of Gear's is rounding.
pub const KNOWN: [(SchemeName, [f64; 4]); 6] = [
    (SchemeName::DampedEuler, [0.23, 3.9e-2, 8.9e-3, 2.2e-3]),
    (SchemeName::Leapfrog, [2.7e-2, 1.6e-3, 1.0e-4, 6.4e-6]),
    (SchemeName::Yoshida4, [1.7e-3, 7.5e-6, 3.0e-8, 1.2e-10]),
    (SchemeName::RungeKutta4, [2.8e-2, 2.7e-5, 2.8e-8, 3.2e-11]),
    (SchemeName::Hermite4, [0.12, 1.4e-4, 1.4e-7, 1.4e-10]),
    (SchemeName::Gear6, [0.24, 2.6e-5, 4.0e-9, f64::NAN]),
];

/// An orbit by a scheme.
#[derive(Clone, Debug, Serialize)]
pub struct Orbit {
    /// The integrator.
    pub scheme: &'static str,
    /// Steps of an orbit.
    pub steps: u64,
    /// Evaluations of the forces an orbit.
    pub evaluations: f64,
    /// The largest |ΔE/E|; none where the orbit was lost.
    pub error: Option<f64>,
    /// What other programs have.
    pub known: Option<f64>,
    /// The largest momentum and change of the angular momentum on the way.
    pub drift: [f64; 2],
}

/// Where an orbit is lost.
#[derive(Clone, Debug, Serialize)]
pub struct Edge {
    /// The integrator.
    pub scheme: &'static str,
    /// Eccentricity.
    pub eccentricity: f64,
    /// Fewest steps of an orbit that keep it for the number of orbits; none where the most that are tried do not.
    pub steps: Option<u64>,
}

/// The source's scheme with damping.
#[derive(Clone, Debug, Serialize)]
pub struct Damped {
    /// Steps of an orbit.
    pub steps: u64,
    /// What velocities are multiplied by.
    pub damping: f64,
    /// The energy after ten orbits over that of the start; none where bodies are at no finite place before.
    pub energy: Option<f64>,
}

/// What came out.
#[derive(Clone, Debug, Serialize)]
pub struct Energies {
    /// Orbits followed.
    pub orbits: u64,
    /// Errors.
    pub errors: Vec<Orbit>,
    /// Where orbits are lost.
    pub edges: Vec<Edge>,
    /// What damping does.
    pub damped: Vec<Damped>,
}

impl Orbit {
    /// How its error compares with what is known; none where that is rounding.
    pub fn off(&self) -> Option<f64> {
        Some(self.error? / self.known.filter(|known| known.is_finite())?)
    }
}

fn overrides(scheme: SchemeName, steps: u64, eccentricity: f64) -> Overrides {
    let orbit = Overrides::new().set(&INTEGRATOR, scheme).set(&DT, ORBIT / steps as f64);
    orbit.set(&ECCENTRICITY, eccentricity)
}

/// Measures every scheme.
///
/// # Errors
/// [`StudyError`] if a scene is refused.
pub fn energies(progress: Progress<'_>) -> Result<Energies, StudyError> {
    let schemes: Vec<SchemeName> = SchemeName::ALL.iter().map(|(scheme, _)| *scheme).collect();
    let orbits: Vec<(SchemeName, u64)> =
        STEPS.iter().flat_map(|&steps| schemes.iter().rev().map(move |&scheme| (scheme, steps))).collect();
    // These two lose every orbit.
    let kept =
        schemes.iter().filter(|scheme| !matches!(scheme, SchemeName::Euler | SchemeName::EulerWithHalf));
    let edges: Vec<(SchemeName, f64)> =
        kept.flat_map(|&scheme| ECCENTRICITIES.map(|eccentricity| (scheme, eccentricity))).collect();
    let meter = Meter::new((orbits.len() + edges.len()) as f64, progress);
    let errors = meter.each_from_last(&orbits, |&(scheme, steps)| orbit(scheme, steps))?;
    let edges = meter.each(&edges, |&(scheme, eccentricity)| edge(scheme, eccentricity))?;
    let damped = STEPS.into_iter().map(|steps| damped_orbit(steps, 0.9999)).collect::<Result<_, _>>()?;
    Ok(Energies { orbits: ORBITS, errors, edges, damped })
}

/// The energy now. Published errors are relative to the energy itself, which an orbit's is far from losing.
fn energy(running: &Running) -> Result<f64, StudyError> {
    let [kinetic, potential] = running.observed(["kinetic", "potential"])?;
    Ok(kinetic + potential)
}

fn orbit(scheme: SchemeName, steps: u64) -> Result<Orbit, StudyError> {
    let mut running = Running::timed("kepler", &overrides(scheme, steps, 0.5))?;
    let names = ["momentum", "angular_momentum_z"];
    let (turning, start) = (running.observed(names)?[1], energy(&running)?);
    let (mut largest, mut drift, before) = (0.0f64, [0.0f64; 2], running.simulation.work());
    let mut done = Ok(());
    // Energy and momenta are looked at so often that the passage of the centre has a dozen looks.
    let between = steps.div_ceil(LOOKS);
    for _ in 0..ORBITS * steps / between {
        done = running.steps(between);
        if done.is_err() {
            break;
        }
        let ([momentum, angular], error) = (running.observed(names)?, energy(&running)? / start - 1.0);
        largest = largest.max(error.abs());
        drift = [drift[0].max(momentum), drift[1].max((angular - turning).abs())];
    }
    // Two bodies: work is four for an evaluation.
    let evaluations = (running.simulation.work() - before) / 4.0 / ORBITS as f64;
    let column = STEPS.iter().position(|&known| known == steps);
    let row = KNOWN.iter().find(|(known, _)| *known == scheme);
    Ok(Orbit {
        scheme: scheme.word(),
        steps,
        evaluations,
        error: done.is_ok().then_some(largest),
        known: row.zip(column).map(|((_, errors), column)| errors[column]),
        drift,
    })
}

/// Whether an orbit is kept.
fn keeps(scheme: SchemeName, steps: u64, eccentricity: f64) -> Result<bool, StudyError> {
    let mut running = Running::timed("kepler", &overrides(scheme, steps, eccentricity))?;
    let start = energy(&running)?;
    for _ in 0..ORBITS {
        if running.steps(steps).is_err() {
            return Ok(false);
        }
        let error = energy(&running)? / start - 1.0;
        if error.is_nan() || error.abs() > LOST {
            return Ok(false);
        }
    }
    Ok(true)
}

fn edge(scheme: SchemeName, eccentricity: f64) -> Result<Edge, StudyError> {
    let (mut low, mut high) = (4, 8);
    while !keeps(scheme, high, eccentricity)? {
        if high >= MOST {
            return Ok(Edge { scheme: scheme.word(), eccentricity, steps: None });
        }
        (low, high) = (high, 2 * high);
    }
    while high > low + low.div_ceil(16) {
        let middle = low.midpoint(high);
        match keeps(scheme, middle, eccentricity)? {
            true => high = middle,
            false => low = middle,
        }
    }
    Ok(Edge { scheme: scheme.word(), eccentricity, steps: Some(high) })
}

fn damped_orbit(steps: u64, damping: f64) -> Result<Damped, StudyError> {
    let overrides = overrides(SchemeName::DampedEuler, steps, 0.5).set(&DAMPING, damping);
    let mut running = Running::timed("kepler", &overrides)?;
    let start = energy(&running)?;
    let done = running.steps(10 * steps);
    let ratio = 1.0 + (energy(&running)? / start - 1.0);
    Ok(Damped { steps, damping, energy: done.is_ok().then_some(ratio) })
}
