//! ISO99's comparison of masks with linked cells and crossing events: operations and time of a collision over N_g/N_c.

use super::rates::fluid_overrides;
use crate::console::CommandFailure;
use crate::frame::{FrameBuilder, ResultFrame};
use crate::laboratory::rates::{MeasuredCase, ProcessSpread, RateCase, measure_rates};
use crate::laboratory::running::RunningScene;
use crate::results::{FinishedItem, StudyEnvironment, StudySize};
use crate::statistics::slope;
use stripmine_kernels::mask::Mask;
use stripmine_physics::method::hard_disks::keys::{DISCS_IN_CELL, MASK};
use stripmine_physics::method::hard_disks::options::EngineChoice;
use stripmine_physics::method::hard_disks::reference::choice;
use stripmine_physics::method::observed::summary_number;
use stripmine_physics::scene::Overrides;
use stripmine_physics::words::Words;

/// Minimum number of discs of the comparison over N_g/N_c.
const DISCS: u64 = 2500;
/// Masks, and mean numbers of discs in a linked cell.
const SETTINGS: [&[&str]; 2] = [&["min", "r3", "r4", "r6", "r8"], &["0.5", "1", "2", "4", "8"]];
/// Engines: masks, and cell crossing.
const ENGINES: [EngineChoice; 2] = [EngineChoice::Reference, EngineChoice::CellCrossing];
/// Counted operations.
const COUNTED: [&str; 3] = ["predictions", "queue_moves", "cell_updates"];

/// Cost of a collision with a setting of an engine.
struct SearchCost {
    packing_fraction: f64,
    /// Index of the engine.
    engine: usize,
    setting: &'static str,
    discs: f64,
    /// N_g: discs in the mask; or N_c: discs in a linked cell.
    seen: f64,
    /// Operations of each kind for a collision.
    operations: [f64; 3],
    seconds: ProcessSpread,
}

impl SearchCost {
    fn all_operations(&self) -> f64 {
        self.operations.iter().sum()
    }
}

/// A mask and a linked cell at one packing fraction.
struct SearchComparison<'c> {
    mask: &'c SearchCost,
    cell: &'c SearchCost,
}

impl SearchComparison<'_> {
    /// N_g/N_c.
    fn discs_ratio(&self) -> f64 {
        self.mask.seen / self.cell.seen
    }

    /// Operations and time of cell crossing over those with the mask.
    fn cost_ratios(&self) -> [f64; 2] {
        let operations = self.cell.all_operations() / self.mask.all_operations();
        [operations, self.cell.seconds.median / self.mask.seconds.median]
    }
}

/// Measures both engines.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, size: StudySize) -> Result<FinishedItem, CommandFailure> {
    let (packings, many, collisions): (&[f64], u64, u64) = match size {
        StudySize::Quick => (&[0.10, 0.50], DISCS, 3000),
        StudySize::Full => (&[0.02, 0.10, 0.30, 0.50, 0.70], 50_000, 20_000),
        StudySize::All => (&[0.02, 0.10, 0.30, 0.50, 0.70], 1_000_000, 200_000),
    };
    let few = measure_grid(lab, packings, DISCS, SETTINGS, collisions)?;
    // The largest system with the fastest setting of each engine.
    let mut many_costs = vec![];
    for &packing in packings {
        let fastest = [0, 1].map(|engine| [best(&few, packing, engine).setting]);
        many_costs.extend(measure_grid(lab, &[packing], many, [&fastest[0], &fastest[1]], collisions)?);
    }
    Ok(FinishedItem::of(frames(&few, &many_costs, packings)).with_seeds([1]))
}

/// Measures each setting of both engines at each packing fraction.
fn measure_grid(
    lab: &StudyEnvironment<'_>,
    packings: &[f64],
    discs: u64,
    settings: [&[&'static str]; 2],
    collisions: u64,
) -> Result<Vec<SearchCost>, CommandFailure> {
    let each = |engine: usize| settings[engine].iter().map(move |&setting| (engine, setting));
    let all: Vec<(f64, usize, &'static str)> = packings
        .iter()
        .flat_map(|&packing| [0, 1].into_iter().flat_map(each).map(move |(engine, it)| (packing, engine, it)))
        .collect();
    let cases = all.iter().map(|&(packing, engine, setting)| {
        let case =
            RateCase::events("hard-disks", &scene(packing, engine, setting, discs), 4 * discs, collisions);
        let case = case.label("ν", packing.to_string()).label("engine", ENGINES[engine].word());
        case.label("setting", setting).label("discs", discs)
    });
    let measured = measure_rates(lab, &cases.collect::<Vec<_>>())?;
    let cost =
        |((packing_fraction, engine, setting), measured): ((f64, usize, &'static str), MeasuredCase)| {
            let running =
                RunningScene::begin_timed("hard-disks", &scene(packing_fraction, engine, setting, discs))?;
            let summary = running.simulation.summary();
            let seen = match choice::mask(setting) {
                Some(mask) => offsets(&mask) * summary_number(&summary, "occupancy")?,
                None => summary_number(&summary, "discs_in_cell")?,
            };
            let discs = running.simulation.particles().grain_count() as f64;
            let operations = COUNTED.map(|kind| measured.count(kind));
            Ok(SearchCost {
                packing_fraction,
                engine,
                setting,
                discs,
                seen,
                operations,
                seconds: measured.cost(),
            })
        };
    all.into_iter().zip(measured).map(cost).collect()
}

fn offsets(mask: &Mask) -> f64 {
    mask.offsets().len() as f64
}

fn scene(packing: f64, engine: usize, setting: &str, discs: u64) -> Overrides {
    let scene = fluid_overrides(ENGINES[engine].word(), discs, packing);
    match engine {
        0 => scene.set(&MASK, setting),
        _ => scene.set(&DISCS_IN_CELL, setting.parse::<f64>().unwrap_or(1.0)),
    }
}

/// Fastest setting of an engine.
fn best(costs: &[SearchCost], packing: f64, engine: usize) -> &SearchCost {
    let own = costs.iter().filter(|it| (it.packing_fraction, it.engine) == (packing, engine));
    own.min_by(|a, b| a.seconds.median.total_cmp(&b.seconds.median)).unwrap_or(&costs[0])
}

fn frames(few: &[SearchCost], many: &[SearchCost], packings: &[f64]) -> [ResultFrame; 4] {
    let all = || few.iter().chain(many.iter().filter(|it| it.discs > 1.5 * few[0].discs));
    let of_engine = |engine: usize, nu: f64| {
        few.iter().filter(move |it| it.engine == engine && it.packing_fraction == nu)
    };
    let at = |nu: f64| {
        let pair = move |mask| of_engine(1, nu).map(move |cell| SearchComparison { mask, cell });
        of_engine(0, nu).flat_map(pair).collect::<Vec<_>>()
    };
    let pairs: Vec<SearchComparison<'_>> = packings.iter().flat_map(|&nu| at(nu)).collect();
    let of_many = |nu: f64| [0, 1].map(|engine| best(many, nu, engine));
    let costs = FrameBuilder::of(all())
        .number("ν", 2, |it| it.packing_fraction)
        .text("engine", |it| ENGINES[it.engine].word())
        .text("setting", |it| it.setting)
        .count("discs", |it| it.discs as u64)
        .number("discs in mask or cell", 2, |it| it.seen)
        .number("predictions of a pair", 2, |it| it.operations[0])
        .number("moves in the queue", 2, |it| it.operations[1])
        .number("discs put into a cell", 3, |it| it.operations[2])
        .cell("time (µs)", |it| it.seconds.cell(1e6, 3));
    [
        costs.frame("costs", "Of a collision: counted operations and processor time"),
        FrameBuilder::of(&pairs)
            .number("ν", 2, |it| it.mask.packing_fraction)
            .text("mask", |it| it.mask.setting)
            .number("discs in cell", 1, |it| it.cell.setting.parse().ok())
            .number("N_g over N_c", 2, |it| it.discs_ratio())
            .number("operations of cell crossing over those with masks", 3, |it| it.cost_ratios()[0])
            .number("time of cell crossing over that with masks", 3, |it| it.cost_ratios()[1])
            .frame("pairs", "Cell crossing compared with masks"),
        FrameBuilder::of(packings)
            .number("ν", 2, |nu| **nu)
            .number("N_g over N_c at equal operations", 2, |nu| equal_cost(&at(**nu), 0))
            .number("N_g over N_c at equal time", 2, |nu| equal_cost(&at(**nu), 1))
            .frame("equal", "N_g/N_c at which masks and cell crossing cost the same"),
        FrameBuilder::of(packings)
            .number("ν", 2, |nu| **nu)
            .text("mask", |nu| of_many(**nu)[0].setting)
            .number("discs in cell", 1, |nu| of_many(**nu)[1].setting.parse().ok())
            .count("discs", |nu| of_many(**nu)[0].discs as u64)
            .number("operations with masks over those of cell crossing", 3, |nu| {
                let [mask, cell] = of_many(**nu);
                mask.all_operations() / cell.all_operations()
            })
            .number("time with masks over that of cell crossing", 3, |nu| {
                let [mask, cell] = of_many(**nu);
                mask.seconds.median / cell.seconds.median
            })
            .frame("best", "Fastest setting of each engine, most discs"),
    ]
}

/// N_g/N_c at which the cost ratio (operations or time) is 1, by a power law fitted to all comparisons; none outside the compared values.
fn equal_cost(pairs: &[SearchComparison<'_>], which: usize) -> Option<f64> {
    let x: Vec<f64> = pairs.iter().map(|it| it.discs_ratio().ln()).collect();
    let y: Vec<f64> = pairs.iter().map(|it| it.cost_ratios()[which].ln()).collect();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let equal = mean(&x) - mean(&y) / slope(&x, &y);
    let [least, most] = [f64::min, f64::max].map(|of| x.iter().copied().reduce(of).unwrap_or(f64::NAN));
    (least..=most).contains(&equal).then(|| equal.exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Costs of 9 N_c and 2 N_g predictions are equal at N_g/N_c = 4.5, the paper's rough estimate.
    #[test]
    fn costs_by_the_formula_are_equal_there() {
        let cost = |engine: usize, seen: f64| {
            let predictions = if engine == 0 { 2.0 * seen } else { 9.0 * seen };
            let seconds = ProcessSpread { median: 3e-9 * predictions, range: [0.0; 2] };
            let operations = [predictions, 0.0, 0.0];
            SearchCost { packing_fraction: 0.5, engine, setting: "", discs: 0.0, seen, operations, seconds }
        };
        let (masks, cells) = ([8.0, 13.0, 40.0].map(|it| cost(0, it)), [1.0, 2.0, 5.0].map(|it| cost(1, it)));
        let pairs: Vec<SearchComparison<'_>> = masks
            .iter()
            .flat_map(|mask| cells.iter().map(move |cell| SearchComparison { mask, cell }))
            .collect();
        for which in 0..2 {
            assert!((equal_cost(&pairs, which).unwrap() - 4.5).abs() < 1e-9);
            // Of a single pair nothing follows.
            assert_eq!(equal_cost(&pairs[..1], which), None);
        }
    }
}
