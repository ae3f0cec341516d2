//! Discs under gravity above a hot floor, without a ceiling: their density over the height, beside the barometric law.

use crate::laboratory::running::Running;
use crate::results::{Meter, Progress};
use crate::statistics::Mean;
use crate::study::StudyError;
use serde::Serialize;
use stripmine_physics::method::Until;
use stripmine_physics::method::hard_disks::keys::{ENGINE, RESTITUTION, TIME};
use stripmine_physics::method::hard_disks::options::EngineChoice;
use stripmine_physics::method::observed::summed_up;
use stripmine_physics::scene::{COUNT, GRAVITY, Overrides, SIDES};

/// Bins of the profile, each of this part of the height kT/(m g).
const BIN: f64 = 0.25;
/// Heights kT/(m g) that the profile spans.
const SPAN: f64 = 8.0;

/// A profile.
#[derive(Clone, Debug, Serialize)]
pub struct Profile {
    /// Discs times their diameter, over the width of the box: layers that they would fill.
    pub layers: f64,
    /// Discs.
    pub discs: usize,
    /// Heights of the middle of the bins above the lowest that a centre may have, in kT/(m g).
    pub heights: Vec<f64>,
    /// Discs of a unit of area, over what the barometric law has on the floor.
    pub densities: Vec<Mean>,
    /// The mean height of the centres over kT/(m g): 1 by the barometric law.
    pub mean_height: Mean,
    /// The temperature over that of the floor, for elastic discs 1.
    pub temperature: Mean,
    /// The highest that a disc was seen, in kT/(m g).
    pub highest: f64,
}

/// What came out.
#[derive(Clone, Debug, Serialize)]
pub struct Atmosphere {
    /// Profiles, from dilute to dense.
    pub profiles: Vec<Profile>,
    /// Looks at each.
    pub looks: usize,
    /// A gas of inelastic discs, where the floor's heat is lost on the way up.
    pub granular: Profile,
    /// Its restitution.
    pub restitution: f64,
    /// The cells of the source's look-up after a while.
    pub look_ups: Vec<LookUp>,
}

/// What the source's look-up of occupied cells takes.
#[derive(Clone, Debug, Serialize)]
pub struct LookUp {
    /// The preset.
    pub scene: &'static str,
    /// Discs, which are the entries of A, BX and BY.
    pub discs: usize,
    /// Entries of C and D.
    pub entries: f64,
    /// Events so far.
    pub events: u64,
    /// Whether every disc is where it is by the fast engine, to the bit.
    pub agrees: bool,
}

/// Follows discs over `looks` looks, a time √(kT/m)/g apart.
///
/// # Errors
/// [`StudyError`] if a scene breaks.
pub fn atmosphere(looks: usize, progress: Progress<'_>) -> Result<Atmosphere, StudyError> {
    let restitution = 0.95;
    let gases = [(0.02, 1.0), (0.2, 1.0), (1.0, 1.0), (1.0, restitution)];
    let scenes = ["hot-floor", "vibrating-floor"];
    let meter = Meter::new((gases.len() + scenes.len()) as f64, progress);
    let mut profiles = meter.each(&gases, |&(layers, restitution)| profile(layers, restitution, looks))?;
    let granular = profiles.split_off(gases.len() - 1).remove(0);
    let look_ups = meter.each(&scenes, |&scene| look_up(scene))?;
    Ok(Atmosphere { profiles, looks, granular, restitution, look_ups })
}

/// A scene by the source's engine, and beside it by the fast one.
fn look_up(scene: &'static str) -> Result<LookUp, StudyError> {
    let run = |engine: EngineChoice| {
        let mut gas = Running::begin(scene, &Overrides::new().set(&ENGINE, engine))?;
        gas.until(Until::Time(100.0))?;
        Ok::<_, StudyError>(gas)
    };
    let [source, fast] = [run(EngineChoice::Reference)?, run(EngineChoice::Fast)?];
    Ok(LookUp {
        scene,
        discs: source.simulation.particles().len(),
        entries: summed_up(&source.simulation.summary(), "blocks")?,
        events: source.simulation.clock().events,
        agrees: source.simulation.particles().all() == fast.simulation.particles().all(),
    })
}

/// Discs of diameter, mass and kT 1, and kT/(m g) of 20.
fn profile(layers: f64, restitution: f64, looks: usize) -> Result<Profile, StudyError> {
    let (height, discs) = (20.0, 200_usize);
    let width = discs as f64 / layers;
    let place = Overrides::new().set(&SIDES, [width, 120.0]).set(&GRAVITY, [0.0, -1.0 / height]);
    let overrides = place.set(&COUNT, discs).set(&RESTITUTION, restitution).set(&TIME, 1e9);
    let mut gas = Running::begin("hot-floor", &overrides)?;
    // A disc falls through the height in a time of about √2 √(kT/m)/g.
    let between = height;
    let mut now = 40.0 * between;
    gas.until(Until::Time(now))?;
    let bins = (SPAN / BIN) as usize;
    let mut densities = vec![vec![]; bins];
    let (mut heights, mut temperatures, mut highest) = (vec![], vec![], 0.0_f64);
    for _ in 0..looks {
        now += between;
        gas.until(Until::Time(now))?;
        let mut counts = vec![0.0; bins];
        let mut height_now = 0.0;
        for disc in gas.simulation.particles().grains() {
            let above = (disc.position[1] - disc.radius) / height;
            height_now += above / discs as f64;
            highest = highest.max(above);
            if let Some(count) = counts.get_mut((above / BIN) as usize) {
                *count += 1.0;
            }
        }
        heights.push(height_now);
        temperatures.push(gas.observed(["kinetic"])?[0] / discs as f64);
        // The barometric law has N/h of them on a unit of height at the floor.
        let now = counts.into_iter().map(|count| count / (discs as f64 * BIN));
        densities.iter_mut().zip(now).for_each(|(course, now)| course.push(now));
    }
    Ok(Profile {
        layers,
        discs,
        heights: (0..bins).map(|bin| (bin as f64 + 0.5) * BIN).collect(),
        densities: densities.iter().map(|course| Mean::of_course(course)).collect(),
        mean_height: Mean::of_course(&heights),
        temperature: Mean::of_course(&temperatures),
        highest,
    })
}
