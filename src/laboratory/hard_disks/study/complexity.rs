//! What a collision costs over the number of discs: in counted operations, and in processor time.

use crate::laboratory::hard_disks::study::rates::ENGINES;
use crate::laboratory::running::Running;
use crate::results::Progress;
use crate::statistics::{median, non_negative};
use crate::study::StudyError;
use serde::Serialize;
use stripmine_physics::method::hard_disks::keys::ENGINE;
use stripmine_physics::scene::{COUNT, Overrides, PACKING_FRACTION};

/// What is counted, by its name, and how tables call it.
pub const COUNTED: [(&str, &str); 5] = [
    ("predictions", "predictions of a pair"),
    ("searches", "searches for the next event of a disc"),
    ("repairs", "of these for a lost partner"),
    ("queue_moves", "moves in the queue"),
    ("cell_updates", "discs put into a cell"),
];

/// How much is measured.
#[derive(Clone, Debug)]
pub struct Effort {
    /// Numbers of discs, at least.
    pub discs: Vec<u64>,
    /// Packing fractions.
    pub packing_fractions: Vec<f64>,
    /// Rounds, in which the engines take turns.
    pub rounds: usize,
    /// Collisions of a round.
    pub collisions: u64,
    /// The source's way has no more discs than this: it takes minutes.
    pub most_by_reference: u64,
}

/// An engine with a number of discs.
#[derive(Clone, Debug, Serialize)]
pub struct Cost {
    /// Discs.
    pub discs: usize,
    /// Area of the discs over that of the box.
    pub packing_fraction: f64,
    /// The engine.
    pub engine: &'static str,
    /// Operations of a collision, as in [`COUNTED`].
    pub operations: [f64; COUNTED.len()],
    /// Processor seconds of a collision: the median of the rounds.
    pub seconds: f64,
}

/// A time that grows with the logarithm of the number of discs, fitted to an engine at a packing fraction.
#[derive(Clone, Debug, Serialize)]
pub struct Fit {
    /// The engine.
    pub engine: &'static str,
    /// Area of the discs over that of the box.
    pub packing_fraction: f64,
    /// Seconds of a collision, and seconds more for each doubling of the number of discs.
    pub seconds: [f64; 2],
    /// By how much the farthest measured time is off, as a factor.
    pub off: f64,
}

impl Fit {
    /// Seconds of a collision of so many discs.
    pub fn at(&self, discs: f64) -> f64 {
        self.seconds[0] + self.seconds[1] * discs.log2()
    }
}

/// What came out.
#[derive(Clone, Debug, Serialize)]
pub struct Complexity {
    /// Every engine, packing fraction and number of discs.
    pub costs: Vec<Cost>,
    /// The fits.
    pub fits: Vec<Fit>,
}

/// Measures.
///
/// # Errors
/// [`StudyError`] if a scene breaks.
pub fn complexity(effort: &Effort, progress: Progress<'_>) -> Result<Complexity, StudyError> {
    let mut costs = vec![];
    let work: u64 = effort.discs.iter().map(|discs| 5 * discs + effort.collisions).sum();
    let mut done = 0;
    for &discs in &effort.discs {
        for &packing_fraction in &effort.packing_fractions {
            costs.extend(engines(discs, packing_fraction, effort)?);
            done += 5 * discs + effort.collisions;
            progress(done as f64 / (work * effort.packing_fractions.len() as u64) as f64);
        }
    }
    let fits = effort.packing_fractions.iter().flat_map(|&packing_fraction| {
        let costs = &costs;
        ENGINES.map(|engine| fit(engine, packing_fraction, costs))
    });
    Ok(Complexity { fits: fits.collect(), costs })
}

fn engines(discs: u64, packing_fraction: f64, effort: &Effort) -> Result<Vec<Cost>, StudyError> {
    let mut running: Vec<(Running, Vec<f64>, [f64; COUNTED.len()])> = vec![];
    for engine in of_size(discs, effort) {
        let scene = Overrides::new().set(&COUNT, discs).set(&PACKING_FRACTION, packing_fraction);
        let mut system = Running::timed("hard-disks", &scene.set(&ENGINE, engine))?;
        // From the lattice of the start, and lists that are all as old, to discs in motion: ten collisions of each.
        system.events(5 * discs)?;
        let before = counted(&system);
        running.push((system, vec![], before));
    }
    for _ in 0..effort.rounds {
        for (system, times, _) in &mut running {
            let begun = cpu_time::ProcessTime::now();
            system.events(effort.collisions)?;
            times.push(begun.elapsed().as_secs_f64() / effort.collisions as f64);
        }
    }
    let collisions = (effort.rounds as u64 * effort.collisions) as f64;
    let cost =
        |(engine, (system, times, before)): (&'static str, (Running, Vec<f64>, [f64; COUNTED.len()]))| {
            let after = counted(&system);
            Ok(Cost {
                discs: system.simulation.particles().grain_count(),
                packing_fraction,
                engine,
                operations: std::array::from_fn(|kind| (after[kind] - before[kind]) / collisions),
                seconds: median(times.into_iter()),
            })
        };
    of_size(discs, effort).into_iter().zip(running).map(cost).collect()
}

/// The engines that are measured with a number of discs.
fn of_size(discs: u64, effort: &Effort) -> Vec<&'static str> {
    let is_measured = |engine: &&str| *engine != ENGINES[1] || discs <= effort.most_by_reference;
    ENGINES.into_iter().filter(is_measured).collect()
}

fn counted(system: &Running) -> [f64; COUNTED.len()] {
    let counts = system.simulation.event_operations();
    COUNTED.map(|(name, _)| counts.iter().find(|it| it.0 == name).map_or(0.0, |it| it.1 as f64))
}

/// Least squares of the relative errors; neither constant is below nothing.
fn fit(engine: &'static str, packing_fraction: f64, costs: &[Cost]) -> Fit {
    let own = || costs.iter().filter(|it| (it.engine, it.packing_fraction) == (engine, packing_fraction));
    // In nanoseconds, for numbers near one.
    let row = |it: &Cost| ([1.0, (it.discs as f64).log2()].map(|term| 1e-9 * term / it.seconds), 1.0);
    let seconds = non_negative(&own().map(row).collect::<Vec<_>>()).map(|constant| 1e-9 * constant);
    let fit = Fit { engine, packing_fraction, seconds, off: 1.0 };
    let off =
        own().map(|it| (fit.at(it.discs as f64) / it.seconds).max(it.seconds / fit.at(it.discs as f64)));
    Fit { off: off.fold(1.0, f64::max), ..fit }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Times made by a logarithm give it back, and one that is not on it is said to be off.
    #[test]
    fn a_logarithm_is_found_again() {
        let cost = |discs: usize, seconds: f64| Cost {
            discs,
            packing_fraction: 0.5,
            engine: ENGINES[0],
            operations: [0.0; COUNTED.len()],
            seconds,
        };
        let on = |discs: usize| cost(discs, 1e-9 * (200.0 + 30.0 * (discs as f64).log2()));
        let mut costs: Vec<Cost> = [1 << 10, 1 << 14, 1 << 20].map(on).to_vec();
        let found = fit(ENGINES[0], 0.5, &costs);
        assert!(
            (found.seconds[0] / 200e-9 - 1.0).abs() < 1e-2 && (found.seconds[1] / 30e-9 - 1.0).abs() < 1e-2
        );
        assert!(found.off < 1.01);
        costs.push(cost(1 << 22, 4e-6));
        assert!(fit(ENGINES[0], 0.5, &costs).off > 1.5);
    }
}
