//! Soft against hard: one scene by lattice MD with stiffer and stiffer discs, and by hard ones.

use super::fluid::luding;
use crate::laboratory::running::Running;
use crate::results::{Meter, Progress};
use crate::statistics::{Mean, median};
use crate::study::StudyError;
use serde::Serialize;
use stripmine_kernels::law::spring::{Impact, Spring};
use stripmine_physics::method::lattice_md::keys::{FRICTION, NORMAL_DAMPING, SHEAR_DAMPING, STIFFNESS};
use stripmine_physics::method::{Until, hard_disks};
use stripmine_physics::scene::{COUNT, DT, Overrides, PACKING_FRACTION, SEED, STEPS, TEMPERATURE};

/// The scene, and how much is measured. Diameter, mass and kT are 1.
#[derive(Clone, Debug, Serialize)]
pub struct Question {
    /// Discs, at least.
    pub discs: u64,
    /// Area of the discs over that of the box.
    pub packing_fraction: f64,
    /// Restitution of the gas that cools.
    pub restitution: f64,
    /// Stiffnesses k_N of the soft discs (kT/diameter^2.5).
    pub stiffnesses: Vec<f64>,
    /// Seeds, each an independent start.
    pub seeds: u64,
    /// Time over which the pressure is measured.
    pub time: f64,
}

/// Steps of a typical contact.
const STEPS_A_CONTACT: f64 = 40.0;
/// Looks at the pressure of soft discs.
const LOOKS: u64 = 400;
/// Collisions of each disc in which the gas cools, about.
const COOLING: f64 = 10.0;
/// Γ(7/5), of Hertz discs' effective diameter.
const GAMMA: f64 = 0.887_263_817_503_075;

/// What one way to model the scene gives.
#[derive(Clone, Debug, Serialize)]
pub struct Model {
    /// Stiffness; none for hard discs.
    pub stiffness: Option<f64>,
    /// Normal damping γ_N that gives the restitution at the scene's speeds (1/time).
    pub damping: Option<f64>,
    /// Step (time).
    pub step: Option<f64>,
    /// How deep a head-on contact of kT goes (diameters).
    pub depth: f64,
    /// Compressibility of the elastic fluid.
    pub compressibility: Mean,
    /// What it would be for hard discs of the effective diameter.
    pub effective: f64,
    /// Temperature of the cooled gas over that at its start.
    pub cooled: Mean,
    /// Processor seconds for a unit of time of the elastic fluid.
    pub cost: f64,
}

/// What came out.
#[derive(Clone, Debug, Serialize)]
pub struct SoftHard {
    /// The scene.
    pub question: Question,
    /// Discs.
    pub discs: usize,
    /// The time in which the gas cools.
    pub cooling_time: f64,
    /// The typical normal speed of an impact, at which the damping gives the restitution.
    pub impact_speed: f64,
    /// Soft models from the softest on, then the hard one.
    pub models: Vec<Model>,
}

impl SoftHard {
    /// Hard discs.
    pub fn hard(&self) -> Option<&Model> {
        self.models.iter().find(|model| model.stiffness.is_none())
    }
}

/// Runs every model with every seed.
///
/// # Errors
/// [`StudyError`] if a scene is refused or breaks.
pub fn soft_hard(question: &Question, progress: Progress<'_>) -> Result<SoftHard, StudyError> {
    let pressure = luding(question.packing_fraction);
    // ω = 4 (Z − 1)/√π, of a gas that keeps its temperature.
    let rate = 4.0 * (pressure - 1.0) / std::f64::consts::PI.sqrt();
    let cooling_time = COOLING / rate;
    // Mean normal speed of impacts at kT = m = 1: √π.
    let impact_speed = std::f64::consts::PI.sqrt();
    let kinds: Vec<Option<f64>> = question.stiffnesses.iter().copied().map(Some).chain([None]).collect();
    let seeds: Vec<u64> = (1..=question.seeds).collect();
    let meter = Meter::new((kinds.len() * seeds.len()) as f64, progress);
    let mut models = vec![];
    let mut discs = 0;
    for stiffness in kinds {
        let way = match stiffness {
            Some(stiffness) => Way::soft(stiffness, question.restitution, impact_speed)?,
            None => Way::Hard,
        };
        let runs = meter.each(&seeds, |&seed| way.run(question, seed, cooling_time))?;
        discs = runs[0].discs;
        let over = |of: fn(&One) -> f64| Mean::of(&runs.iter().map(of).collect::<Vec<_>>());
        let depth = stiffness.map_or(0.0, |stiffness| (2.5 / stiffness).powf(0.4));
        let diameter = 1.0 - GAMMA * depth;
        let effective = luding(question.packing_fraction * diameter * diameter);
        models.push(Model {
            stiffness,
            damping: way.damping(),
            step: way.step(),
            depth,
            compressibility: over(|one| one.compressibility),
            effective,
            cooled: over(|one| one.cooled),
            cost: median(runs.iter().map(|one| one.cost)),
        });
    }
    Ok(SoftHard { question: question.clone(), discs, cooling_time, impact_speed, models })
}

/// A way to model the scene.
enum Way {
    Soft { stiffness: f64, damping: f64, step: f64 },
    Hard,
}

/// What comes out of one seed.
struct One {
    discs: usize,
    compressibility: f64,
    cooled: f64,
    cost: f64,
}

impl Way {
    /// Discs of a stiffness, with the damping that gives a restitution at a speed.
    fn soft(stiffness: f64, restitution: f64, speed: f64) -> Result<Way, StudyError> {
        let (mut low, mut high) = (0.0, 1.0);
        while impact(stiffness, high, speed).restitution > restitution {
            high *= 2.0;
        }
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if impact(stiffness, middle, speed).restitution > restitution {
                low = middle
            } else {
                high = middle
            }
        }
        let duration = impact(stiffness, 0.0, speed).duration;
        Ok(Way::Soft { stiffness, damping: 0.5 * (low + high), step: duration / STEPS_A_CONTACT })
    }

    fn damping(&self) -> Option<f64> {
        if let Way::Soft { damping, .. } = self { Some(*damping) } else { None }
    }

    fn step(&self) -> Option<f64> {
        if let Way::Soft { step, .. } = self { Some(*step) } else { None }
    }

    fn begin(&self, question: &Question, seed: u64, elastic: bool) -> Result<Running, StudyError> {
        let scene = Overrides::new()
            .set(&COUNT, question.discs)
            .set(&PACKING_FRACTION, question.packing_fraction)
            .set(&SEED, seed)
            .set(&TEMPERATURE, 1.0);
        match self {
            Way::Hard => {
                let restitution = if elastic { 1.0 } else { question.restitution };
                Running::begin("hard-disks", &scene.set(&hard_disks::keys::RESTITUTION, restitution))
            }
            Way::Soft { stiffness, damping, step } => {
                let damping = if elastic { 0.0 } else { *damping };
                let law = scene.set(&STIFFNESS, *stiffness).set(&NORMAL_DAMPING, damping);
                let law = law.set(&SHEAR_DAMPING, 0.0).set(&FRICTION, 0.0);
                Running::begin("bench", &law.set(&DT, *step).set(&STEPS, 1_u64))
            }
        }
    }

    /// A time, as a moment: the step that is nearest to it, where there are steps.
    fn at(&self, time: f64) -> Until {
        match self.step() {
            Some(step) => Until::Steps((time / step).round() as u64),
            None => Until::Time(time),
        }
    }

    fn run(&self, question: &Question, seed: u64, cooling_time: f64) -> Result<One, StudyError> {
        let mut fluid = self.begin(question, seed, true)?;
        let (discs, area) = (fluid.simulation.particles().grain_count(), fluid.domain.area());
        // The lattice of the start melts.
        let melted = 0.5 * question.time;
        fluid.until(self.at(melted))?;
        let begun = cpu_time::ThreadTime::now();
        let mut pressure = 0.0;
        let virial = |fluid: &Running| match self {
            Way::Hard => fluid.observed(["virial"]).map(|[virial]| virial),
            Way::Soft { .. } => Ok(0.0),
        };
        let (before, time) = (virial(&fluid)?, fluid.simulation.clock().time);
        for look in 1..=LOOKS {
            fluid.until(self.at(melted + question.time * look as f64 / LOOKS as f64))?;
            if let Way::Soft { .. } = self {
                let [seen, temperature] = fluid.observed(["pressure", "temperature"])?;
                // The pressure has the kinetic energy of N − 1 discs, for momentum is conserved; that of hard discs has all.
                pressure += (seen * area + temperature) / (discs as f64 * temperature);
            }
        }
        let flown = fluid.simulation.clock().time - time;
        let cost = begun.elapsed().as_secs_f64() / flown;
        let compressibility = match self {
            Way::Soft { .. } => pressure / LOOKS as f64,
            Way::Hard => {
                let [temperature] = fluid.observed(["temperature"])?;
                1.0 + (virial(&fluid)? - before) / (2.0 * discs as f64 * temperature * flown)
            }
        };
        let mut gas = self.begin(question, seed, false)?;
        let [start] = gas.observed(["temperature"])?;
        gas.until(self.at(cooling_time))?;
        let [end] = gas.observed(["temperature"])?;
        Ok(One { discs, compressibility, cooled: end / start, cost })
    }
}

/// A head-on impact of two discs of mass 1, whose effective mass is ½: Hertz with damping, no pull.
fn impact(stiffness: f64, damping: f64, speed: f64) -> Impact {
    Spring::Hertz.impact(2.0 * stiffness, damping, speed)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without damping everything comes back, after 2.94 δ/v with the depth δ = (5 μ v²/(4 k))^{2/5}; with damping less.
    #[test]
    fn impacts_are_those_of_hertz() {
        let Impact { restitution, duration } = impact(1e4, 0.0, 1.5);
        let depth = (1.25 * 0.5 * 1.5 * 1.5 / 1e4_f64).powf(0.4);
        assert!((restitution - 1.0).abs() < 1e-3 && (duration / (2.943 * depth / 1.5) - 1.0).abs() < 2e-3);
        let Ok(Way::Soft { damping, .. }) = Way::soft(1e4, 0.8, 1.5) else { panic!("no way") };
        assert!((impact(1e4, damping, 1.5).restitution - 0.8).abs() < 1e-3);
    }
}
