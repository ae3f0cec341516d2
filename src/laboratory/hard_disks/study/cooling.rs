//! A granular gas cools: Haff's law while it is even, and inelastic collapse where it is too dissipative.

use crate::console::Failure;
use crate::laboratory::running::Running;
use crate::results::Progress;
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use serde::Serialize;
use std::sync::atomic::{AtomicUsize, Ordering};
use stripmine_physics::method::FailureKind;
use stripmine_physics::method::observed::summed_up;

/// Restitutions of the gases that are followed.
const RESTITUTIONS: [f64; 3] = [0.99, 0.95, 0.90];
/// Collisions of a disc between looks.
const BETWEEN: f64 = 0.5;
/// Restitutions of which it is asked whether the gas collapses.
const COLLAPSING: [f64; 4] = [0.9, 0.5, 0.3, 0.1];

/// A gas that cools.
#[derive(Clone, Debug, Serialize)]
pub struct Gas {
    /// Restitution.
    pub restitution: f64,
    /// Collisions of a disc at the looks, from the first on.
    pub collisions: Vec<f64>,
    /// Time since then.
    pub times: Vec<f64>,
    /// Temperature over that then.
    pub temperatures: Vec<f64>,
    /// Haff's time t₀ = 4/((1 − e²) ω₀), with the rate ω₀ of an elastic gas of the temperature of the first look.
    pub haff_time: f64,
    /// By how much the temperature is off Haff's law at the last look, relative to it: by the time, and by the count of collisions.
    pub off: [f64; 2],
}

/// What becomes of a very dissipative gas.
#[derive(Clone, Debug, Serialize)]
pub struct Fate {
    /// Restitution.
    pub restitution: f64,
    /// Collisions of a disc when it ended.
    pub collisions: f64,
    /// What was found, if it collapsed.
    pub collapse: Option<String>,
    /// With a contact duration: the share of the collisions that were made elastic in a run of the same length.
    pub made_elastic: Option<f64>,
}

/// What came out.
#[derive(Clone, Debug, Serialize)]
pub struct Cooling {
    /// Discs.
    pub discs: usize,
    /// Gases that are even.
    pub gases: Vec<Gas>,
    /// Very dissipative ones.
    pub fates: Vec<Fate>,
    /// The contact duration of the cure (time).
    pub contact_duration: f64,
}

/// Haff's law: the temperature over that at the start.
pub fn haff(time: f64, haff_time: f64) -> f64 {
    (1.0 + time / haff_time).powi(-2)
}

/// Follows gases over `each` collisions of a disc.
///
/// # Errors
/// [`Failure`] if a scene breaks otherwise than by collapse.
pub fn cooling(discs: u64, each: f64, progress: Progress<'_>) -> Result<Cooling, Failure> {
    let parts = (RESTITUTIONS.len() + COLLAPSING.len()) as f64;
    let done = AtomicUsize::new(0);
    let tick = || progress((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / parts);
    let gases = RESTITUTIONS.par_iter().map(|&restitution| gas(discs, restitution, each).inspect(|_| tick()));
    let gases = gases.collect::<Result<Vec<_>, Failure>>()?;
    let contact_duration = 1e-4;
    let fates = COLLAPSING.par_iter().map(|&it| fate(discs, it, contact_duration).inspect(|_| tick()));
    let fates = fates.collect::<Result<Vec<_>, Failure>>()?;
    let discs = Running::begin("cooling-gas", &[format!("particles.count={discs}")])?;
    Ok(Cooling { discs: discs.simulation.particles().grain_count(), gases, fates, contact_duration })
}

fn gas(discs: u64, restitution: f64, each: f64) -> Result<Gas, Failure> {
    let begin = |restitution: f64| {
        Running::begin(
            "cooling-gas",
            &[format!("particles.count={discs}"), format!("law.restitution={restitution}")],
        )
    };
    let names = ["time", "collisions", "temperature", "collision_rate"];
    // An elastic gas forgets the lattice of the start, and shows its rate.
    let mut elastic = begin(1.0)?;
    let count = elastic.simulation.particles().grain_count() as f64;
    elastic.events((10.0 * count) as u64)?;
    let [time, collisions, ..] = elastic.observed(names)?;
    elastic.events((20.0 * count) as u64)?;
    let after = elastic.observed(names)?;
    let elastic_rate = 2.0 * (after[1] - collisions) / (count * (after[0] - time)) / after[2].sqrt();
    let mut gas = begin(restitution)?;
    // A collision of each disc, and the lattice is no more.
    gas.events(count as u64)?;
    let first = gas.observed(names)?;
    let haff_time = 4.0 / ((1.0 - restitution * restitution) * elastic_rate * first[2].sqrt());
    let mut looks = vec![first];
    for _ in 0..(each / BETWEEN) as usize {
        gas.events((BETWEEN * 0.5 * count) as u64)?;
        looks.push(gas.observed(names)?);
    }
    let last = looks[looks.len() - 1];
    let temperature = last[2] / first[2];
    let by_count = (-(1.0 - restitution * restitution) * (last[1] - first[1]) / count).exp();
    Ok(Gas {
        restitution,
        collisions: looks.iter().map(|look| 2.0 * (look[1] - first[1]) / count).collect(),
        times: looks.iter().map(|look| look[0] - first[0]).collect(),
        temperatures: looks.iter().map(|look| look[2] / first[2]).collect(),
        haff_time,
        off: [temperature / haff(last[0] - first[0], haff_time) - 1.0, temperature / by_count - 1.0],
    })
}

/// Up to 200 collisions of a disc, or to the collapse.
fn fate(discs: u64, restitution: f64, contact_duration: f64) -> Result<Fate, Failure> {
    let begin = |contact_duration: f64| {
        Running::begin(
            "cooling-gas",
            &[
                format!("particles.count={discs}"),
                format!("law.restitution={restitution}"),
                format!("law.contact_duration={contact_duration}"),
            ],
        )
    };
    let mut gas = begin(0.0)?;
    let count = gas.simulation.particles().grain_count() as f64;
    let events = (100.0 * count) as u64;
    let ended = gas.simulation.advance(
        &[stripmine_physics::method::Until::Events(events)],
        &std::sync::atomic::AtomicBool::new(false),
    );
    let collapse = match ended {
        Ok(()) => None,
        Err(failure) if failure.kind == FailureKind::InelasticCollapse => Some(failure.what()),
        Err(failure) => return Err(failure.into()),
    };
    let [collisions] = gas.observed(["collisions"])?;
    let made_elastic = match collapse {
        None => None,
        Some(_) => {
            let mut cured = begin(contact_duration)?;
            cured.events(events)?;
            let summary = cured.simulation.summary();
            Some(summed_up(&summary, "made_elastic")? / summed_up(&summary, "collisions")?)
        }
    };
    Ok(Fate { restitution, collisions: 2.0 * collisions / count, collapse, made_elastic })
}
