//! Inelastic collapse by restitution and number of discs, in a row and in the plane: the limit of the method.

use super::advance_or_collapse;
use crate::console::CommandFailure;
use crate::frame::{FrameBuilder, TableCell};
use crate::laboratory::running::{RunningScene, bisect_range, prepare_preset};
use crate::results::{FinishedItem, ProgressMeter, StudyEnvironment, StudySize};
use crate::study::StudyError;
use rand::RngExt;
use std::f64::consts::FRAC_PI_4;
use stripmine_kernels::noise::{RandomPurpose, Stream};
use stripmine_physics::method::Until;
use stripmine_physics::method::hard_disks::keys::RESTITUTION;
use stripmine_physics::scene::{COUNT, Overrides, PACKING_FRACTION, POSITIONS, SEED, VELOCITIES};

/// Numbers of discs in a row.
const ROWS: [u32; 7] = [3, 4, 5, 6, 8, 12, 16];
/// Starts of a row; the result is the largest restitution at which one of them collapses.
const STARTS: u32 = 24;
/// Width of the bisected interval of the restitution.
const RESOLUTION: f64 = 2e-4;
/// Restitutions and numbers of discs of the map.
const RESTITUTIONS: [f64; 9] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];
const DISCS: [u64; 6] = [16, 64, 256, 1024, 4096, 16_384];
/// Seeds at each point of the map.
const SEEDS: u64 = 3;
/// Collisions per disc in the runs of the map.
const COLLISIONS: f64 = 200.0;
/// Packing fraction of the gases of the map.
const PACKING: f64 = 0.25;

/// Restitution below which discs in a row can collapse: tan²(π/4 (1 − 2/N)). Exact for three discs (7 − 4√3); for more an estimate after Bernu
/// and Mazighi (1990) that treats each half as a column hitting a wall.
fn row_criterion(discs: f64) -> f64 {
    if discs > 2.0 { (FRAC_PI_4 * (1.0 - 2.0 / discs)).tan().powi(2) } else { 0.0 }
}

/// Surveys rows and gases.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let places = DISCS.iter().flat_map(|&discs| RESTITUTIONS.map(|restitution| (discs, restitution)));
    let places: Vec<(u64, f64)> = places.collect();
    let meter = ProgressMeter::new((ROWS.len() + places.len()) as f64, lab.progress);
    let rows = meter.run_cases(&ROWS, |&discs| row_threshold(discs))?;
    let shares =
        meter.run_cases_from_last(&places, |&(discs, restitution)| collapse_share(discs, restitution))?;
    let discs = DISCS
        .map(|discs| Ok(prepare_preset("cooling-gas", &gas_overrides(discs))?.particles().grain_count()));
    let discs: Vec<usize> = discs.into_iter().collect::<Result<_, StudyError>>()?;
    let gases = || discs.iter().zip(shares.chunks(RESTITUTIONS.len()));
    let places = gases().flat_map(|(discs, of)| of.iter().zip(RESTITUTIONS).map(move |at| (discs, at)));
    // Discs across the box, projected on one side: N d/L with N = ν L²/(π d²/4).
    let across = |discs: usize| (discs as f64 * PACKING / FRAC_PI_4).sqrt();
    Ok(FinishedItem::of([
        FrameBuilder::of(ROWS.iter().zip(rows))
            .count("discs in the row", |(discs, _)| **discs)
            .number("collapses at", 4, |(_, [low, _])| *low)
            .number("does not at", 4, |(_, [_, high])| *high)
            .number("theory", 4, |(discs, _)| row_criterion(f64::from(**discs)))
            .frame("rows", "Discs in a row"),
        FrameBuilder::of((30..=160).step_by(5).map(|tenths| f64::from(tenths) / 10.0))
            .number("discs in the row", 1, |discs| *discs)
            .number("restitution", 4, |discs| row_criterion(*discs))
            .frame("theory", "Estimate for discs in a row: tan²(π/4 (1 − 2/N))"),
        FrameBuilder::of(gases())
            .count("discs", |(discs, _)| **discs)
            .number("N d/L", 1, |(discs, _)| across(**discs))
            .number("theory of a row", 3, |(discs, _)| row_criterion(across(**discs)))
            .cells(RESTITUTIONS.map(|e| format!("e = {e}")), |(_, collapsed)| {
                collapsed.iter().map(|&share| TableCell::Number(share, 2)).collect::<Vec<_>>()
            })
            .frame("plane", "Share of the seeds that collapse"),
        FrameBuilder::of(places)
            .count("discs", |(discs, _)| **discs)
            .number("restitution", 1, |(_, (_, restitution))| *restitution)
            .number("share", 2, |(_, (share, _))| **share)
            .frame("gases", "Share of the seeds that collapse, a row for each restitution"),
    ])
    .with_seeds(1..=SEEDS))
}

/// Returns true if a scene collapses before its end.
fn collapses_before(
    preset: &str,
    overrides: &Overrides,
    end: impl Fn(usize) -> Until,
) -> Result<bool, StudyError> {
    let mut gas = RunningScene::begin(preset, overrides)?;
    let end = end(gas.simulation.particles().grain_count());
    Ok(advance_or_collapse(&mut gas, end)?.is_some())
}

/// Largest restitution at which a start of an unbounded row collapses, and smallest restitution at which none does.
fn row_threshold(discs: u32) -> Result<[f64; 2], StudyError> {
    let starts: Vec<Overrides> = (0..STARTS).map(|start| converging_row(discs, start)).collect();
    let some_collapses = |restitution: f64| {
        for start in &starts {
            let overrides = start.clone().set(&RESTITUTION, restitution);
            if collapses_before("row-of-discs", &overrides, |_| Until::Time(1e3))? {
                return Ok::<_, StudyError>(true);
            }
        }
        Ok(false)
    };
    let is_narrow = |[low, high]: [f64; 2]| high - low <= RESOLUTION;
    bisect_range([0.001, 0.999], is_narrow, |low, high| 0.5 * (low + high), some_collapses)
}

/// Positions and velocities of discs in a row: gaps of about a diameter, speeds inwards that increase with distance from the centre. The
/// first start is regular and symmetric, the others are random.
fn converging_row(discs: u32, start: u32) -> Overrides {
    let mut stream = Stream::new(1, RandomPurpose::Test, start);
    let spread = if start == 0 { 0.0 } else { 0.8 };
    let mut off = || 1.0 + spread * stream.random_range(-1.0..1.0);
    let middle = 0.5 * f64::from(discs - 1);
    let (mut positions, mut velocities, mut x) = (vec![], vec![], 0.0);
    for disc in 0..discs {
        x += 1.0 + off();
        positions.push([500.0 + x, 5.0]);
        velocities.push([(middle - f64::from(disc)) / middle * off(), 0.0]);
    }
    Overrides::new().set(&POSITIONS, positions).set(&VELOCITIES, velocities)
}

/// Overrides of a gas of the map.
fn gas_overrides(discs: u64) -> Overrides {
    Overrides::new().set(&COUNT, discs).set(&PACKING_FRACTION, PACKING)
}

/// Share of the seeds with which a gas collapses.
fn collapse_share(discs: u64, restitution: f64) -> Result<f64, StudyError> {
    let mut count = 0;
    for seed in 1..=SEEDS {
        let overrides = gas_overrides(discs).set(&RESTITUTION, restitution).set(&SEED, seed);
        let end = |discs: usize| Until::Events((0.5 * COLLISIONS * discs as f64) as u64);
        count += u64::from(collapses_before("cooling-gas", &overrides, end)?);
    }
    Ok(count as f64 / SEEDS as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_row_criterion_is_exact_for_three_discs() {
        assert!((row_criterion(3.0) - (7.0 - 4.0 * 3f64.sqrt())).abs() < 1e-15);
        assert_eq!(row_criterion(2.0), 0.0);
    }

    /// Three discs in a row, compared with 7 − 4√3 = 0.0718.
    #[test]
    fn three_discs_collapse_below_the_theoretical_restitution() {
        let [low, high] = row_threshold(3).unwrap();
        assert!(low < 0.0719 && high > 0.0708, "{low} {high}");
    }
}
