//! Cooling of a granular gas: Haff's law while the gas is homogeneous, and inelastic collapse at strong dissipation.

use super::advance_or_collapse;
use crate::console::CommandFailure;
use crate::frame::FrameBuilder;
use crate::laboratory::running::RunningScene;
use crate::results::{FinishedItem, ProgressMeter, StudyEnvironment, StudySize};
use crate::study::{StudyError, first_line};
use stripmine_physics::method::hard_disks::keys::{CONTACT_DURATION, RESTITUTION};
use stripmine_physics::method::observed::summary_number;
use stripmine_physics::method::{self, Until};
use stripmine_physics::scene::{COUNT, Overrides};

/// Minimum number of discs.
const DISCS: u64 = 10_000;
/// Restitutions of the cooling gases.
const RESTITUTIONS: [f64; 3] = [0.99, 0.95, 0.90];
/// Samples of a gas, half a collision per disc apart.
const LOOKS: usize = 24;
/// Restitutions tested for collapse.
const COLLAPSING: [f64; 4] = [0.9, 0.5, 0.3, 0.1];
/// Contact duration that prevents collapse (time).
const CURE: f64 = 1e-4;

/// Cooling gas.
struct CoolingGas {
    restitution: f64,
    /// Collisions per disc, time, and temperature over that of the first sample, for each sample.
    looks: Vec<[f64; 3]>,
    /// Haff's time t₀ = 4/((1 − e²) ω₀), with the rate ω₀ of an elastic gas at the temperature of the first sample.
    haff_time: f64,
    /// T₀ exp(−(1 − e²) collisions/N) at the last sample.
    by_collisions: f64,
}

impl CoolingGas {
    /// Temperature by Haff's law, over that of the first sample.
    fn haff(&self, time: f64) -> f64 {
        (1.0 + time / self.haff_time).powi(-2)
    }

    fn last(&self) -> [f64; 3] {
        self.looks[self.looks.len() - 1]
    }
}

/// Simulates the cooling gases and the gases that may collapse.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let meter = ProgressMeter::new((RESTITUTIONS.len() + COLLAPSING.len()) as f64, lab.progress);
    let gases = meter.run_cases(&RESTITUTIONS, measure_cooling)?;
    let fates = meter.run_cases(&COLLAPSING, find_collapse)?;
    let looks = gases.iter().flat_map(|gas| gas.looks.iter().enumerate().skip(1).map(move |it| (gas, it)));
    let off = |temperature: f64, law: f64| 100.0 * (temperature / law - 1.0);
    Ok(FinishedItem::of([
        FrameBuilder::of(&gases)
            .number("restitution", 2, |gas| gas.restitution)
            .number("collisions of a disc", 1, |gas| gas.last()[0])
            .number("t₀", 3, |gas| gas.haff_time)
            .number("T/T₀ at the end", 4, |gas| gas.last()[2])
            .number("off Haff by time (%)", 2, |gas| off(gas.last()[2], gas.haff(gas.last()[1])))
            .number("off Haff by collisions (%)", 2, |gas| off(gas.last()[2], gas.by_collisions))
            .frame("gases", "Temperatures beside Haff's law"),
        FrameBuilder::of(COLLAPSING.iter().zip(&fates))
            .number("restitution", 2, |(restitution, _)| **restitution)
            .number("collisions of a disc", 1, |(_, (collisions, _))| *collisions)
            .text("what was found", |(_, (_, collapse))| {
                collapse.as_ref().map_or("no collapse", |(words, _)| words.as_str())
            })
            .number("made elastic by the contact duration (%)", 3, |(_, (_, collapse))| {
                collapse.as_ref().map(|(_, made_elastic)| 100.0 * made_elastic)
            })
            .frame("collapse", "Fate of very dissipative gases in 200 collisions of a disc"),
        FrameBuilder::of(looks)
            .number("restitution", 2, |(gas, _)| gas.restitution)
            .count("look", |(_, (at, _))| *at)
            .number("time", 3, |(_, (_, look))| look[1])
            .number("temperature over that of the first look", 4, |(_, (_, look))| look[2])
            .number("Haff", 4, |(gas, (_, look))| gas.haff(look[1]))
            .frame("looks", "Temperatures over time, in units of those at the first look"),
    ])
    .with_seeds([1]))
}

fn measure_cooling(&restitution: &f64) -> Result<CoolingGas, StudyError> {
    let scene = Overrides::new().set(&COUNT, DISCS);
    let begin =
        |restitution: f64| RunningScene::begin("cooling-gas", &scene.clone().set(&RESTITUTION, restitution));
    let names = ["time", "collisions", "temperature"];
    // The collision rate of an elastic gas, after it has forgotten the initial lattice.
    let mut elastic = begin(1.0)?;
    let count = elastic.simulation.particles().grain_count() as f64;
    elastic.advance_events((10.0 * count) as u64)?;
    let [time, collisions, ..] = elastic.observed_values(names)?;
    elastic.advance_events((20.0 * count) as u64)?;
    let after = elastic.observed_values(names)?;
    let elastic_rate = 2.0 * (after[1] - collisions) / (count * (after[0] - time)) / after[2].sqrt();
    let mut gas = begin(restitution)?;
    // One collision per disc destroys the lattice.
    gas.advance_events(count as u64)?;
    let first = gas.observed_values(names)?;
    let haff_time = 4.0 / ((1.0 - restitution * restitution) * elastic_rate * first[2].sqrt());
    let mut looks = vec![first];
    for _ in 0..LOOKS {
        gas.advance_events((0.25 * count) as u64)?;
        looks.push(gas.observed_values(names)?);
    }
    let relative =
        |look: [f64; 3]| [2.0 * (look[1] - first[1]) / count, look[0] - first[0], look[2] / first[2]];
    let last = looks[LOOKS];
    Ok(CoolingGas {
        restitution,
        looks: looks.into_iter().map(relative).collect(),
        haff_time,
        by_collisions: (-(1.0 - restitution * restitution) * (last[1] - first[1]) / count).exp(),
    })
}

/// Collisions per disc: 200, or fewer if the gas collapses. For a collapse also its message, and the share of collisions that the contact
/// duration makes elastic in a run of the same length.
fn find_collapse(&restitution: &f64) -> Result<(f64, Option<(String, f64)>), StudyError> {
    let scene = Overrides::new().set(&COUNT, DISCS).set(&RESTITUTION, restitution);
    let begin = |contact_duration: f64| {
        RunningScene::begin("cooling-gas", &scene.clone().set(&CONTACT_DURATION, contact_duration))
    };
    let mut gas = begin(0.0)?;
    let count = gas.simulation.particles().grain_count() as f64;
    let events = (100.0 * count) as u64;
    let collapse = advance_or_collapse(&mut gas, Until::Events(events))?;
    let [collisions] = gas.observed_values(["collisions"])?;
    let cured = |failure: method::PhysicsFailure| {
        let mut cured = begin(CURE)?;
        cured.advance_events(events)?;
        let summary = cured.simulation.summary();
        let share = summary_number(&summary, "made_elastic")? / summary_number(&summary, "collisions")?;
        Ok::<_, StudyError>((first_line(&failure.what_and_when()), share))
    };
    Ok((2.0 * collisions / count, collapse.map(cured).transpose()?))
}
