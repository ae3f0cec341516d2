//! Speed against accuracy: error of Z against processor time.

use super::fluid::{Z_AT_HALF, compressibility};
use super::rates::{ENGINES, fluid_overrides};
use crate::console::CommandFailure;
use crate::frame::FrameBuilder;
use crate::laboratory::rates::{RateCase, measure_rates};
use crate::laboratory::running::RunningScene;
use crate::results::{FinishedItem, ProgressMeter, StudyEnvironment, StudySize};
use crate::statistics::RunSpread;
use crate::study::StudyError;
use stripmine_physics::scene::SEED;

/// Packing fraction.
const PACKING: f64 = 0.5;
/// Minimum numbers of discs.
const DISCS: [u64; 3] = [100, 1000, 10_000];
/// Numbers of collisions after which Z is sampled.
const LOOKS: [u64; 6] = [976, 3906, 15_625, 62_500, 250_000, 1_000_000];
/// Collisions per disc until the initial lattice is forgotten.
const FORGOTTEN: u64 = 50;
/// Number of seeds, each an independent run.
const SEEDS: u64 = 8;

/// Results of an engine with a number of discs.
struct EngineErrors {
    engine: &'static str,
    asked: u64,
    discs: usize,
    /// Relative errors of Z: by seed, then by collisions.
    errors: Vec<Vec<f64>>,
}

/// Runs both engines with every number of discs and every seed, and measures their rates.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let runs = DISCS.iter().flat_map(|&discs| ENGINES.map(|engine| (discs, engine)));
    let runs: Vec<(u64, &str, u64)> =
        runs.flat_map(|(discs, engine)| (1..=SEEDS).map(move |seed| (discs, engine, seed))).collect();
    let half = |share: f64| (lab.progress)(0.5 * share);
    let errors = ProgressMeter::new(runs.len() as f64, &half).run_cases_from_last(&runs, pressure_errors)?;
    let of_engines = runs.chunks(SEEDS as usize).zip(errors.chunks(SEEDS as usize));
    let engines: Vec<EngineErrors> = of_engines
        .map(|(runs, errors)| EngineErrors {
            engine: runs[0].1,
            asked: runs[0].0,
            discs: errors[0].0,
            errors: errors.iter().map(|it| it.1.clone()).collect(),
        })
        .collect();
    let case = |results: &EngineErrors| {
        let scene = fluid_overrides(results.engine, results.asked, PACKING);
        let case = RateCase::events("hard-disks", &scene, FORGOTTEN * results.asked, LOOKS[4]);
        case.label("engine", results.engine).label("discs", results.asked)
    };
    let half = |share: f64| (lab.progress)(0.5 + 0.5 * share);
    let lab = StudyEnvironment { progress: &half, program: lab.program.clone() };
    let rates = measure_rates(&lab, &engines.iter().map(case).collect::<Vec<_>>())?;
    let looks = engines.iter().zip(&rates).flat_map(|it| (0..LOOKS.len()).map(move |look| (it, look)));
    let of_seeds = |results: &EngineErrors, look: usize| {
        results.errors.iter().map(|it| 100.0 * it[look]).collect::<Vec<f64>>()
    };
    let square =
        |values: Vec<f64>| (values.iter().map(|it| it * it).sum::<f64>() / values.len() as f64).sqrt();
    Ok(FinishedItem::of([FrameBuilder::of(looks)
        .text("engine and discs", |((results, _), _)| format!("{}, N = {}", results.engine, results.discs))
        .count("collisions", |(_, look)| LOOKS[*look])
        .cell("processor time (s)", |((_, rate), look)| rate.cost().cell(LOOKS[*look] as f64, 3))
        .cell("million collisions/s", |((_, rate), _)| rate.rate().cell(1e-6, 3))
        .number("error of Z (%)", 3, |((results, _), look)| square(of_seeds(results, *look)))
        .number("mean error (%)", 3, |((results, _), look)| RunSpread::of(&of_seeds(results, *look)).mean)
        .number("its standard error (%)", 3, |((results, _), look)| {
            RunSpread::of(&of_seeds(results, *look)).error
        })
        .frame("precision", "Errors of Z after growing numbers of collisions")])
    .with_seeds(1..=SEEDS))
}

/// Number of discs, and relative errors of the compressibility of a run.
fn pressure_errors(&(discs, engine, seed): &(u64, &str, u64)) -> Result<(usize, Vec<f64>), StudyError> {
    let mut system =
        RunningScene::begin("hard-disks", &fluid_overrides(engine, discs, PACKING).set(&SEED, seed))?;
    let discs = system.simulation.particles().grain_count();
    system.advance_events(FORGOTTEN * discs as u64)?;
    let names = ["time", "virial", "temperature"];
    let [begun, virial, _] = system.observed_values(names)?;
    let (mut all, mut done) = (vec![], 0);
    for collisions in LOOKS {
        system.advance_events(collisions - done)?;
        done = collisions;
        let [time, sum, temperature] = system.observed_values(names)?;
        let z = compressibility(discs as f64, [sum - virial, time - begun], temperature);
        all.push(z / Z_AT_HALF - 1.0);
    }
    Ok((discs, all))
}
