//! Particles lost from the box at long steps: number lost against the step, and the longest step without a loss.

use crate::console::CommandFailure;
use crate::frame::FrameBuilder;
use crate::laboratory::running::{RunningScene, bisect_range, prepare_preset};
use crate::results::{FinishedItem, ProgressMeter, StudyEnvironment, StudySize};
use crate::study::StudyError;
use std::f64::consts::PI;
use stripmine_physics::method::langevin::keys::{BATH_TEMPERATURE, INTEGRATOR, MOST_LOST};
use stripmine_physics::method::langevin::laws::STRENGTH;
use stripmine_physics::method::langevin::options::SchemeKind;
use stripmine_physics::method::observed::UnknownName;
use stripmine_physics::near::NeighbourSearch;
use stripmine_physics::particles::Particle;
use stripmine_physics::scene::{COUNT, DT, Overrides, SIDES, TEMPERATURE};

/// LAN17's table: step, particles lost and interactions in [`STEPS`] steps.
const SOURCE: [(f64, u64, u64); 4] =
    [(1.0, 19_200, 43_676), (0.1, 6393, 98_164), (0.01, 754, 91_054), (0.001, 0, 84_520)];
/// LAN17's particles, density (1/length²), σ (length) and steps.
const PARTICLES: u64 = 40_000;
const DENSITY: f64 = 4.0;
const DIAMETER: f64 = 0.1;
const STEPS: u64 = 100;
/// Steps between those of LAN17.
const FINER: [f64; 5] = [0.03, 0.005, 0.004, 0.003, 0.002];
/// Strengths ε and temperatures kT (energy).
const STRENGTHS: [f64; 4] = [0.1, 1.0, 10.0, 100.0];
const TEMPERATURES: [f64; 3] = [0.1, 1.0, 10.0];
/// Factor by which systems with other ε and kT are smaller, at the same density; their losses are multiplied by it.
const PART: u64 = 8;
/// Relative tolerance of the longest step.
const TOLERANCE: f64 = 0.05;

/// Counts losses and interactions, and searches for the longest steps without a loss.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let mut steps: Vec<f64> = SOURCE.iter().map(|(dt, ..)| *dt).chain(FINER).collect();
    steps.sort_by(|a, b| b.total_cmp(a));
    let choices: Vec<[f64; 2]> =
        STRENGTHS.iter().flat_map(|&strength| TEMPERATURES.map(|kt| [strength, kt])).collect();
    let meter = ProgressMeter::new((steps.len() + SOURCE.len() + 2 * choices.len()) as f64, lab.progress);
    let of_step = |dt: f64| overrides(PARTICLES, dt).set(&MOST_LOST, PARTICLES);
    let lost_by =
        |dt: f64, scheme: SchemeKind| count_losses(PARTICLES, &of_step(dt).set(&INTEGRATOR, scheme));
    let losses = meter.run_cases(&steps, |&dt| {
        Ok::<_, StudyError>((dt, lost_by(dt, SchemeKind::Stochastic)?, lost_by(dt, SchemeKind::Baoab)?))
    })?;
    let met = meter.run_cases(&SOURCE, |&(dt, ..)| count_interactions(&of_step(dt)))?;
    let boundaries = meter.run_cases(&choices, |&choice| longest_lossless_step(choice))?;
    let chosen = meter.run_cases(&choices, |&choice| losses_at_source_steps(choice))?;
    Ok(FinishedItem::of([
        FrameBuilder::of(losses)
            .number("dt", 3, |(dt, ..)| *dt)
            .count("stochastic", |(_, stochastic, _)| *stochastic)
            .count("baoab", |(.., baoab)| *baoab)
            .cell("source", |(dt, ..)| SOURCE.iter().find(|it| it.0 == *dt).map(|(_, lost, _)| *lost))
            .frame("losses", format!("Particles lost in {STEPS} steps, of {PARTICLES}")),
        FrameBuilder::of(SOURCE.iter().zip(met))
            .number("dt", 3, |((dt, ..), _)| *dt)
            .count("interactions", |(_, met)| *met)
            .count("source", |((.., source), _)| *source)
            .number("of the source's particles left, at random places", 0, |((_, lost, _), _)| {
                random_interactions(PARTICLES - lost)
            })
            .frame(
                "interactions",
                format!("Pairs nearer than σ, counted from each of the two, over {STEPS} steps"),
            ),
        FrameBuilder::of(choices.iter().zip(&boundaries))
            .number("ε", 1, |(choice, _)| choice[0])
            .number("kT", 1, |(choice, _)| choice[1])
            .number("longest step", 5, |(_, [longest, ..])| *longest)
            .number("source's bound", 5, |(_, [_, bound, _])| *bound)
            .number("of it", 3, |(_, [longest, bound, _])| longest / bound)
            .number("by hardest collisions", 5, |(_, [.., hardest])| *hardest)
            .number("of it", 3, |(_, [longest, _, hardest])| longest / hardest)
            .frame("boundaries", format!("Longest step without a loss in {STEPS} steps, BAOAB, to 5 %")),
        FrameBuilder::of(choices.iter().zip(&chosen))
            .number("ε", 1, |(choice, _)| choice[0])
            .number("kT", 1, |(choice, _)| choice[1])
            .cells(SOURCE.map(|(dt, ..)| format!("lost, dt = {dt}")), |(_, lost)| **lost)
            .number("times off the source, at most", 1, |(_, lost)| largest_loss_factor(**lost))
            .frame("choices", format!("Particles lost for other ε and kT, of {PARTICLES}")),
    ])
    .with_seeds([1]))
}

fn overrides(particles: u64, dt: f64) -> Overrides {
    let side = (particles as f64 / DENSITY).sqrt();
    Overrides::new().set(&COUNT, particles).set(&SIDES, [side; 2]).set(&DT, dt)
}

/// Overrides of the scene for a step, ε and kT.
fn scene_overrides(particles: u64, dt: f64, [strength, temperature]: [f64; 2]) -> Overrides {
    let scene = overrides(particles, dt).set(&STRENGTH, strength);
    scene.set(&BATH_TEMPERATURE, temperature).set(&TEMPERATURE, temperature)
}

/// Particles lost in LAN17's number of steps; all of them if the run fails.
fn count_losses(particles: u64, overrides: &Overrides) -> Result<u64, StudyError> {
    let mut running = RunningScene::begin_timed("langevin-report", overrides)?;
    Ok(match running.advance_steps(STEPS) {
        Ok(()) => running.observed_values(["lost"])?[0] as u64,
        Err(_) => particles,
    })
}

/// Losses at the steps of [`SOURCE`] with LAN17's scheme.
fn losses_at_source_steps(choice: [f64; 2]) -> Result<[u64; 4], StudyError> {
    let mut counts = [0; 4];
    for (count, (dt, ..)) in counts.iter_mut().zip(SOURCE) {
        let scene = scene_overrides(PARTICLES / PART, dt, choice).set(&INTEGRATOR, SchemeKind::Stochastic);
        *count = PART * count_losses(PARTICLES / PART, &scene.set(&MOST_LOST, PARTICLES))?;
    }
    Ok(counts)
}

/// Largest factor between some losses and those of LAN17.
fn largest_loss_factor(lost: [u64; 4]) -> f64 {
    let ratios = lost.iter().zip(SOURCE).map(|(lost, (_, source, _))| {
        let ratio = (*lost).max(1) as f64 / source.max(1) as f64;
        ratio.max(1.0 / ratio)
    });
    ratios.fold(1.0, f64::max)
}

/// Pairs nearer than σ, counted from both particles and summed over the steps of a run with LAN17's scheme.
fn count_interactions(overrides: &Overrides) -> Result<u64, StudyError> {
    let mut running = RunningScene::begin_timed(
        "langevin-report",
        &overrides.clone().set(&INTEGRATOR, SchemeKind::Stochastic),
    )?;
    let (domain, mut met) = (running.domain, 0);
    for _ in 0..STEPS {
        running.advance_steps(1)?;
        let particles = running.simulation.particles();
        let places = particles.all().iter().map(Particle::planar_position);
        let near = NeighbourSearch::over_positions(domain, places.clone(), DIAMETER);
        let others =
            places.flat_map(|place| near.candidates_near(place).map(move |(_, other)| (place, other)));
        // Each position also finds itself.
        met += others.filter(|(place, other)| domain.distance(*place, *other) < DIAMETER).count();
        met -= particles.len();
    }
    Ok(met as u64)
}

/// Expected interactions of some particles at random positions in LAN17's box.
fn random_interactions(particles: u64) -> f64 {
    let area = PARTICLES as f64 / DENSITY;
    STEPS as f64 * (particles as f64).powi(2) / area * PI * DIAMETER.powi(2)
}

/// Longest step without a loss, LAN17's bound, and the limit from the hardest collisions (time).
fn longest_lossless_step(choice: [f64; 2]) -> Result<[f64; 3], StudyError> {
    let limits = prepare_preset("langevin-report", &scene_overrides(PARTICLES, 0.001, choice))?.step_limits;
    let step = |name: &str| {
        let unknown = || UnknownName::new("limit of the step", name, limits.iter().map(|limit| limit.name));
        limits.iter().find(|limit| limit.name == name).map(|limit| limit.step).ok_or_else(unknown)
    };
    let (bound, hardest) = (step("source-bound")?, step("hardest-collision")?);
    // The first loss ends a run.
    let keeps_all = |dt: f64| {
        Ok::<_, StudyError>(
            count_losses(PARTICLES, &scene_overrides(PARTICLES, dt, choice).set(&MOST_LOST, 0_u64))? == 0,
        )
    };
    let is_narrow = |[low, high]: [f64; 2]| high / low <= 1.0 + TOLERANCE;
    let middle = |low: f64, high: f64| (low * high).sqrt();
    let [low, high] = bisect_range([0.05 * hardest, 4.0 * hardest], is_narrow, middle, keeps_all)?;
    Ok([middle(low, high), bound, hardest])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn losses_are_compared_by_the_largest_factor() {
        assert_eq!(largest_loss_factor([19_200, 6393, 754, 0]), 1.0);
        assert!((largest_loss_factor([37_111, 34_738, 26_331, 0]) - 26_331.0 / 754.0).abs() < 1e-9);
        assert!((largest_loss_factor([19_000, 6400, 20, 0]) - 37.7).abs() < 1e-9);
    }

    /// The 20,800 particles that remain in LAN17 would interact three times as often as it reports.
    #[test]
    fn random_pairs_are_counted_from_both_particles() {
        assert!((random_interactions(20_800) - 135_917.9).abs() < 0.1, "{}", random_interactions(20_800));
    }
}
