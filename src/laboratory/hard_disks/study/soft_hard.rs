//! Soft discs compared with hard discs: one scene with lattice MD at increasing stiffness, and with hard discs.

use super::fluid::{collision_rate, compressibility, luding};
use crate::console::CommandFailure;
use crate::frame::{FrameBuilder, TableCell};
use crate::laboratory::running::RunningScene;
use crate::results::{FinishedItem, Progress, ProgressMeter, StudyEnvironment, StudySize};
use crate::statistics::{MeanWithBar, median};
use crate::study::StudyError;
use stripmine_kernels::law::spring::{HeadOnImpact, Spring};
use stripmine_physics::method::lattice_md::keys::{FRICTION, NORMAL_DAMPING, SHEAR_DAMPING, STIFFNESS};
use stripmine_physics::method::{Until, hard_disks};
use stripmine_physics::scene::{COUNT, DT, Overrides, PACKING_FRACTION, SEED, STEPS, TEMPERATURE};

/// Scene and size of the comparison. Diameter, mass and kT are 1.
pub(crate) struct SoftHardComparison {
    /// Minimum number of discs.
    pub discs: u64,
    /// Area of the discs over that of the box.
    pub packing_fraction: f64,
    /// Restitution of the gas that cools.
    pub(crate) restitution: f64,
    /// Stiffnesses k_N of the soft discs (kT/diameter^2.5).
    pub(crate) stiffnesses: &'static [f64],
    /// Number of seeds, each with an independent start.
    pub seeds: u64,
    /// Measured time of the pressure.
    pub time: f64,
}

impl SoftHardComparison {
    /// Comparison in the report.
    pub(crate) const REPORT: SoftHardComparison = SoftHardComparison {
        discs: 500,
        packing_fraction: 0.5,
        restitution: 0.9,
        stiffnesses: &[1e3, 1e4, 1e5, 1e6, 1e7],
        seeds: 8,
        time: 20.0,
    };
}

/// Steps during a typical contact.
const STEPS_A_CONTACT: f64 = 40.0;
/// Samples of the pressure of soft discs.
const LOOKS: u64 = 400;
/// Approximate collisions per disc while the gas cools.
const COOLING: f64 = 10.0;
/// Γ(7/5), for the effective diameter of Hertz discs.
const GAMMA: f64 = 0.887_263_817_503_075;

/// Results of discs of one stiffness, or of hard discs.
struct DiscModel {
    soft: Option<SoftDiscs>,
    /// Depth of a head-on contact with energy kT (diameters).
    depth: f64,
    /// Compressibility of the elastic fluid.
    compressibility: MeanWithBar,
    /// Compressibility of hard discs of the effective diameter.
    effective: f64,
    /// Temperature of the cooled gas over its initial value.
    cooled: MeanWithBar,
    /// Processor seconds per unit of time of the elastic fluid.
    cost: f64,
}

/// Makes the item of the report.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, size: StudySize) -> Result<FinishedItem, CommandFailure> {
    let question = match size {
        StudySize::Quick => SoftHardComparison {
            discs: 200,
            stiffnesses: &[1e3, 1e4, 1e5],
            seeds: 2,
            time: 4.0,
            ..SoftHardComparison::REPORT
        },
        StudySize::Full | StudySize::All => SoftHardComparison::REPORT,
    };
    compare_soft_hard(&question, lab.progress)
}

/// Runs the soft models from the softest to the stiffest, then the hard model, with every seed.
pub(crate) fn compare_soft_hard(
    question: &SoftHardComparison,
    progress: Progress<'_>,
) -> Result<FinishedItem, CommandFailure> {
    // From the collision rate at constant temperature.
    let cooling_time = COOLING / collision_rate(luding(question.packing_fraction));
    // Mean normal speed of impacts at kT = m = 1: √π.
    let impact_speed = std::f64::consts::PI.sqrt();
    let seeds: Vec<u64> = (1..=question.seeds).collect();
    let kinds: Vec<Option<f64>> = question.stiffnesses.iter().copied().map(Some).chain([None]).collect();
    let meter = ProgressMeter::new((kinds.len() * seeds.len()) as f64, progress);
    let (mut models, mut discs) = (vec![], 0);
    for stiffness in kinds {
        let kind = DiscKind(stiffness.map(|it| SoftDiscs::new(it, question.restitution, impact_speed)));
        let runs = meter.run_cases(&seeds, |&seed| kind.run(question, seed, cooling_time))?;
        discs = runs[0].discs;
        let over = |of: fn(&SeedResult) -> f64| MeanWithBar::of(&runs.iter().map(of).collect::<Vec<_>>());
        let depth = stiffness.map_or(0.0, |stiffness| (2.5 / stiffness).powf(0.4));
        let diameter = 1.0 - GAMMA * depth;
        models.push(DiscModel {
            depth,
            compressibility: over(|one| one.compressibility),
            effective: luding(question.packing_fraction * diameter * diameter),
            cooled: over(|one| one.cooled),
            cost: median(runs.iter().map(|one| one.cost)),
            soft: kind.0,
        });
    }
    let hard = &models[models.len() - 1];
    let off = |model: &DiscModel| {
        let MeanWithBar { value, bar } = hard.compressibility;
        let off = model.compressibility.relative_to(value);
        let off = MeanWithBar { bar: off.bar.hypot(bar / value), ..off }.percent();
        TableCell::with_error(off.value, Some(off.bar), 2)
    };
    let ends = [question.stiffnesses[0], question.stiffnesses[question.stiffnesses.len() - 1]];
    Ok(FinishedItem::of([
        FrameBuilder::of(&models)
            .cell("stiffness of a contact", |it| match &it.soft {
                Some(soft) => TableCell::Short(soft.stiffness),
                None => TableCell::from("hard"),
            })
            .number("damping γ_N", 3, |it| it.soft.as_ref().map(|it| it.damping))
            .number("step", 6, |it| it.soft.as_ref().map(|it| it.step))
            .number("depth of a contact of kT (%)", 2, |it| 100.0 * it.depth)
            .mean("Z", 4, |it| it.compressibility)
            .number("Z of the effective diameter", 4, |it| it.effective)
            .mean("T/T₀ cooled", 4, |it| it.cooled)
            .number("cost (ms for a unit of time)", 2, |it| 1e3 * it.cost)
            .frame("soft_hard", "Soft discs and hard ones"),
        FrameBuilder::of(ends)
            .short("stiffness of a contact", |end| *end)
            .number("Z", 4, |_| hard.compressibility.value)
            .number("T/T₀ cooled", 4, |_| hard.cooled.value)
            .number("cost", 6, |_| hard.cost)
            .frame("hard", "Hard discs, at the ends of the range of stiffnesses"),
        FrameBuilder::of([()])
            .count("discs", |()| discs)
            .number("packing fraction", 2, |()| question.packing_fraction)
            .number("restitution", 2, |()| question.restitution)
            .count("seeds", |()| question.seeds)
            .number("cooling time", 2, |()| cooling_time)
            .number("impact speed", 2, |()| impact_speed)
            .cell("softest off (%)", |()| off(&models[0]))
            .cell("stiffest off (%)", |()| off(&models[models.len() - 2]))
            .number("stiffest cost over hard", 0, |()| models[models.len() - 2].cost / hard.cost)
            .frame("summary", "The scene, and pressure and cost beside those of hard discs"),
    ])
    .with_seeds(1..=question.seeds))
}

/// Parameters of soft discs.
struct SoftDiscs {
    stiffness: f64,
    damping: f64,
    step: f64,
}

impl SoftDiscs {
    /// Finds the damping that gives a restitution at a speed.
    fn new(stiffness: f64, restitution: f64, speed: f64) -> SoftDiscs {
        let (mut low, mut high) = (0.0, 1.0);
        let is_too_elastic = |damping: f64| impact(stiffness, damping, speed).restitution > restitution;
        while is_too_elastic(high) {
            high *= 2.0;
        }
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            *(if is_too_elastic(middle) { &mut low } else { &mut high }) = middle;
        }
        let duration = impact(stiffness, 0.0, speed).duration;
        SoftDiscs { stiffness, damping: 0.5 * (low + high), step: duration / STEPS_A_CONTACT }
    }
}

/// Discs of the scene: soft, or hard if `None`.
struct DiscKind(Option<SoftDiscs>);

/// Results of one seed.
struct SeedResult {
    discs: usize,
    compressibility: f64,
    cooled: f64,
    cost: f64,
}

impl DiscKind {
    fn begin(
        &self,
        question: &SoftHardComparison,
        seed: u64,
        elastic: bool,
    ) -> Result<RunningScene, StudyError> {
        let scene = Overrides::new()
            .set(&COUNT, question.discs)
            .set(&PACKING_FRACTION, question.packing_fraction)
            .set(&SEED, seed)
            .set(&TEMPERATURE, 1.0);
        match &self.0 {
            None => {
                let restitution = if elastic { 1.0 } else { question.restitution };
                RunningScene::begin("hard-disks", &scene.set(&hard_disks::keys::RESTITUTION, restitution))
            }
            Some(soft) => {
                let damping = if elastic { 0.0 } else { soft.damping };
                let law = scene.set(&STIFFNESS, soft.stiffness).set(&NORMAL_DAMPING, damping);
                let law = law.set(&SHEAR_DAMPING, 0.0).set(&FRICTION, 0.0);
                RunningScene::begin("bench", &law.set(&DT, soft.step).set(&STEPS, 1_u64))
            }
        }
    }

    /// Moment of a time; for soft discs the nearest step.
    fn at(&self, time: f64) -> Until {
        self.0.as_ref().map_or(Until::Time(time), |it| Until::Steps((time / it.step).round() as u64))
    }

    fn run(
        &self,
        question: &SoftHardComparison,
        seed: u64,
        cooling_time: f64,
    ) -> Result<SeedResult, StudyError> {
        let mut fluid = self.begin(question, seed, true)?;
        let (discs, area) = (fluid.simulation.particles().grain_count(), fluid.domain.area());
        // The initial lattice melts.
        let melted = 0.5 * question.time;
        fluid.advance_until(self.at(melted))?;
        let begun = cpu_time::ThreadTime::now();
        let mut pressure = 0.0;
        let virial = |fluid: &RunningScene| match self.0 {
            None => fluid.observed_values(["virial"]).map(|[virial]| virial),
            Some(_) => Ok(0.0),
        };
        let (before, time) = (virial(&fluid)?, fluid.simulation.clock().time);
        for look in 1..=LOOKS {
            fluid.advance_until(self.at(melted + question.time * look as f64 / LOOKS as f64))?;
            if self.0.is_some() {
                let [seen, temperature] = fluid.observed_values(["pressure", "temperature"])?;
                // The pressure contains the kinetic energy of N − 1 discs, because momentum is conserved; that of hard discs contains all.
                pressure += (seen * area + temperature) / (discs as f64 * temperature);
            }
        }
        let flown = fluid.simulation.clock().time - time;
        let cost = begun.elapsed().as_secs_f64() / flown;
        let compressibility = match self.0 {
            Some(_) => pressure / LOOKS as f64,
            None => {
                let [temperature] = fluid.observed_values(["temperature"])?;
                compressibility(discs as f64, [virial(&fluid)? - before, flown], temperature)
            }
        };
        let mut gas = self.begin(question, seed, false)?;
        let [start] = gas.observed_values(["temperature"])?;
        gas.advance_until(self.at(cooling_time))?;
        let [end] = gas.observed_values(["temperature"])?;
        Ok(SeedResult { discs, compressibility, cooled: end / start, cost })
    }
}

/// Head-on impact of two discs of mass 1 (effective mass ½): Hertz law with damping, without attraction.
fn impact(stiffness: f64, damping: f64, speed: f64) -> HeadOnImpact {
    Spring::Hertz.impact(2.0 * stiffness, damping, speed)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without damping the restitution is 1 and the duration 2.94 δ/v with the depth δ = (5 μ v²/(4 k))^{2/5}; damping lowers the restitution.
    #[test]
    fn impacts_follow_hertz() {
        let HeadOnImpact { restitution, duration } = impact(1e4, 0.0, 1.5);
        let depth = (1.25 * 0.5 * 1.5 * 1.5 / 1e4_f64).powf(0.4);
        assert!((restitution - 1.0).abs() < 1e-3 && (duration / (2.943 * depth / 1.5) - 1.0).abs() < 2e-3);
        let SoftDiscs { damping, .. } = SoftDiscs::new(1e4, 0.8, 1.5);
        assert!((impact(1e4, damping, 1.5).restitution - 0.8).abs() < 1e-3);
    }
}
