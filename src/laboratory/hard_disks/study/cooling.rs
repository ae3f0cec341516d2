//! A granular gas cools: Haff's law while it is even, and inelastic collapse where it is too dissipative.

use crate::laboratory::running::{Running, prepared};
use crate::results::{Meter, Progress};
use crate::study::{StudyError, first_line};
use serde::Serialize;
use stripmine_physics::method::Until;
use stripmine_physics::method::hard_disks::keys::{CONTACT_DURATION, RESTITUTION};
use stripmine_physics::method::observed::summed_up;
use stripmine_physics::scene::{COUNT, Overrides};

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
/// [`StudyError`] if a scene breaks otherwise than by collapse.
pub fn cooling(discs: u64, each: f64, progress: Progress<'_>) -> Result<Cooling, StudyError> {
    let meter = Meter::new((RESTITUTIONS.len() + COLLAPSING.len()) as f64, progress);
    let gases = meter.each(&RESTITUTIONS, |&restitution| gas(discs, restitution, each))?;
    let contact_duration = 1e-4;
    let fates = meter.each(&COLLAPSING, |&restitution| fate(discs, restitution, contact_duration))?;
    let scene = prepared("cooling-gas", &Overrides::new().set(&COUNT, discs))?;
    Ok(Cooling { discs: scene.particles().grain_count(), gases, fates, contact_duration })
}

fn gas(discs: u64, restitution: f64, each: f64) -> Result<Gas, StudyError> {
    let scene = Overrides::new().set(&COUNT, discs);
    let begin =
        |restitution: f64| Running::begin("cooling-gas", &scene.clone().set(&RESTITUTION, restitution));
    let names = ["time", "collisions", "temperature"];
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
fn fate(discs: u64, restitution: f64, contact_duration: f64) -> Result<Fate, StudyError> {
    let scene = Overrides::new().set(&COUNT, discs).set(&RESTITUTION, restitution);
    let begin = |contact_duration: f64| {
        Running::begin("cooling-gas", &scene.clone().set(&CONTACT_DURATION, contact_duration))
    };
    let mut gas = begin(0.0)?;
    let count = gas.simulation.particles().grain_count() as f64;
    let events = (100.0 * count) as u64;
    let collapse = match gas.until(Until::Events(events)) {
        Ok(()) => None,
        Err(failure) if failure.kind == stripmine_physics::method::hard_disks::INELASTIC_COLLAPSE => {
            Some(first_line(&failure.what()))
        }
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
