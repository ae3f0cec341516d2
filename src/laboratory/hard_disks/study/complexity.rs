//! Cost of a collision against the number of discs: counted operations and processor time.

use super::rates::{ENGINES, fluid_overrides};
use crate::console::CommandFailure;
use crate::frame::FrameBuilder;
use crate::laboratory::rates::{MeasuredCase, RateCase, measure_rates};
use crate::laboratory::running::prepare_preset;
use crate::provenance::MachineDescription;
use crate::results::{FinishedItem, StudyEnvironment, StudySize};
use crate::statistics::{non_negative, slope};

/// Counted operations: names and headings.
const COUNTED: [(&str, &str); 5] = [
    ("predictions", "predictions of a pair"),
    ("searches", "searches for the next event of a disc"),
    ("repairs", "of these for a lost partner"),
    ("queue_moves", "moves in the queue"),
    ("cell_updates", "discs put into a cell"),
];

/// Measured cases of a study size.
struct ComplexityGrid {
    /// Minimum numbers of discs.
    discs: &'static [u64],
    packing_fractions: &'static [f64],
    /// Measured collisions.
    collisions: u64,
    /// Maximum number of discs with ISO99's algorithm.
    most_by_reference: u64,
}

/// Cost of an engine with a number of discs.
struct CollisionCost {
    engine: &'static str,
    packing_fraction: f64,
    discs: f64,
    /// Memory of a run in bytes.
    memory: f64,
    measured: MeasuredCase,
}

/// Logarithm fitted to the times of an engine at a packing fraction: seconds per collision, and additional seconds per doubling of the number
/// of discs.
struct Fit([f64; 2]);

impl Fit {
    /// Fits non-negative constants by least squares of the relative errors.
    fn of(costs: impl Iterator<Item = [f64; 2]>) -> Fit {
        // In nanoseconds, so that numbers are near 1.
        let row = |[discs, seconds]: [f64; 2]| ([1.0, discs.log2()].map(|term| 1e-9 * term / seconds), 1.0);
        Fit(non_negative(&costs.map(row).collect::<Vec<_>>()).map(|constant| 1e-9 * constant))
    }

    /// Seconds per collision.
    fn at(&self, discs: f64) -> f64 {
        self.0[0] + self.0[1] * discs.log2()
    }
}

/// Measures both engines.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, size: StudySize) -> Result<FinishedItem, CommandFailure> {
    let grid = match size {
        StudySize::Quick => ComplexityGrid {
            discs: &[1000, 10_000],
            packing_fractions: &[0.50],
            collisions: 20_000,
            most_by_reference: 10_000,
        },
        StudySize::Full => ComplexityGrid {
            discs: &[1000, 10_000, 100_000],
            packing_fractions: &[0.30, 0.70],
            collisions: 200_000,
            most_by_reference: 100_000,
        },
        StudySize::All => ComplexityGrid {
            discs: &[1000, 10_000, 100_000, 1_000_000, 10_000_000],
            packing_fractions: &[0.30, 0.70],
            collisions: 1_000_000,
            most_by_reference: 1_000_000,
        },
    };
    let mut scenes = vec![];
    for engine in ENGINES {
        let is_measured = |discs: &&u64| engine == ENGINES[0] || **discs <= grid.most_by_reference;
        for &discs in grid.discs.iter().filter(is_measured) {
            scenes.extend(grid.packing_fractions.iter().map(|&packing| (engine, packing, discs)));
        }
    }
    // Ten collisions per disc, to forget the initial lattice and the equal ages of all lists.
    let case = |&(engine, packing, discs): &(&str, f64, u64)| {
        let case = RateCase::events(
            "hard-disks",
            &fluid_overrides(engine, discs, packing),
            5 * discs,
            grid.collisions,
        );
        case.label("engine", engine).label("ν", packing.to_string()).label("discs", discs)
    };
    let measured = measure_rates(lab, &scenes.iter().map(case).collect::<Vec<_>>())?;
    let cost = |((engine, packing_fraction, discs), measured): (_, MeasuredCase)| {
        let scene = prepare_preset("hard-disks", &fluid_overrides(engine, discs, packing_fraction))?;
        let discs = scene.particles().grain_count() as f64;
        Ok(CollisionCost { engine, packing_fraction, discs, memory: scene.memory.needed as f64, measured })
    };
    let costs =
        scenes.into_iter().zip(measured).map(cost).collect::<Result<Vec<CollisionCost>, CommandFailure>>()?;
    let fit = |it: &CollisionCost| {
        let alike = |other: &&CollisionCost| {
            (other.engine, other.packing_fraction) == (it.engine, it.packing_fraction)
        };
        let seen = costs.iter().filter(alike).map(|it| [it.discs, it.measured.cost().median]);
        Fit::of(seen).at(it.discs)
    };
    let off =
        |it: &CollisionCost| (fit(it) / it.measured.cost().median).max(it.measured.cost().median / fit(it));
    let fast = || costs.iter().filter(|it| it.engine == ENGINES[0]);
    let [discs, memory] = [|it: &CollisionCost| it.discs, |it: &CollisionCost| it.memory]
        .map(|of| fast().map(of).collect::<Vec<_>>());
    let bytes = slope(&discs, &memory);
    let rows = COUNTED.into_iter().fold(
        FrameBuilder::of(&costs)
            .text("engine", |it| it.engine)
            .number("ν", 2, |it| it.packing_fraction)
            .count("discs", |it| it.discs as u64)
            .cell("time (µs)", |it| it.measured.cost().cell(1e6, 3)),
        |rows, (kind, heading)| rows.number(heading, 3, move |it| it.measured.count(kind)),
    );
    Ok(FinishedItem::of([
        rows.number("by the fit (µs)", 3, |it| 1e6 * fit(it))
            .frame("complexity", "Of a collision: processor time and counted operations"),
        FrameBuilder::of(MachineDescription::here().data_caches())
            .text("cache", |(name, _)| name.clone())
            .number("bytes", 0, |(_, bytes)| *bytes)
            .number("discs", 0, |(_, size)| size / bytes)
            .frame("caches", "Discs of the fast engine that a cache holds"),
        FrameBuilder::of([()])
            .number("off a logarithm", 2, |()| costs.iter().map(off).fold(1.0, f64::max))
            .number("bytes of a disc", 0, |()| bytes)
            .frame(
                "summary",
                "Largest factor between a time and the logarithm fitted to it; memory of the fast engine",
            ),
    ])
    .with_seeds([1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_logarithm_fits_exactly() {
        let on = |discs: f64| [discs, 1e-9 * (200.0 + 30.0 * discs.log2())];
        let all = [1024.0, 16_384.0, 1_048_576.0].map(on);
        let found = Fit::of(all.into_iter());
        assert!((found.0[0] / 200e-9 - 1.0).abs() < 1e-2 && (found.0[1] / 30e-9 - 1.0).abs() < 1e-2);
        let far = [4_194_304.0, 4e-6];
        let found = Fit::of(all.into_iter().chain([far]));
        assert!(all.into_iter().chain([far]).any(|[discs, seconds]| {
            let off = found.at(discs) / seconds;
            !(1.0 / 1.5..1.5).contains(&off)
        }));
    }
}
