//! The source's comparison: what a collision costs, over the mask and the packing fraction; and its cost formula, fitted.

use crate::laboratory::running::{Running, prepared};
use crate::results::Progress;
use crate::statistics::{median, non_negative};
use crate::study::StudyError;
use serde::Serialize;
use stripmine_physics::method::hard_disks::keys::{ENGINE, MASK, MASKS};
use stripmine_physics::method::hard_disks::options::EngineChoice;
use stripmine_physics::method::observed::summed_up;
use stripmine_physics::scene::{COUNT, Overrides, PACKING_FRACTION};

/// Constants of the source's formula.
pub const TERMS: [&str; 4] = [
    "a collision",
    "a disc in the mask, for each collision",
    "a disc, for each filling",
    "a disc in the mask of a disc, for each filling",
];

/// A mask at a packing fraction.
#[derive(Clone, Debug, Serialize)]
pub struct Cost {
    /// The mask.
    pub mask: &'static str,
    /// Its places.
    pub places: usize,
    /// Discs in the mask, on average.
    pub candidates: f64,
    /// Area of the discs over that of the box.
    pub packing_fraction: f64,
    /// Processor seconds of a collision.
    pub seconds: f64,
    /// Fillings of the grid for each collision of the system.
    pub fillings: f64,
    /// What the fitted formula says (s).
    pub fitted: f64,
}

/// What came out.
#[derive(Clone, Debug, Serialize)]
pub struct Masks {
    /// Discs.
    pub discs: usize,
    /// Every mask at every packing fraction.
    pub costs: Vec<Cost>,
    /// The constants of the formula (s), as in [`TERMS`].
    pub constants: [f64; 4],
    /// The root of the mean square of the relative errors of the formula.
    pub error: f64,
    /// At each packing fraction: the cheapest mask, and what `auto` takes.
    pub best: Vec<(f64, &'static str, String)>,
}

/// Measures `rounds` times `collisions` collisions of every mask, in turns.
///
/// # Errors
/// [`StudyError`] if a scene breaks.
pub fn masks(
    discs: u64,
    packing_fractions: &[f64],
    (rounds, collisions): (usize, u64),
    progress: Progress<'_>,
) -> Result<Masks, StudyError> {
    let masks = &MASKS[1..];
    let (mut costs, mut best, mut count) = (vec![], vec![], 0);
    for (at, &packing_fraction) in packing_fractions.iter().enumerate() {
        let overrides = |mask: &str| {
            let scene = Overrides::new().set(&COUNT, discs).set(&PACKING_FRACTION, packing_fraction);
            scene.set(&ENGINE, EngineChoice::Reference).set(&MASK, mask)
        };
        let mut running: Vec<(Running, Vec<f64>)> = vec![];
        for mask in masks {
            let mut system = Running::begin("hard-disks", &overrides(mask))?;
            system.events(10 * discs)?;
            running.push((system, vec![]));
        }
        let remaps = |system: &Running| summed_up(&system.simulation.summary(), "remaps");
        let before: Vec<f64> = running.iter().map(|(system, _)| remaps(system)).collect::<Result<_, _>>()?;
        for round in 0..rounds {
            for (system, times) in &mut running {
                let begun = cpu_time::ProcessTime::now();
                system.events(collisions)?;
                times.push(begun.elapsed().as_secs_f64() / collisions as f64);
            }
            let done = at as f64 + (round + 1) as f64 / rounds as f64;
            progress(done / packing_fractions.len() as f64);
        }
        let auto = prepared("hard-disks", &overrides("auto"))?.settings;
        let mut here: Vec<Cost> = vec![];
        for ((mask, (system, times)), before) in masks.iter().zip(&running).zip(before) {
            count = system.simulation.particles().grain_count();
            let places = stripmine_physics::method::hard_disks::reference::choice::mask(mask);
            let places = places.map_or(0, |mask| mask.offsets().len());
            let occupancy = summed_up(&system.simulation.summary(), "occupancy")?;
            here.push(Cost {
                mask,
                places,
                candidates: places as f64 * occupancy,
                packing_fraction,
                seconds: median(times.iter().copied()),
                fillings: (remaps(system)? - before) / (rounds as u64 * collisions) as f64,
                fitted: 0.0,
            });
        }
        let cheapest = here.iter().min_by(|a, b| a.seconds.total_cmp(&b.seconds));
        best.push((
            packing_fraction,
            cheapest.map_or("", |cost| cost.mask),
            auto["mask"].as_str().unwrap_or("").to_owned(),
        ));
        costs.extend(here);
    }
    let constants = fit(&costs, count);
    for cost in &mut costs {
        cost.fitted = terms(cost, count).iter().zip(constants).map(|(term, constant)| term * constant).sum();
    }
    let squares: f64 = costs.iter().map(|cost| (cost.fitted / cost.seconds - 1.0).powi(2)).sum();
    let error = (squares / costs.len() as f64).sqrt();
    Ok(Masks { discs: count, costs, constants, error, best })
}

/// What the constants multiply.
fn terms(cost: &Cost, discs: usize) -> [f64; 4] {
    let filled = discs as f64 * cost.fillings;
    [1.0, cost.candidates, filled, cost.candidates * filled]
}

/// Least squares of the relative errors; no constant is below nothing.
fn fit(costs: &[Cost], discs: usize) -> [f64; 4] {
    let row = |cost: &Cost| (terms(cost, discs).map(|term| SCALE * term / cost.seconds), 1.0);
    let rows: Vec<_> = costs.iter().map(row).collect();
    non_negative(&rows).map(|constant| SCALE * constant)
}

/// Constants are a nanosecond or so.
const SCALE: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use super::*;

    /// Costs made by the formula give its constants back.
    #[test]
    fn the_formula_is_found_again() {
        let constants = [1e-7, 2e-9, 3e-8, 3e-9];
        let mut costs = vec![];
        for (candidates, fillings) in
            [(8.0, 0.01), (13.0, 0.004), (30.0, 0.001), (90.0, 0.0003), (5.0, 0.1), (70.0, 0.02)]
        {
            let mut cost = Cost {
                mask: "",
                places: 0,
                candidates,
                packing_fraction: 0.5,
                seconds: 0.0,
                fillings,
                fitted: 0.0,
            };
            cost.seconds =
                terms(&cost, 100).iter().zip(constants).map(|(term, constant)| term * constant).sum();
            costs.push(cost);
        }
        for (found, constant) in fit(&costs, 100).into_iter().zip(constants) {
            assert!((found / constant - 1.0).abs() < 1e-2, "{found} {constant}");
        }
    }
}
