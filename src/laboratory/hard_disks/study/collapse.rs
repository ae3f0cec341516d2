//! Where the method fails: inelastic collapse over restitution and number of discs, in a row and in the plane.

use crate::laboratory::running::{Running, prepared};
use crate::results::{Meter, Progress};
use crate::study::StudyError;
use rand::RngExt;
use serde::Serialize;
use std::f64::consts::FRAC_PI_4;
use stripmine_kernels::noise::{Purpose, Stream};
use stripmine_physics::method::Until;
use stripmine_physics::method::hard_disks::keys::RESTITUTION;
use stripmine_physics::scene::{COUNT, Overrides, PACKING_FRACTION, POSITIONS, SEED, VELOCITIES};

/// Discs of the rows.
const ROWS: [u32; 7] = [3, 4, 5, 6, 8, 12, 16];
/// Starts of a row; the largest restitution at which one of them collapses counts.
const STARTS: u32 = 24;
/// How far apart the two ends of what is found are.
const RESOLUTION: f64 = 2e-4;
/// Restitutions and numbers of discs of the map.
const RESTITUTIONS: [f64; 9] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];
const DISCS: [u64; 6] = [16, 64, 256, 1024, 4096, 16_384];
/// Seeds of a place of the map.
const SEEDS: u64 = 3;
/// Collisions of a disc in the runs of the map.
const COLLISIONS: f64 = 200.0;
/// Packing fraction of the gases of the map.
pub const PACKING: f64 = 0.25;

/// Discs in a row that fly towards each other, without sides.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Discs.
    pub discs: u32,
    /// The largest restitution at which a start collapses and the smallest found at which none does.
    pub edge: [f64; 2],
    /// That of theory.
    pub theory: f64,
}

/// Gases of a number of discs.
#[derive(Clone, Debug, Serialize)]
pub struct Gases {
    /// Discs.
    pub discs: usize,
    /// Those that lie across the box, whatever their place along it: N d/L.
    pub across: f64,
    /// The share of the seeds that collapse, by restitution.
    pub collapsed: Vec<f64>,
    /// The restitution below which a row of as many discs as lie across collapses.
    pub theory: f64,
}

/// What came out.
#[derive(Clone, Debug, Serialize)]
pub struct Collapses {
    /// Rows.
    pub rows: Vec<Row>,
    /// Restitutions of the gases.
    pub restitutions: Vec<f64>,
    /// Gases.
    pub gases: Vec<Gases>,
    /// Seeds of each.
    pub seeds: u64,
    /// Collisions of a disc after which a gas counts as one that does not collapse.
    pub collisions: f64,
}

/// The restitution below which discs in a row can collapse: tan²(π/4 (1 − 2/N)), exact for three (7 − 4√3) and an estimate for more,
/// of which each half is taken for a column that meets a wall, after Bernu and Mazighi (1990).
pub fn of_a_row(discs: f64) -> f64 {
    if discs > 2.0 { (FRAC_PI_4 * (1.0 - 2.0 / discs)).tan().powi(2) } else { 0.0 }
}

/// Surveys rows and gases.
///
/// # Errors
/// [`StudyError`] if a scene breaks otherwise than by collapse.
pub fn collapses(progress: Progress<'_>) -> Result<Collapses, StudyError> {
    let places = DISCS.iter().flat_map(|&discs| RESTITUTIONS.map(|restitution| (discs, restitution)));
    let places: Vec<(u64, f64)> = places.collect();
    let meter = Meter::new((ROWS.len() + places.len()) as f64, progress);
    let rows = meter.each(&ROWS, |&discs| row(discs))?;
    let shares = meter.each_from_last(&places, |&(discs, restitution)| share(discs, restitution))?;
    let shares = shares.chunks(RESTITUTIONS.len());
    let gases = DISCS.iter().zip(shares).map(|(&discs, collapsed)| gases(discs, collapsed.to_vec()));
    let gases = gases.collect::<Result<_, StudyError>>()?;
    Ok(Collapses { rows, restitutions: RESTITUTIONS.to_vec(), gases, seeds: SEEDS, collisions: COLLISIONS })
}

/// Whether a scene collapses before its end.
fn collapses_before(
    preset: &str,
    overrides: &Overrides,
    end: impl Fn(usize) -> Until,
) -> Result<bool, StudyError> {
    let mut gas = Running::begin(preset, overrides)?;
    let end = end(gas.simulation.particles().grain_count());
    match gas.until(end) {
        Ok(()) => Ok(false),
        Err(failure) if failure.kind == stripmine_physics::method::hard_disks::INELASTIC_COLLAPSE => Ok(true),
        Err(failure) => Err(failure.into()),
    }
}

fn row(discs: u32) -> Result<Row, StudyError> {
    let starts: Vec<Overrides> = (0..STARTS).map(|start| flying_together(discs, start)).collect();
    let some_collapses = |restitution: f64| {
        for start in &starts {
            let overrides = start.clone().set(&RESTITUTION, restitution);
            if collapses_before("row-of-discs", &overrides, |_| Until::Time(1e3))? {
                return Ok::<_, StudyError>(true);
            }
        }
        Ok(false)
    };
    let [mut low, mut high] = [0.001, 0.999];
    while high - low > RESOLUTION {
        let middle = 0.5 * (low + high);
        if some_collapses(middle)? {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(Row { discs, edge: [low, high], theory: of_a_row(f64::from(discs)) })
}

/// Places and velocities of discs in a row: gaps of about a diameter, the faster inwards the farther out. The first start is
/// regular and symmetric, others are drawn.
fn flying_together(discs: u32, start: u32) -> Overrides {
    let mut stream = Stream::new(1, Purpose::Test, start);
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

/// A gas of the map.
fn gas(discs: u64) -> Overrides {
    Overrides::new().set(&COUNT, discs).set(&PACKING_FRACTION, PACKING)
}

/// The share of the seeds with which gases collapse.
fn share(discs: u64, restitution: f64) -> Result<f64, StudyError> {
    let mut count = 0;
    for seed in 1..=SEEDS {
        let overrides = gas(discs).set(&RESTITUTION, restitution).set(&SEED, seed);
        let end = |discs: usize| Until::Events((0.5 * COLLISIONS * discs as f64) as u64);
        count += u64::from(collapses_before("cooling-gas", &overrides, end)?);
    }
    Ok(count as f64 / SEEDS as f64)
}

fn gases(discs: u64, collapsed: Vec<f64>) -> Result<Gases, StudyError> {
    let discs = prepared("cooling-gas", &gas(discs))?.particles().grain_count();
    // N d/L with N = ν L²/(π d²/4).
    let across = (discs as f64 * PACKING / FRAC_PI_4).sqrt();
    Ok(Gases { discs, across, collapsed, theory: of_a_row(across) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_criterion_of_a_row_is_that_of_three() {
        assert!((of_a_row(3.0) - (7.0 - 4.0 * 3f64.sqrt())).abs() < 1e-15);
        assert_eq!(of_a_row(2.0), 0.0);
    }

    /// Three discs in a row, held against 7 − 4√3 = 0.0718.
    #[test]
    fn three_in_a_row_collapse_below_the_restitution_of_theory() {
        let [low, high] = row(3).unwrap().edge;
        assert!(low < 0.0719 && high > 0.0708, "{low} {high}");
    }
}
