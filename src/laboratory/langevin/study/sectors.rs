//! Wall time against the number of sectors along a side, on one thread and on two; comparison of searches; time of the phases and of the
//! output.

use super::output;
use crate::console::CommandFailure;
use crate::frame::{FrameBuilder, TableCell};
use crate::laboratory::rates::{CaseReading, MeasuredCase, RateCase, StudyWork, measure_rates};
use crate::laboratory::running::{RunningScene, prepare_preset};
use crate::results::{FinishedItem, StudyEnvironment, StudySize};
use crate::study::StudyError;
use std::collections::BTreeMap;
use std::time::Instant;
use stripmine_physics::io::extxyz::{self, ParticleFrame};
use stripmine_physics::method::langevin::keys::{PER_SIDE, SEARCH, SORT};
use stripmine_physics::method::langevin::laws::{LAW, PairLaw};
use stripmine_physics::method::langevin::options::{PairSearchKind, SortKind};
use stripmine_physics::scene::{COUNT, Overrides, SIDES, SPACING};
use stripmine_physics::words::Words;

/// Wall seconds of LAN17, on one thread and on two, over the sectors along a side.
const SOURCE: [(u64, [f64; 2]); 8] = [
    (3, [1008.0, 526.0]),
    (5, [205.0, 132.0]),
    (10, [51.2, 34.4]),
    (20, [13.2, 12.5]),
    (100, [4.2, 6.8]),
    (200, [4.0, 6.6]),
    (400, [4.3, 6.8]),
    (800, [5.7, 8.1]),
];
/// LAN17's particles and steps, to which its times refer.
const PARTICLES: f64 = 40_000.0;
const STEPS: f64 = 100.0;

/// Name of a search, and its overrides.
type NamedSearch = (&'static str, fn(Overrides) -> Overrides);

/// Searches that are compared.
const SEARCHES: [NamedSearch; 4] = [
    ("lattice", |scene| scene.set(&SEARCH, PairSearchKind::Lattice)),
    ("sectors, sorted when needed", |scene| {
        scene.set(&SEARCH, PairSearchKind::Sectors).set(&SORT, SortKind::WhenNeeded)
    }),
    ("sectors, sorted at every step", |scene| {
        scene.set(&SEARCH, PairSearchKind::Sectors).set(&SORT, SortKind::EveryStep)
    }),
    ("lists", |scene| scene.set(&SEARCH, PairSearchKind::NeighborList)),
];
/// Particles of the scenes that compare searches, and their densities N σ²/A.
const COMPARED: f64 = 4000.0;
const DENSITIES: [f64; 5] = [0.05, 0.2, 0.4, 0.6, 0.7];

/// Measured work other than runs of scenes.
pub(in crate::laboratory::langevin) static WORKS: [StudyWork; 2] =
    [StudyWork { name: "langevin-frames", measure: |_| write_frames() }, output::WORK];

/// Fluid with its pair law, density N σ²/A, the search chosen by `auto`, and the index of the case of each search that supports it.
struct SearchedFluid {
    law: PairLaw,
    density: f64,
    auto: String,
    searches: [Option<usize>; SEARCHES.len()],
}

/// Measures every number of sectors, neighbour lists, and fluids with every search.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, size: StudySize) -> Result<FinishedItem, CommandFailure> {
    let (fewest, seconds) = if size == StudySize::Quick { (100, 0.05) } else { (3, 0.06) };
    let counts = SOURCE.iter().filter(|(count, _)| *count >= fewest);
    let sides: Vec<Option<(u64, [f64; 2])>> = counts.copied().map(Some).chain([None]).collect();
    let name =
        |side: &Option<(u64, [f64; 2])>| side.map_or("lists".to_owned(), |(count, _)| count.to_string());
    let mut cases = vec![];
    for side in &sides {
        let scene = match side {
            Some((count, _)) => Overrides::new().set(&SEARCH, PairSearchKind::Sectors).set(&PER_SIDE, *count),
            None => Overrides::new().set(&SEARCH, PairSearchKind::NeighborList),
        };
        cases.extend([1, 2].map(|threads| {
            let case = RateCase::steps("langevin-report", &scene, 1, 1).label("sectors", name(side));
            case.for_seconds(seconds).on_threads(threads)
        }));
    }
    let laws = [PairLaw::Wca, PairLaw::LennardJones];
    let fluids = laws.into_iter().flat_map(|law| DENSITIES.map(|density| (law, density)));
    let fluids: Vec<SearchedFluid> = fluids
        .map(|(law, density)| make_fluid(law, density, 0.25 * seconds, &mut cases))
        .collect::<Result<_, _>>()?;
    cases.push(
        RateCase::steps("langevin-report", &Overrides::new(), 50, 500)
            .label("phases of", "lists")
            .on_threads(1),
    );
    cases.push(RateCase::own(&WORKS[0], serde_json::Value::Null).label("writing", "frames"));
    cases.push(RateCase::own(&WORKS[1], serde_json::Value::Null).label("writing", "positions").on_threads(2));
    let all = measure_rates(lab, &cases)?;
    let [.., phases, frames, output] = all.as_slice() else { return Ok(FinishedItem::default()) };
    let part =
        |(name, _): (&String, &f64)| (name.clone(), phases.part(name).cell(1e3 * STEPS * PARTICLES, 2));
    let mut parts: BTreeMap<String, TableCell> = phases.readings[0].parts.iter().map(part).collect();
    parts.insert("ten frames as text".to_owned(), frames.cost().cell(1e3, 2));
    let medians = sides.iter().zip(all.chunks(2)).filter(|(side, _)| side.is_some());
    let best = medians
        .flat_map(|(_, threads)| threads.iter().map(|it| it.cost().median))
        .fold(f64::INFINITY, f64::min);
    let source_best = SOURCE.iter().flat_map(|(_, source)| *source).fold(f64::INFINITY, f64::min);
    let seconds = |case: &MeasuredCase| case.cost().cell(STEPS * PARTICLES, 4);
    let of_search = |case: usize| all[case].cost().cell(1e6 * COMPARED, 1);
    Ok(FinishedItem::of([
        FrameBuilder::of(sides.iter().zip(all.chunks(2)))
            .text("sectors", |(side, _)| name(side))
            .cell("1 thread (s)", |(_, threads)| seconds(&threads[0]))
            .cell("2 threads (s)", |(_, threads)| seconds(&threads[1]))
            .cell("one over two", |(_, threads)| threads[1].rate_ratio(&threads[0]).cell(1.0, 2))
            .number("source", 2, |(side, _)| side.map(|(_, [one, two])| one / two))
            .number("source, 1 (s)", 1, |(side, _)| side.map(|(_, source)| source[0]))
            .number("source, 2 (s)", 1, |(side, _)| side.map(|(_, source)| source[1]))
            .number("1 thread over the best", 2, |(_, threads)| threads[0].cost().median / best)
            .number("2 threads over the best", 2, |(_, threads)| threads[1].cost().median / best)
            .number("source, 1 over its best", 2, |(side, _)| side.map(|(_, source)| source[0] / source_best))
            .number("source, 2 over its best", 2, |(side, _)| side.map(|(_, source)| source[1] / source_best))
            .frame("wall-time", "Wall time of 100 steps: median and range of three processes"),
        FrameBuilder::of(&fluids)
            .text("pairs", |fluid| fluid.law.word())
            .number("density N σ²/A", 2, |fluid| fluid.density)
            .cells(SEARCHES.map(|(name, _)| format!("{name} (µs)")), |fluid| {
                fluid.searches.map(|case| case.map(of_search))
            })
            .text("auto takes", |fluid| &fluid.auto)
            .number("slower than the best (%)", 0, |fluid| fluid.slowdown_of_auto(&all).map(|it| 100.0 * it))
            .frame("searches", "A step of 4000 particles by every search, on one thread"),
        FrameBuilder::of(parts)
            .text("part", |(name, _)| name.clone())
            .cell("time (ms)", |(_, time)| time.clone())
            .frame("phases", "Where the time goes: 100 steps by lists on one thread"),
        output::frame(output),
    ])
    .with_seeds([1]))
}

impl SearchedFluid {
    /// Relative time by which `auto` is slower than the fastest search.
    fn slowdown_of_auto(&self, all: &[MeasuredCase]) -> Option<f64> {
        let cost = |case: &Option<usize>| case.map(|case| all[case].cost().median);
        let best = self.searches.iter().filter_map(cost).fold(f64::INFINITY, f64::min);
        // With sectors, `auto` sorts when needed.
        let name = match self.auto.as_str() {
            "neighbor-list" => "lists",
            "sectors" => "sectors, sorted when needed",
            other => other,
        };
        let own = SEARCHES.iter().position(|(known, _)| *known == name)?;
        cost(&self.searches[own]).map(|own| own / best - 1.0)
    }
}

/// Makes a fluid and adds the searches that support it to the cases.
fn make_fluid(
    law: PairLaw,
    density: f64,
    seconds: f64,
    cases: &mut Vec<RateCase>,
) -> Result<SearchedFluid, StudyError> {
    let side = (COMPARED / density).sqrt();
    let scene = Overrides::new().set(&LAW, law).set(&COUNT, COMPARED as u64);
    let scene = scene.set(&SIDES, [side; 2]).set(&SPACING, 1.13);
    let searches = SEARCHES.map(|(name, searched)| {
        let overrides = searched(scene.clone());
        prepare_preset("langevin-dense", &overrides).is_ok().then(|| {
            let case = RateCase::steps("langevin-dense", &overrides, 1, 1).for_seconds(seconds).on_threads(1);
            cases.push(case.label("density", TableCell::Number(density, 2)).label("search", name));
            cases.len() - 1
        })
    });
    let auto = prepare_preset("langevin-dense", &scene)?.settings["search"].as_str().unwrap_or("").to_owned();
    Ok(SearchedFluid { law, density, auto, searches })
}

/// Writes the ten frames of LAN17's run as text.
fn write_frames() -> Result<CaseReading, StudyError> {
    let running = RunningScene::begin_timed("langevin-report", &Overrides::new())?;
    let begun = Instant::now();
    for step in 0..10 {
        let frame = ParticleFrame {
            particles: running.simulation.particles(),
            cell: running.domain.lengths(),
            origin: running.domain.corner(),
            periodic: Some(running.domain.periodic()),
            time: 0.0,
            step,
            seed: None,
            has_raised_ids: false,
        };
        // Writing to a sink cannot fail.
        drop(extxyz::write(&frame, &mut std::io::sink()));
    }
    Ok(CaseReading { work: 1.0, seconds: begun.elapsed().as_secs_f64(), ..CaseReading::default() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laboratory::running::on_threads;
    use stripmine_physics::particles::Particle;

    /// Bits of positions and velocities, and the positions, after some steps with sectors or lists.
    fn moved(count: u64, per_side: Option<u64>, threads: usize) -> (Vec<[u64; 4]>, Vec<[f64; 2]>) {
        // Dense, so that sums have many terms and their order matters.
        let side = (count as f64 / 0.7).sqrt();
        let scene = Overrides::new().set(&COUNT, count).set(&SIDES, [side; 2]);
        let scene = match per_side {
            Some(per_side) => scene.set(&SEARCH, PairSearchKind::Sectors).set(&PER_SIDE, per_side),
            None => scene.set(&SEARCH, PairSearchKind::NeighborList),
        };
        let particles = on_threads(threads, || {
            let mut running = RunningScene::begin_timed("langevin-dense", &scene)?;
            running.advance_steps(6)?;
            Ok(running.simulation.particles())
        });
        let particles = particles.unwrap();
        let bits = |it: &Particle| {
            let ([x, y], [u, v]) = (it.planar_position(), it.planar_velocity());
            [x, y, u, v].map(f64::to_bits)
        };
        let all = particles.all();
        (all.iter().map(bits).collect(), all.iter().map(Particle::planar_position).collect())
    }

    /// Few large sectors, whose pairs all threads find together, give identical bits on any number of threads, and agree with lists up to
    /// rounding; so do more and smaller sectors, which are distributed over the threads.
    #[test]
    fn sectors_give_identical_bits_on_any_threads() {
        let count = 5200;
        let (_, by_lists) = moved(count, None, 1);
        for per_side in [3, 20, 34] {
            let (alone, places) = moved(count, Some(per_side), 1);
            for threads in [2, 3] {
                assert!(
                    moved(count, Some(per_side), threads).0 == alone,
                    "{per_side} a side, {threads} threads"
                );
            }
            let off = places.iter().zip(&by_lists).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]));
            let far = off.filter(|off| (1e-8..30.0).contains(off)).count();
            assert_eq!(far, 0, "{per_side} a side");
        }
    }
}
