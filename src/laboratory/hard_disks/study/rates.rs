//! Collisions per second of the fast engine and of ISO99's, by packing fraction and number of discs.

use crate::console::CommandFailure;
use crate::frame::FrameBuilder;
use crate::laboratory::rates::{RateCase, measure_rates};
use crate::laboratory::running::prepare_preset;
use crate::results::{FinishedItem, StudyEnvironment, StudySize};
use stripmine_physics::method::hard_disks::keys::ENGINE;
use stripmine_physics::scene::{COUNT, Overrides, PACKING_FRACTION};

/// Engines, by their names in scenes.
pub(super) const ENGINES: [&str; 2] = ["fast", "reference"];
/// Packing fractions.
const PACKING_FRACTIONS: [f64; 5] = [0.10, 0.30, 0.50, 0.65, 0.70];
/// Packing fraction of the largest system.
const LARGEST_FRACTION: f64 = 0.70;
/// ISO99: number of discs, and million collisions per hour at the best density.
const SOURCE: [(f64, f64); 2] = [(2500.0, 460.0), (2_500_000.0, 210.0)];

/// Overrides of the fluid of an engine.
pub(super) fn fluid_overrides(engine: &str, discs: u64, packing_fraction: f64) -> Overrides {
    let scene = Overrides::new().set(&COUNT, discs).set(&PACKING_FRACTION, packing_fraction);
    scene.set(&ENGINE, engine)
}

/// Measures both engines.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, size: StudySize) -> Result<FinishedItem, CommandFailure> {
    let (sizes, collisions, largest): (&[u64], _, u64) = match size {
        StudySize::Quick => (&[2500], 50_000, 2500),
        StudySize::Full => (&[2500, 250_000], 100_000, 250_000),
        StudySize::All => (&[2500, 250_000], 100_000, 2_500_000),
    };
    let scenes = sizes.iter().flat_map(|&discs| PACKING_FRACTIONS.map(|packing| (discs, packing)));
    let scenes: Vec<(u64, f64)> = scenes.collect();
    // A few collisions per disc to leave the initial lattice, for about as long as the measurement.
    let cases = scenes.iter().flat_map(|&(discs, packing)| {
        let warm_up = (10 * discs).min(2 * collisions);
        ENGINES.map(|engine| {
            let case =
                RateCase::events("hard-disks", &fluid_overrides(engine, discs, packing), warm_up, collisions);
            case.label("discs", discs).label("ν", packing.to_string()).label("engine", engine)
        })
    });
    let measured = measure_rates(lab, &cases.collect::<Vec<_>>())?;
    // Discs, bytes of a run, mask.
    let facts = |engine: &str, &(discs, packing): &(u64, f64)| {
        let scene = prepare_preset("hard-disks", &fluid_overrides(engine, discs, packing))?;
        let mask = scene.settings["mask"].as_str().unwrap_or_default().to_owned();
        Ok::<_, CommandFailure>((scene.particles().grain_count() as f64, scene.memory.needed as f64, mask))
    };
    let facts = scenes.iter().map(|it| Ok([facts(ENGINES[0], it)?, facts(ENGINES[1], it)?]));
    let facts = facts.collect::<Result<Vec<_>, CommandFailure>>()?;
    let pairs = measured.chunks_exact(ENGINES.len()).map(|pair| [&pair[0], &pair[1]]);
    let source = |discs: f64| SOURCE.into_iter().find(|(known, _)| (discs / known - 1.0).abs() < 0.1);
    let largest_runs = ENGINES.into_iter().map(|engine| {
        let scene = fluid_overrides(engine, largest, LARGEST_FRACTION);
        let case = RateCase::events("hard-disks", &scene, largest, 10 * collisions);
        // Measured alone: the peak of the memory is that of the process.
        Ok((engine, measure_rates(lab, &[case.label("engine", engine).label("discs", largest)])?))
    });
    let largest_runs = largest_runs.collect::<Result<Vec<_>, CommandFailure>>()?;
    let rates = FrameBuilder::of(scenes.iter().zip(pairs).zip(&facts))
        .number("discs", 0, |(_, [fast, _])| fast.0)
        .number("ν", 2, |(((_, packing), _), _)| *packing)
        .cell("fast (million/s)", |((_, [fast, _]), _)| fast.rate().cell(1e-6, 3))
        .cell("the source's way (million/s)", |((_, [_, reference]), _)| reference.rate().cell(1e-6, 3))
        .text("its mask", |(_, [_, reference])| reference.2.clone())
        .cell("fast over it", |((_, [fast, reference]), _)| fast.rate_ratio(reference).cell(1.0, 1))
        .number("fast over the source's machine", 0, |((_, [fast, _]), [scene, _])| {
            source(scene.0).map(|(_, rate)| 3600e-6 * fast.rate().median / rate)
        })
        .number("memory, fast (MB)", 0, |(_, [fast, _])| 1e-6 * fast.1)
        .number("memory, the source's way (MB)", 0, |(_, [_, reference])| 1e-6 * reference.1)
        .frame("rates", "Million collisions a second of processor time");
    let largest = FrameBuilder::of(
        largest_runs.iter().flat_map(|(engine, all)| all.iter().map(move |it| (engine, it))),
    )
    .text("engine", |(engine, _)| **engine)
    .count("discs", |_| largest)
    .cell("rate (million/s)", |(_, it)| it.rate().cell(1e-6, 3))
    .number("million collisions an hour", 0, |(_, it)| 3600e-6 * it.rate().median)
    .number("peak memory (MB)", 0, |(_, it)| 1e-6 * it.peak_memory())
    .frame("largest", "Rate and peak memory with the most discs, packing fraction 0.7");
    Ok(FinishedItem::of([rates, largest]).with_seeds([1]))
}
