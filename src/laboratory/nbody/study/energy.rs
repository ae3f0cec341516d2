//! Energy error of integrators on a Kepler orbit: against step and cost, and the step at which the orbit is lost.

use crate::console::CommandFailure;
use crate::frame::{FrameBuilder, ResultFrame, TableCell};
use crate::laboratory::running::{RunningScene, bisect_range};
use crate::results::{FinishedItem, ProgressMeter, StudyEnvironment, StudySize};
use crate::study::StudyError;
use stripmine_physics::method::nbody::keys::{DAMPING, ECCENTRICITY, INTEGRATOR};
use stripmine_physics::method::nbody::schemes::SchemeName;
use stripmine_physics::method::nbody::starts::ORBIT;
use stripmine_physics::scene::{DT, Overrides};
use stripmine_physics::words::Words;

/// Simulated orbits.
const ORBITS: u64 = 100;
/// Steps per orbit in the table of errors.
const STEPS: [u64; 4] = [64, 256, 1024, 4096];
/// Eccentricities for the fewest steps that keep an orbit.
const ECCENTRICITIES: [f64; 5] = [0.0, 0.3, 0.5, 0.7, 0.9];
/// Relative energy error above which an orbit is lost.
const LOST: f64 = 0.5;
/// Maximum number of samples per orbit.
const LOOKS: u64 = 256;
/// Errors below this value are rounding.
const ROUNDING: f64 = 1e-12;
/// Maximum number of steps per orbit that is tried.
const MOST: u64 = 16_384;

/// Largest |ΔE/E| from `python3 tests/references/orbit.py`, by steps per orbit; the last value of Gear's scheme is rounding.
const KNOWN: [(SchemeName, [f64; 4]); 6] = [
    (SchemeName::DampedEuler, [0.23, 3.9e-2, 8.9e-3, 2.2e-3]),
    (SchemeName::Leapfrog, [2.7e-2, 1.6e-3, 1.0e-4, 6.4e-6]),
    (SchemeName::Yoshida4, [1.7e-3, 7.5e-6, 3.0e-8, 1.2e-10]),
    (SchemeName::RungeKutta4, [2.8e-2, 2.7e-5, 2.8e-8, 3.2e-11]),
    (SchemeName::Hermite4, [0.12, 1.4e-4, 1.4e-7, 1.4e-10]),
    (SchemeName::Gear6, [0.24, 2.6e-5, 4.0e-9, f64::NAN]),
];

/// Result of an orbit with one scheme and step.
struct Orbit {
    scheme: SchemeName,
    steps: u64,
    /// Evaluations of the forces per orbit.
    evaluations: f64,
    /// Largest |ΔE/E|; `None` if the orbit was lost.
    error: Option<f64>,
    /// Largest momentum and largest change of the angular momentum during the run.
    drift: [f64; 2],
}

fn overrides(scheme: SchemeName, steps: u64, eccentricity: f64) -> Overrides {
    let orbit = Overrides::new().set(&INTEGRATOR, scheme).set(&DT, ORBIT / steps as f64);
    orbit.set(&ECCENTRICITY, eccentricity)
}

/// Measures every scheme.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let progress = lab.progress;
    let all = SchemeName::ALL.iter().map(|(scheme, _)| *scheme);
    let schemes: Vec<SchemeName> = all.filter(|scheme| !scheme.is_adaptive()).collect();
    let orbits: Vec<(SchemeName, u64)> =
        STEPS.iter().flat_map(|&steps| schemes.iter().rev().map(move |&scheme| (scheme, steps))).collect();
    // Both Euler schemes lose every orbit.
    let kept = schemes
        .iter()
        .rev()
        .filter(|scheme| !matches!(scheme, SchemeName::Euler | SchemeName::EulerWithHalf));
    let eccentric: Vec<(SchemeName, f64)> =
        kept.flat_map(|&scheme| ECCENTRICITIES.map(|eccentricity| (scheme, eccentricity))).collect();
    let meter = ProgressMeter::new((orbits.len() + eccentric.len()) as f64, progress);
    let orbits = meter.run_cases_from_last(&orbits, |&(scheme, steps)| simulate_orbit(scheme, steps))?;
    let edges = meter.run_cases(&eccentric, |&(scheme, eccentricity)| fewest_steps(scheme, eccentricity))?;
    let damped = STEPS.into_iter().map(|steps| damped_orbit(steps, 0.9999)).collect::<Result<Vec<_>, _>>()?;
    Ok(FinishedItem::of([
        errors(&orbits, schemes.iter().rev().copied()),
        FrameBuilder::of(&orbits)
            .text("scheme", |it| it.scheme.word())
            .count("steps of an orbit", |it| it.steps)
            .number("evaluations of the forces an orbit", 2, |it| it.evaluations)
            .short("largest |ΔE/E|", |it| it.error)
            .short("known", |it| known(it.scheme, it.steps).filter(|known| known.is_finite()))
            .short("largest momentum", |it| it.drift[0])
            .short("largest change of the angular momentum", |it| it.drift[1])
            .frame("orbits", "Energy error and drift of momenta along 100 orbits"),
        FrameBuilder::of(eccentric.iter().zip(edges))
            .text("scheme", |((scheme, _), _)| scheme.word())
            .number("eccentricity", 1, |((_, eccentricity), _)| *eccentricity)
            .cell("steps of an orbit", |(_, steps)| *steps)
            .frame("edges", "Fewest steps that keep an orbit for 100 turns"),
        FrameBuilder::of(&damped)
            .count("steps of an orbit", |(steps, ..)| *steps)
            .number("friction −ln(damping)/dt", 4, |(steps, damping, _)| {
                -damping.ln() * *steps as f64 / ORBIT
            })
            .cell("energy over that of the start", |(.., energy)| {
                energy.map_or(TableCell::from("lost"), |energy| TableCell::Number(energy, 3))
            })
            .frame("damped", "The source's scheme with a damping of 0.9999, after ten orbits"),
    ]))
}

/// Largest |ΔE/E| of the reference program.
fn known(scheme: SchemeName, steps: u64) -> Option<f64> {
    let column = STEPS.iter().position(|&known| known == steps)?;
    let (_, errors) = KNOWN.iter().find(|(known, _)| *known == scheme)?;
    Some(errors[column])
}

/// Errors by scheme and steps, with the order from the two shortest steps whose errors are not rounding.
fn errors(orbits: &[Orbit], schemes: impl Iterator<Item = SchemeName>) -> ResultFrame {
    let of = |scheme: SchemeName, steps: u64| {
        orbits.iter().find(|it| it.scheme == scheme && it.steps == steps).and_then(|it| it.error)
    };
    let order = |scheme: SchemeName| {
        let errors = STEPS.iter().filter_map(|&steps| of(scheme, steps));
        let errors: Vec<f64> = errors.filter(|error| (ROUNDING..0.5).contains(error)).collect();
        match errors.as_slice() {
            [.., a, b] => TableCell::Number((a / b).log2() / 2.0, 2),
            _ => TableCell::Nothing,
        }
    };
    let mut rows = FrameBuilder::of(schemes).text("scheme", |scheme| scheme.word());
    for steps in STEPS {
        rows = rows
            .cell(format!("{steps} steps"), |&scheme| {
                of(scheme, steps).map_or(TableCell::from("lost"), TableCell::Short)
            })
            .cell("known", |&scheme| match known(scheme, steps) {
                Some(known) if known.is_finite() => TableCell::Short(known),
                Some(_) => TableCell::from("rounding"),
                None => TableCell::Nothing,
            });
    }
    rows.cell("order", |&scheme| order(scheme)).frame(
        "errors",
        "Largest |ΔE/E| along 100 orbits, by steps of an orbit; known: python3 tests/references/orbit.py",
    )
}

/// Present total energy. Published errors are relative to it, since the energy of an orbit is far from zero.
fn energy(running: &RunningScene) -> Result<f64, StudyError> {
    let [kinetic, potential] = running.observed_values(["kinetic", "potential"])?;
    Ok(kinetic + potential)
}

fn simulate_orbit(scheme: SchemeName, steps: u64) -> Result<Orbit, StudyError> {
    let mut running = RunningScene::begin_timed("kepler", &overrides(scheme, steps, 0.5))?;
    let names = ["momentum", "angular_momentum_z"];
    let (turning, start) = (running.observed_values(names)?[1], energy(&running)?);
    let (mut largest, mut drift, before) = (0.0f64, [0.0f64; 2], running.simulation.work());
    let mut done = Ok(());
    // Frequent enough for a dozen samples during the pericentre passage.
    let between = steps.div_ceil(LOOKS);
    for _ in 0..ORBITS * steps / between {
        done = running.advance_steps(between);
        if done.is_err() {
            break;
        }
        let ([momentum, angular], error) = (running.observed_values(names)?, energy(&running)? / start - 1.0);
        largest = largest.max(error.abs());
        drift = [drift[0].max(momentum), drift[1].max((angular - turning).abs())];
    }
    // With two bodies an evaluation counts as work 4.
    let evaluations = (running.simulation.work() - before) / 4.0 / ORBITS as f64;
    Ok(Orbit { scheme, steps, evaluations, error: done.is_ok().then_some(largest), drift })
}

/// Returns true if an orbit is kept.
fn keeps_orbit(scheme: SchemeName, steps: u64, eccentricity: f64) -> Result<bool, StudyError> {
    let mut running = RunningScene::begin_timed("kepler", &overrides(scheme, steps, eccentricity))?;
    let start = energy(&running)?;
    for _ in 0..ORBITS {
        if running.advance_steps(steps).is_err() {
            return Ok(false);
        }
        let error = energy(&running)? / start - 1.0;
        if error.is_nan() || error.abs() > LOST {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Fewest steps per orbit that keep it; `None` if [`MOST`] steps do not.
fn fewest_steps(scheme: SchemeName, eccentricity: f64) -> Result<Option<u64>, StudyError> {
    let (mut low, mut high) = (4, 8);
    while !keeps_orbit(scheme, high, eccentricity)? {
        if high >= MOST {
            return Ok(None);
        }
        (low, high) = (high, 2 * high);
    }
    let is_narrow = |[low, high]: [u64; 2]| high <= low + low.div_ceil(16);
    let loses = |steps: u64| Ok::<_, StudyError>(!keeps_orbit(scheme, steps, eccentricity)?);
    Ok(Some(bisect_range([low, high], is_narrow, u64::midpoint, loses)?[1]))
}

/// Steps per orbit, damping, and the energy after ten orbits over its initial value; `None` if positions become infinite.
fn damped_orbit(steps: u64, damping: f64) -> Result<(u64, f64, Option<f64>), StudyError> {
    let overrides = overrides(SchemeName::DampedEuler, steps, 0.5).set(&DAMPING, damping);
    let mut running = RunningScene::begin_timed("kepler", &overrides)?;
    let start = energy(&running)?;
    let done = running.advance_steps(10 * steps);
    let ratio = 1.0 + (energy(&running)? / start - 1.0);
    Ok((steps, damping, done.is_ok().then_some(ratio)))
}
