//! Grains of two sizes: the ratio of the radii that each mask admits, and the time of a step over the ratio by lattice, lists and sectors.

use super::density_cost::crossing;
use crate::console::CommandFailure;
use crate::frame::FrameBuilder;
use crate::laboratory::mixtures::{ComparedPairs, SMALL, largest_ratio, mixture};
use crate::laboratory::rates::{MeasuredCase, RateCase, measure_rates};
use crate::laboratory::running::{RunningScene, prepare_preset};
use crate::results::{FinishedItem, StudyEnvironment, StudySize};
use stripmine_physics::method::lattice_md::keys::{
    CELL_EDGE, COHESIONLESS, ENGINE, EXECUTION, INTEGRATOR, MASK, ON_CONFLICT, SEARCH, TEXT,
};
use stripmine_physics::method::lattice_md::options::{EngineChoice, IntegratorKind};
use stripmine_physics::method::observed::summary_number;
use stripmine_physics::scene::Overrides;

/// Packing fraction of the mixtures.
const PACKING_FRACTION: f64 = 0.8;
/// Masks: their widths in cells, and their names.
const MASKS: [(u64, &str); 2] = [(5, "5×5"), (7, "7×7")];
/// Gap of a listed pair, in largest radii: the default of dense scenes.
const SKIN: f64 = 0.3;

/// Name of a search, the smallest and the largest ratio of the radii at which it is measured, and its overrides.
type MixedSearch = (&'static str, [f64; 2], fn(Overrides, f64) -> Overrides);

/// Searches. BP93's programs and the fast engine on the lattice have one disc a cell; with shared cells they are slow long before a ratio of 10.
const SEARCHES: [MixedSearch; 7] = [
    ("programs, 5×5", [1.0, 1.27], |scene, _| set_programs(scene).set(&MASK, MASKS[0].0)),
    ("programs, 7×7", [1.0, 1.9], |scene, _| set_programs(scene).set(&MASK, MASKS[1].0)),
    ("lattice, 5×5", [1.0, 1.27], |scene, _| set_fast(scene, "lattice").set(&MASK, MASKS[0].0)),
    ("lattice, 7×7", [1.0, 1.9], |scene, _| set_fast(scene, "lattice").set(&MASK, MASKS[1].0)),
    ("lattice, shared cells", [1.5, 4.0], |scene, ratio| {
        // Hardly wider than a third of the largest contact, which the mask of 7×7 needs.
        let scene = set_fast(scene, "lattice").set(&CELL_EDGE, 1.01 * 2.0 * ratio * SMALL / 3.0);
        scene.set(&MASK, MASKS[1].0).set(&ON_CONFLICT, "resolve")
    }),
    ("lists", [1.0, 10.0], |scene, _| set_fast(scene, "neighbor-list")),
    ("sectors", [1.0, 10.0], |scene, _| set_fast(scene, "sectors")),
];

fn set_programs(scene: Overrides) -> Overrides {
    let scene = scene.set(&TEXT, "ours").set(&EXECUTION, "chained").set(&COHESIONLESS, false);
    scene.set(&SEARCH, "lattice")
}

fn set_fast(scene: Overrides, by: &str) -> Overrides {
    let scene = scene.set(&ENGINE, EngineChoice::Fast).set(&INTEGRATOR, IntegratorKind::VelocityVerlet);
    scene.set(&SEARCH, by)
}

/// Scene of a search at a ratio of the radii.
fn mixture_scene((.., set): MixedSearch, ratio: f64, discs: u64) -> Overrides {
    set(mixture(ratio, discs, PACKING_FRACTION), ratio)
}

/// Searches that are measured at a ratio of the radii.
fn searches_at(ratio: f64) -> impl Iterator<Item = MixedSearch> {
    SEARCHES.into_iter().filter(move |(_, [least, most], _)| (*least..=*most).contains(&ratio))
}

/// Measures every search.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, size: StudySize) -> Result<FinishedItem, CommandFailure> {
    // At these numbers of discs whole cells of 7×7 fill the box at 1:1.9.
    let (ratios, discs, steps, seconds): (&[f64], u64, u64, f64) = match size {
        StudySize::Quick => (&[1.0, 1.9, 10.0], 555, 20, 0.0),
        StudySize::Full | StudySize::All => (&[1.0, 1.2, 1.9, 2.5, 4.0, 6.0, 10.0], 2470, 100, 0.06),
    };
    let searches: Vec<(f64, MixedSearch)> =
        ratios.iter().flat_map(|&ratio| searches_at(ratio).map(move |search| (ratio, search))).collect();
    let cases = searches.iter().map(|&(ratio, search)| {
        let case = RateCase::steps("bench", &mixture_scene(search, ratio, discs), steps, steps);
        case.for_seconds(seconds).label("ratio", ratio.to_string()).label("search", search.0)
    });
    let measured = measure_rates(lab, &cases.collect::<Vec<_>>())?;
    let times: Vec<(f64, &str, &MeasuredCase)> =
        searches.iter().zip(&measured).map(|((ratio, search), it)| (*ratio, search.0, it)).collect();
    let programs = MASKS.iter().zip(SEARCHES).map(|(&(mask, name), search)| {
        let programs = prepare_preset("bench", &mixture_scene(search, 1.0, discs))?.model.programs();
        let operations = programs.iter().flat_map(|it| it.program.tally()).map(|(_, counts)| counts.total());
        Ok((name, admitted_ratio(mask), operations.sum::<u64>()))
    });
    let programs = programs.collect::<Result<Vec<_>, CommandFailure>>()?;
    let pairs = ratios.iter().map(|&ratio| {
        let mut running = RunningScene::begin_timed("bench", &mixture_scene(SEARCHES[5], ratio, discs))?;
        let particles = running.simulation.particles();
        let near = |margin| ComparedPairs::of(&running.domain, particles.all(), margin);
        let [contacts, lists] = [0.0, SKIN * ratio * SMALL].map(near);
        running.advance_steps(1)?;
        let listed = summary_number(&running.simulation.summary(), "listed_pairs")? / discs as f64;
        Ok((ratio, contacts, listed, lists.within_largest))
    });
    let pairs = pairs.collect::<Result<Vec<_>, CommandFailure>>()?;
    // Name and seconds of the fastest search of the fast engine at a ratio, among those whose names begin with some words.
    let fastest = |ratio: f64, names: &[&str]| {
        let own = times
            .iter()
            .filter(|(at, name, _)| *at == ratio && names.iter().any(|begin| name.starts_with(begin)));
        let seconds = own.map(|(_, name, it)| (*name, it.cost().median));
        seconds.min_by(|(_, a), (_, b)| a.total_cmp(b))
    };
    let all = ["lattice", "lists", "sectors"];
    let over_others = |ratio: f64| Some(fastest(ratio, &all[..1])?.1 / fastest(ratio, &all[1..])?.1);
    let over_equal = |ratio: f64, names: &[&str]| Some(fastest(1.0, names)?.1 / fastest(ratio, names)?.1);
    let others = ratios.iter().filter_map(|&ratio| Some((ratio, over_others(ratio)?.recip())));
    Ok(FinishedItem::of([
        FrameBuilder::of(&programs)
            .text("mask", |(mask, ..)| *mask)
            .number("largest ratio", 4, |(_, ratio, _)| *ratio)
            .count("operations", |(.., operations)| *operations)
            .frame(
                "programs",
                "Largest ratio of the radii that a mask admits, and vector operations of a step",
            ),
        FrameBuilder::of(&times)
            .number("ratio", 1, |(ratio, ..)| *ratio)
            .text("search", |(_, search, _)| *search)
            .cell("time (ns)", |(.., it)| it.cost().cell(1e9, 1))
            .frame("times", "Processor time of a disc and step"),
        FrameBuilder::of(ratios)
            .number("ratio", 1, |ratio| **ratio)
            .text("fastest search", |ratio| fastest(**ratio, &all).map_or("", |(name, _)| name))
            .number("lattice over the fastest other search", 3, |ratio| over_others(**ratio))
            .number("fastest rate over that of equal discs", 3, |ratio| over_equal(**ratio, &all))
            .number("rate by lists over that of equal discs", 3, |ratio| over_equal(**ratio, &all[1..2]))
            .number("rate by sectors over that of equal discs", 3, |ratio| over_equal(**ratio, &all[2..]))
            .frame("pays", "Lattice compared with lists and sectors, and all with equal discs"),
        FrameBuilder::of([crossing(&others.collect::<Vec<_>>())]).number("ratio", 2, |ratio| *ratio).frame(
            "stops",
            "Ratio of the radii at which the lattice costs as much as the fastest other search",
        ),
        FrameBuilder::of(&pairs)
            .number("ratio", 1, |(ratio, ..)| *ratio)
            .number("one grid", 1, |(_, contacts, ..)| contacts.one_grid)
            .number("a grid for each size", 1, |(_, contacts, ..)| contacts.grid_of_each_size)
            .number("listed", 1, |(_, _, listed, _)| *listed)
            .number("within the largest contact", 1, |(.., largest)| *largest)
            .frame("pairs", "Pairs for each disc that a search compares or lists"),
    ])
    .with_seeds([1]))
}

/// Largest ratio of the radii that the check of a scene admits with a mask.
fn admitted_ratio(mask: u64) -> f64 {
    // Two centres come as close as the preset's largest penetration of 0.1 allows.
    let widest = 0.9 * std::f64::consts::SQRT_2 * SMALL;
    largest_ratio(widest, |scene| {
        prepare_preset("bench", &scene.clone().set(&SEARCH, "lattice").set(&MASK, mask)).is_ok()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_physics::method::Until;

    /// 2 R_max is the mask's half-width in cells of (1 − 0.1) √2 R_min: BP93's 1.8/√2 for 5×5, and 2.7/√2 for 7×7.
    #[test]
    fn admitted_ratios_follow_from_cells() {
        for ((mask, _), by_hand) in MASKS.into_iter().zip([1.272_792, 1.909_188]) {
            assert!((admitted_ratio(mask) / by_hand - 1.0).abs() < 1e-5, "{mask}");
        }
    }

    #[test]
    fn searches_have_the_same_contacts() {
        for ratio in [1.9, 4.0] {
            let fast = searches_at(ratio).filter(|(name, ..)| !name.starts_with("programs"));
            let ends = fast.map(|search| {
                let mut running = RunningScene::begin("bench", &mixture_scene(search, ratio, 555)).unwrap();
                running.advance_until(Until::Steps(20)).unwrap();
                running.observed_values(["elastic", "kinetic"]).unwrap()
            });
            let ends: Vec<[f64; 2]> = ends.collect();
            assert!(ends.len() >= 3 && ends[0][0] > 0.0);
            for end in &ends {
                assert!((0..2).all(|at| (end[at] / ends[0][at] - 1.0).abs() < 1e-9), "{ratio}: {ends:?}");
            }
        }
    }
}
