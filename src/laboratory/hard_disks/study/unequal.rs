//! Discs of two sizes: the ratio of the radii that each mask of ISO99 admits, and the cost of a collision over the ratio by every engine.

use crate::console::CommandFailure;
use crate::frame::{FrameBuilder, TableCell};
use crate::laboratory::mixtures::{ComparedPairs, SMALL, largest_ratio, mixture};
use crate::laboratory::rates::{MeasuredCase, RateCase, measure_rates};
use crate::laboratory::running::{RunningScene, prepare_preset};
use crate::results::{FinishedItem, StudyEnvironment, StudySize};
use crate::study::StudyError;
use stripmine_physics::method::hard_disks::keys::{ENGINE, MASK, MASKS};
use stripmine_physics::method::hard_disks::options::EngineChoice;
use stripmine_physics::method::hard_disks::reference::choice;
use stripmine_physics::method::observed::summary_number;
use stripmine_physics::scene::Overrides;

/// Packing fraction, and the area that both sizes together cover.
const PACKING_FRACTION: f64 = 0.5;
/// Searches, and the engines that have them.
const SEARCHES: [(&str, EngineChoice); 3] = [
    ("masks", EngineChoice::Reference),
    ("lists", EngineChoice::Fast),
    ("cell crossing", EngineChoice::CellCrossing),
];
/// Counted operations.
const COUNTED: [&str; 3] = ["predictions", "queue_moves", "cell_updates"];

/// Search for events at a ratio of the radii.
#[derive(Clone, Copy)]
struct MixtureSearch {
    ratio: f64,
    /// Index of the search.
    search: usize,
    /// Mask, for masks.
    mask: Option<&'static str>,
}

impl MixtureSearch {
    fn scene(self, discs: u64) -> Overrides {
        let scene = mixture(self.ratio, discs, PACKING_FRACTION).set(&ENGINE, SEARCHES[self.search].1);
        self.mask.into_iter().fold(scene, |scene, mask| scene.set(&MASK, mask))
    }
}

/// Measures every search.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, size: StudySize) -> Result<FinishedItem, CommandFailure> {
    let (ratios, discs): (&[f64], u64) = match size {
        StudySize::Quick => (&[1.0, 6.0, 10.0], 800),
        StudySize::Full | StudySize::All => (&[1.0, 1.3, 2.0, 3.0, 4.0, 6.0, 8.0, 10.0], 4000),
    };
    let reaches = mask_reaches();
    let searches = ratios.iter().flat_map(|&ratio| {
        let masks = reaches.iter().filter(move |(_, most)| ratio < *most).map(|(mask, _)| (0, Some(*mask)));
        masks.chain([(1, None), (2, None)]).map(move |(search, mask)| MixtureSearch { ratio, search, mask })
    });
    let searches: Vec<MixtureSearch> = searches.collect();
    let cases = searches.iter().map(|it| {
        let case = RateCase::events("hard-disks", &it.scene(discs), 4 * discs, 4 * discs);
        let case = case
            .for_seconds(0.05)
            .label("ratio", it.ratio.to_string())
            .label("search", SEARCHES[it.search].0);
        case.label("mask", it.mask.unwrap_or_default())
    });
    let measured = measure_rates(lab, &cases.collect::<Vec<_>>())?;
    let costs: Vec<(MixtureSearch, &MeasuredCase)> = searches.into_iter().zip(&measured).collect();
    let fastest = |ratio: f64, search: usize| {
        let own = costs.iter().filter(move |(it, _)| (it.ratio, it.search) == (ratio, search));
        own.min_by(|(_, a), (_, b)| a.cost().median.total_cmp(&b.cost().median))
    };
    let seconds = |ratio: f64, search: usize| Some(fastest(ratio, search)?.1.cost().median);
    let rate_over_equal = |ratio: f64, search: usize| Some(seconds(1.0, search)? / seconds(ratio, search)?);
    let over_lists = |ratio: f64, search: usize| Some(seconds(ratio, search)? / seconds(ratio, 1)?);
    let masked = ratios.iter().filter_map(|&ratio| Some(fastest(ratio, 0)?.0));
    let bits = masked.map(|it| Ok((it, same_bits(it, discs)?))).collect::<Result<Vec<_>, StudyError>>()?;
    let pairs = ratios.iter().map(|&ratio| Ok((ratio, registered_pairs(ratio, discs)?)));
    let pairs = pairs.collect::<Result<Vec<_>, CommandFailure>>()?;
    Ok(FinishedItem::of([
        FrameBuilder::of(&reaches)
            .text("mask", |(mask, _)| *mask)
            .count("cells", |(mask, _)| choice::mask(mask).map_or(0, |it| it.offsets().len()))
            .number("largest ratio", 4, |(_, ratio)| *ratio)
            .frame("ratios", "Largest ratio of the radii that a mask admits"),
        FrameBuilder::of(&costs)
            .number("ratio", 1, |(it, _)| it.ratio)
            .text("search", |(it, _)| SEARCHES[it.search].0)
            .text("mask", |(it, _)| it.mask.unwrap_or_default())
            .cell("time (µs)", |(_, it)| it.cost().cell(1e6, 3))
            .cells(["predictions of a pair", "moves in the queue", "discs put into a cell"], |(_, it)| {
                COUNTED.map(|kind| TableCell::Number(it.count(kind), 2))
            })
            .frame("costs", "Of a collision: processor time and counted operations"),
        FrameBuilder::of(ratios)
            .number("ratio", 1, |ratio| **ratio)
            .text("fastest mask", |ratio| fastest(**ratio, 0).and_then(|(it, _)| it.mask).unwrap_or("none"))
            .number("rate with masks over that of equal discs", 3, |ratio| rate_over_equal(**ratio, 0))
            .number("rate by lists over that of equal discs", 3, |ratio| rate_over_equal(**ratio, 1))
            .number("rate by cell crossing over that of equal discs", 3, |ratio| rate_over_equal(**ratio, 2))
            .number("time with masks over that by lists", 2, |ratio| over_lists(**ratio, 0))
            .number("time by cell crossing over that by lists", 2, |ratio| over_lists(**ratio, 2))
            .frame("best", "Rate over the ratio of the radii, each search with its fastest mask"),
        FrameBuilder::of(&bits)
            .number("ratio", 1, |(it, _)| it.ratio)
            .text("mask", |(it, _)| it.mask.unwrap_or_default())
            .count("collisions", |_| 2 * discs)
            .text("same bits", |(_, same)| if *same { "yes" } else { "no" })
            .frame("bits", "States by masks and by lists after the same collisions"),
        FrameBuilder::of(&pairs)
            .number("ratio", 1, |(ratio, _)| *ratio)
            .number("one grid", 1, |(_, it)| it.one_grid)
            .number("a grid for each size", 1, |(_, it)| it.grid_of_each_size)
            .number("listed", 1, |(_, it)| it.within_own)
            .frame("pairs", "Pairs for each disc that a registration of all discs compares or lists"),
    ])
    .with_seeds([1]))
}

/// Masks, with the largest ratio of the radii that the check of a scene admits with each.
fn mask_reaches() -> Vec<(&'static str, f64)> {
    // Cells of the smallest disc, whose side is just below √2 radii.
    let cell = std::f64::consts::SQRT_2 * SMALL * (1.0 - 1e-9);
    let masks = MASKS.iter().filter(|mask| choice::mask(mask).is_some());
    let reach = |&mask: &&'static str| {
        let admits = |scene: &Overrides| {
            let scene = scene.clone().set(&ENGINE, EngineChoice::Reference).set(&MASK, mask);
            prepare_preset("hard-disks", &scene).is_ok()
        };
        (mask, largest_ratio(cell, admits))
    };
    masks.map(reach).collect()
}

/// True if masks and lists end in the same state after two collisions for each disc.
fn same_bits(masked: MixtureSearch, discs: u64) -> Result<bool, StudyError> {
    let ended = |search: MixtureSearch| {
        let mut running = RunningScene::begin_timed("hard-disks", &search.scene(discs))?;
        running.advance_events(2 * discs)?;
        Ok::<_, StudyError>(running.simulation.particles())
    };
    Ok(ended(masked)?.all() == ended(MixtureSearch { search: 1, mask: None, ..masked })?.all())
}

/// Pairs that the lists of a mixture have, and those compared to make them.
fn registered_pairs(ratio: f64, discs: u64) -> Result<ComparedPairs, CommandFailure> {
    let scene = MixtureSearch { ratio, search: 1, mask: None }.scene(discs);
    let running = RunningScene::begin_timed("hard-disks", &scene)?;
    let limit = summary_number(&running.simulation.summary(), "displacement_limit")?;
    Ok(ComparedPairs::of(&running.domain, running.simulation.particles().all(), 2.0 * limit))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2 R_max is the distance of ISO99's table 1, in cells of √2 R_min: √2, √(5/2), √(13/2), 3, √(29/2), √20, √26, 6, √(85/2).
    #[test]
    fn admitted_ratios_follow_from_table_1() {
        let squares = [2.0, 2.5, 6.5, 9.0, 14.5, 20.0, 26.0, 36.0, 42.5_f64];
        let found = mask_reaches();
        assert_eq!(found.len(), squares.len());
        for ((mask, ratio), square) in found.into_iter().zip(squares) {
            assert!((ratio / square.sqrt() - 1.0).abs() < 1e-5, "{mask}: {ratio}");
        }
    }

    #[test]
    fn masks_and_lists_agree_on_mixtures() {
        for (ratio, mask) in [(1.3, "min"), (2.0, "r4"), (6.0, "r10")] {
            assert!(same_bits(MixtureSearch { ratio, search: 0, mask: Some(mask) }, 400).unwrap(), "{ratio}");
        }
    }
}
