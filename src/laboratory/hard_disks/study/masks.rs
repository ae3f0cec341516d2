//! ISO99's comparison of masks: cost of a collision by mask and packing fraction, and a fit of ISO99's cost formula.

use super::rates::{ENGINES, fluid_overrides};
use crate::console::CommandFailure;
use crate::frame::{FrameBuilder, ResultFrame};
use crate::laboratory::rates::{ProcessSpread, RateCase, measure_rates};
use crate::laboratory::running::{RunningScene, prepare_preset};
use crate::results::{FinishedItem, StudyEnvironment, StudySize};
use crate::statistics::non_negative;
use stripmine_kernels::mask::Mask;
use stripmine_physics::method::hard_disks::keys::{MASK, MASKS};
use stripmine_physics::method::hard_disks::reference::choice;
use stripmine_physics::method::observed::summary_number;

/// Minimum number of discs.
const DISCS: u64 = 2500;
/// Terms of ISO99's formula.
const TERMS: [&str; 4] = [
    "a collision",
    "a disc in the mask, for each collision",
    "a disc, for each filling",
    "a disc in the mask of a disc, for each filling",
];
/// Unit of the fit: constants are of the order of a nanosecond.
const NANO: f64 = 1e-9;

/// Cost of a collision with a mask at a packing fraction.
struct MaskCost {
    packing_fraction: f64,
    mask: &'static str,
    places: usize,
    /// Number of discs, and mean number of discs in the mask.
    discs: f64,
    candidates: f64,
    /// Fillings of the grid per collision.
    fillings: f64,
    seconds: ProcessSpread,
}

/// Packing fraction, cheapest mask, mask chosen by `auto`, and its cost over that of the cheapest.
type MaskChoice = (f64, &'static str, String, f64);

/// Measures every mask.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, size: StudySize) -> Result<FinishedItem, CommandFailure> {
    let (densities, collisions): (&[f64], _) = match size {
        StudySize::Quick => (&[0.10, 0.50], 3000),
        StudySize::Full | StudySize::All => (&[0.02, 0.10, 0.30, 0.50, 0.70], 10_000),
    };
    let scene = |nu: f64, mask: &str| fluid_overrides(ENGINES[1], DISCS, nu).set(&MASK, mask);
    let masks = MASKS.iter().filter_map(|name| Some((*name, choice::mask(name)?)));
    let masks: Vec<(&str, Mask)> = masks.collect();
    let cases = densities.iter().flat_map(|&nu| {
        masks.iter().map(move |(mask, _)| {
            let case = RateCase::events("hard-disks", &scene(nu, mask), 4 * DISCS, collisions);
            case.label("ν", nu.to_string()).label("mask", *mask)
        })
    });
    let measured = measure_rates(lab, &cases.collect::<Vec<_>>())?;
    let (mut costs, mut choices): (Vec<MaskCost>, Vec<MaskChoice>) = (vec![], vec![]);
    for (&packing_fraction, measured) in densities.iter().zip(measured.chunks_exact(masks.len())) {
        let system = RunningScene::begin_timed("hard-disks", &scene(packing_fraction, "min"))?;
        let occupancy = summary_number(&system.simulation.summary(), "occupancy")?;
        let discs = system.simulation.particles().grain_count() as f64;
        let here = masks.iter().zip(measured).map(|((mask, offsets), measured)| {
            let places = offsets.offsets().len();
            let candidates = places as f64 * occupancy;
            let fillings = measured.count("cell_updates") / discs;
            MaskCost { packing_fraction, mask, places, discs, candidates, fillings, seconds: measured.cost() }
        });
        let here: Vec<MaskCost> = here.collect();
        let auto = prepare_preset("hard-disks", &scene(packing_fraction, "auto"))?.settings;
        let auto = auto["mask"].as_str().unwrap_or_default().to_owned();
        let cheapest = here.iter().min_by(|a, b| a.seconds.median.total_cmp(&b.seconds.median));
        if let (Some(cheapest), Some(chosen)) = (cheapest, here.iter().find(|it| it.mask == auto)) {
            let ratio = chosen.seconds.median / cheapest.seconds.median;
            choices.push((packing_fraction, cheapest.mask, auto, ratio));
        }
        costs.extend(here);
    }
    Ok(FinishedItem::of(frames(&costs, &choices, &masks)).with_seeds([1]))
}

fn frames(costs: &[MaskCost], choices: &[MaskChoice], masks: &[(&str, Mask)]) -> [ResultFrame; 5] {
    let constants = fit_constants(costs);
    let fitted =
        |cost: &MaskCost| formula_terms(cost).iter().zip(constants).map(|(term, it)| term * it).sum::<f64>();
    let ratio = |cost: &MaskCost| fitted(cost) / cost.seconds.median;
    let off = |cost: &MaskCost| ratio(cost).max(ratio(cost).recip());
    let squares: f64 = costs.iter().map(|cost| (ratio(cost) - 1.0).powi(2)).sum();
    let farthest = costs.iter().max_by(|a, b| off(a).total_cmp(&off(b)));
    [
        FrameBuilder::of(costs)
            .number("ν", 2, |cost| cost.packing_fraction)
            .text("mask", |cost| cost.mask)
            .count("places", |cost| cost.places)
            .cell("collision (µs)", |cost| cost.seconds.cell(1e6, 2))
            .number("by the formula (µs)", 2, |cost| 1e6 * fitted(cost))
            .number("fillings in a thousand collisions", 3, |cost| 1e3 * cost.fillings)
            .frame("masks", "Processor time of a collision"),
        FrameBuilder::of(TERMS.into_iter().zip(constants))
            .text("of what", |(term, _)| *term)
            .number("nanoseconds", 2, |(_, constant)| constant / NANO)
            .frame("constants", "ISO99's formula of the cost, fitted"),
        FrameBuilder::of(choices)
            .number("ν", 2, |(nu, ..)| *nu)
            .text("cheapest mask", |(_, cheapest, ..)| *cheapest)
            .text("choice of auto", |(.., auto, _)| auto)
            .number("cost of auto over the cheapest", 2, |(.., ratio)| *ratio)
            .frame("choices", "Cheapest mask, and the choice of `mask = \"auto\"`"),
        FrameBuilder::of(masks)
            .text("mask", |(name, _)| *name)
            .count("places", |(_, mask)| mask.offsets().len())
            .number("distance", 4, |(_, mask)| f64::from(mask.reach_squared()).sqrt())
            .frame("reach", "Smallest distance to the rim of a mask (cells)"),
        FrameBuilder::of(farthest)
            .number("off the formula", 2, |cost| off(cost))
            .number("ν", 2, |cost| cost.packing_fraction)
            .text("mask", |cost| cost.mask)
            .number("error (%)", 0, |_| 100.0 * (squares / costs.len() as f64).sqrt())
            .frame("summary", "Fitted formula: the farthest measurement, and the root of the mean square"),
    ]
}

/// Factors of the fitted constants.
fn formula_terms(cost: &MaskCost) -> [f64; 4] {
    let filled = cost.discs * cost.fillings;
    [1.0, cost.candidates, filled, cost.candidates * filled]
}

/// Non-negative constants from least squares of the relative errors.
fn fit_constants(costs: &[MaskCost]) -> [f64; 4] {
    let row = |cost: &MaskCost| (formula_terms(cost).map(|term| NANO * term / cost.seconds.median), 1.0);
    non_negative(&costs.iter().map(row).collect::<Vec<_>>()).map(|constant| NANO * constant)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The fit recovers the constants from costs computed with the formula.
    #[test]
    fn the_fit_returns_the_constants_of_the_formula() {
        let constants = [1e-7, 2e-9, 3e-8, 3e-9];
        let made = [(8.0, 0.01), (13.0, 0.004), (30.0, 0.001), (90.0, 0.0003), (5.0, 0.1), (70.0, 0.02)];
        let costs = made.map(|(candidates, fillings)| {
            let seconds = ProcessSpread { median: 0.0, range: [0.0; 2] };
            let (packing_fraction, mask, places, discs) = (0.5, "", 0, 100.0);
            let mut cost = MaskCost { packing_fraction, mask, places, discs, candidates, fillings, seconds };
            cost.seconds.median =
                formula_terms(&cost).iter().zip(constants).map(|(term, it)| term * it).sum();
            cost
        });
        for (found, constant) in fit_constants(&costs).into_iter().zip(constants) {
            assert!((found / constant - 1.0).abs() < 1e-2, "{found} {constant}");
        }
    }
}
