//! A scene of particles in a bath, held against what the method demands.

use super::dynamics::{Found, lattice_of};
use super::keys::{LAW, PER_SIDE, SEARCH, SKIN};
use super::limits::{bound, step_limits};
use super::losses;
use super::options::{By, PairLaw};
use super::programs::programs;
use super::scene::Scene;
use super::simulation::Running;
use crate::domain::Domain;
use crate::grid::sectors_of;
use crate::memory::{Foreseen, PROGRAM, available};
use crate::method::{
    Every, Fact, Failure, Prepared, Purpose, Schedule, Simulation, StepLimit, Until, VectorProgram, compress,
};
use crate::number::significant;
use crate::particles::{Particle, Particles};
use crate::scene::{
    DT, GENERATE, Output, Precision, RADIUS, Read, Reason, SIDES, SceneError, SceneErrors, Spot, Values,
    WallMotion, Warning,
};
use crate::start::{Stated, make, outside, overlaps};
use crate::words::Words;
use serde_json::{Map, Value, json};
use std::path::Path;
use stripmine_kernels::sweep::fast::lattice::SPARSE;
use stripmine_kernels::sweep::fast::{Grid, GridError};
use stripmine_kernels::sweep::lattice::Frame;

/// Particles may be nearer than a diameter by this part of it at the start: the potential is then 100 ε.
const DEEPEST: f64 = 0.25;
/// How near particles come at all, in diameters: on a lattice those that come nearer share a cell, which costs time.
pub(super) const NEAREST: f64 = 0.82;
/// Sectors of the source's case of all pairs.
const FEWEST: f64 = 3.0;

/// A checked scene.
#[derive(Clone)]
pub(super) struct Checked {
    pub(super) scene: Scene,
    pub(super) domain: Domain,
    pub(super) particles: Particles,
    /// σ and the mass of every particle (length, mass).
    pub(super) diameter: f64,
    pub(super) mass: f64,
    /// The cut-off (length); a diameter where there are no pairs.
    pub(super) reach: f64,
    pub(super) found: Found,
    /// Seed of the noise.
    pub(super) seed: u64,
    warnings: Vec<Warning>,
    choices: Vec<String>,
}

/// Makes the particles of a scene and holds it against every precondition.
///
/// # Errors
/// [`SceneErrors`]: every precondition that does not hold.
pub(super) fn prepare(values: Values) -> Result<Box<dyn Prepared>, SceneErrors> {
    Ok(Box::new(checked(values)?))
}

/// The same, as this method knows it.
pub(super) fn checked(values: Values) -> Result<Checked, SceneErrors> {
    let (mut scene, mut read) = (Scene::default(), Read::new(&values));
    scene.bind(&mut read);
    read.done()?;
    let stated = Stated {
        values: &values,
        domain: &scene.domain,
        start: &scene.start,
        walls: WallMotion::Fixed,
        compress,
    };
    let made = make(&stated)?;
    let (domain, particles) = (made.domain, made.particles);
    let mut errors = outside(&stated, &domain, &particles);
    if scene.law != PairLaw::None {
        let why = "so near they would be thrown apart";
        errors.extend(overlaps(&stated, &domain, &particles, DEEPEST, why));
    }
    let first = match of_one_kind(&values, &particles) {
        Ok(first) => first,
        Err(error) => {
            errors.push(error);
            return Err(SceneErrors(errors));
        }
    };
    let (diameter, mass) = (2.0 * first.radius, first.mass);
    let reach = diameter * scene.law.cutoff().unwrap_or(1.0);
    let mut choices = vec![];
    let found = found(&values, &mut scene, &domain, [diameter, reach], particles.len(), &mut choices);
    let found = match found {
        Ok(found) => found,
        Err(error) => {
            errors.push(error);
            return Err(SceneErrors(errors));
        }
    };
    SceneErrors::none_of(errors)?;
    let mut warnings = made.warnings;
    warnings.extend(too_long(&scene, diameter, mass));
    // Written down where the start has no seed. Where it has one, the noise follows that of the start, also where a
    // resolved scene is run again with another one.
    if scene.start.seed().is_none() {
        scene.noise_seed.get_or_insert(1);
    }
    let seed = scene.noise_seed.or(scene.start.seed()).unwrap_or(1);
    Ok(Checked { scene, domain, particles, diameter, mass, reach, found, seed, warnings, choices })
}

/// The first particle, if all are alike and move.
fn of_one_kind(values: &Values, particles: &Particles) -> Result<Particle, SceneError> {
    let refused = |message: String| values.spot(&RADIUS).error(Reason::Contradiction, message);
    let Some(&first) = particles.all().first() else {
        return Err(refused("there is no particle".to_owned()));
    };
    let walls = particles.len() - particles.grain_count();
    if walls > 0 {
        let error = values
            .spot(&GENERATE)
            .error(Reason::Contradiction, format!("{walls} wall discs, but every particle moves"));
        return Err(error.expecting(
            "generate = \"mesh\", \"random\", \"hexagonal\" or \"list\", or a file without wall discs",
        ));
    }
    let differs = |other: &&Particle| other.radius != first.radius || other.mass != first.mass;
    match particles.all().iter().find(differs) {
        None => Ok(first),
        Some(other) => Err(refused(format!(
            "particle {} has radius {} and mass {}, particle {} has {} and {}: particles in a bath are all alike",
            first.id, first.radius, first.mass, other.id, other.radius, other.mass
        ))
        .expecting("one radius and one mass, no radius_spread")),
    }
}

/// A step beyond the source's bound.
fn too_long(scene: &Scene, diameter: f64, mass: f64) -> Option<Warning> {
    let (step, _) = bound(scene, diameter, mass);
    (scene.law != PairLaw::None && scene.dt > step).then(|| Warning {
        key: DT.path(),
        message: format!(
            "dt = {} is beyond √(2 m r_c/F) = {step}, in which a particle crosses the cut-off: particles will be lost",
            scene.dt
        , step = significant(step, 5)),
        suggestion: format!("take a step of at most {}", significant(0.1 * step, 2)),
    })
}

/// How pairs are found, by what the scene says or what serves.
fn found(
    values: &Values,
    scene: &mut Scene,
    domain: &Domain,
    [diameter, reach]: [f64; 2],
    count: usize,
    choices: &mut Vec<String>,
) -> Result<Found, SceneError> {
    let single = scene.precision != Precision::F64;
    let box_spot =
        || -> Spot { if values.gives(&SIDES) { values.spot(&SIDES) } else { values.spot(&GENERATE) } };
    let lattice = || match scene.law {
        PairLaw::Wca => lattice_of(domain, reach, NEAREST * diameter),
        _ => None,
    };
    let lists = |scene: &Scene| {
        let skin = scene.skin.unwrap_or_else(|| roomy_skin(domain, reach, count));
        let grid = sectors_of(domain, reach + skin, single, count);
        (grid.map(|grid| Found::Lists(grid, skin)), skin)
    };
    let sectors = |scene: &Scene| match scene.per_side {
        None => sectors_of(domain, reach, single, count)
            .map_err(|cause| box_spot().error(Reason::Geometry, cause.to_string())),
        Some(per_side) => grid(values, domain, per_side, reach),
    };
    let chosen = match scene.by {
        By::Lattice => lattice().ok_or_else(|| {
            let message = format!(
                "no lattice serves: a cell that is one particle's and a mask of 5 × 5 of them that sees to the cut-off {reach} are \
                 for law.kind = \"wca\" and boxes of at least five cells"
            );
            let spot = if scene.law == PairLaw::Wca { values.spot(&SEARCH) } else { values.spot(&LAW) };
            spot.error(Reason::Geometry, message).expecting("search.by = \"sectors\" or \"neighbor-list\"")
        }).map(|(shape, frame)| Found::Lattice(shape, frame))?,
        By::Sectors => Found::Sectors(sectors(scene)?),
        By::Auto | By::NeighborList if scene.by == By::NeighborList || scene.skin.is_some() => {
            let (lists, skin) = lists(scene);
            lists.map_err(|cause| {
                let spot = if values.gives(&SKIN) { values.spot(&SKIN) } else { box_spot() };
                let error = spot.error(Reason::Geometry, format!("{cause}, with a skin of {skin}", skin = significant(skin, 5)));
                error.advising("make the box larger, lower search.skin, or set search.by = \"sectors\"")
            })?
        }
        By::Auto if scene.per_side.is_some() => {
            choices.push("search.by = \"sectors\": their number is given".to_owned());
            Found::Sectors(sectors(scene)?)
        }
        By::Auto | By::NeighborList => match lists(scene).0 {
            Ok(lists) => {
                choices.push("search.by = \"neighbor-list\": fastest wherever all were measured".to_owned());
                lists
            }
            Err(_) => {
                choices.push("search.by = \"sectors\": the box has no room for lists".to_owned());
                Found::Sectors(sectors(scene)?)
            }
        },
    };
    scene.by = chosen.by();
    if let Found::Lists(_, skin) = &chosen {
        scene.skin = Some(*skin);
    }
    Ok(chosen)
}

/// So many sectors along each side.
fn grid(values: &Values, domain: &Domain, per_side: u64, reach: f64) -> Result<Grid, SceneError> {
    let counts = [per_side as usize; 2];
    let edge = domain.lengths().map(|side| side / per_side as f64);
    if edge.iter().any(|&edge| edge < reach) {
        let most =
            domain.lengths().map(|side| (side / reach).floor()).into_iter().fold(f64::INFINITY, f64::min);
        let message = format!(
            "search.sectors = {per_side} makes sectors {:.6} wide, narrower than the cut-off {reach:.6}: pairs would be missed",
            edge[0].min(edge[1])
        );
        let error = values.spot(&PER_SIDE).error(Reason::Geometry, message);
        return Err(match most >= FEWEST {
            true => error.expecting(format!("from 3 to {most} sectors")),
            false => error.advising("make the box larger: a side takes at least three sectors"),
        });
    }
    let along = per_side as f64;
    if along * along >= f64::from(u32::MAX) {
        let cause = GridError::TooMany { columns: along, rows: along };
        return Err(values.spot(&PER_SIDE).error(Reason::Geometry, cause.to_string()));
    }
    Ok(Grid { frame: Frame { origin: domain.corner(), edge }, counts, periodic: domain.periodic() })
}

/// How much farther than the cut-off listed pairs may be (length): about a mean distance, within bounds, and not more than the box has
/// room for.
fn roomy_skin(domain: &Domain, reach: f64, count: usize) -> f64 {
    let spacing = (domain.area() / count.max(1) as f64).sqrt();
    let wanted = (0.5 * spacing).clamp(0.2 * reach, 2.0 * reach);
    let room = (0..2).map(|axis| domain.length(axis) / 3.0 - reach).fold(f64::INFINITY, f64::min);
    if room > 0.0 { wanted.min(room * (1.0 - 1e-12)) } else { wanted }
}

impl Checked {
    /// Whether particles act on each other.
    pub(super) fn has_pairs(&self) -> bool {
        self.scene.law != PairLaw::None
    }

    /// What bounds the step.
    pub(super) fn limits(&self) -> Vec<StepLimit> {
        step_limits(&self.scene, self.diameter, self.mass)
    }
}

impl Prepared for Checked {
    fn scene(&self) -> String {
        self.scene.to_toml()
    }

    fn schedule(&self) -> Schedule {
        let run = self.scene.run;
        Schedule {
            until: Until::Steps(run.steps),
            rows: Every::steps(run.thermo_every),
            snapshots: Every::steps(run.snapshot_every),
            checkpoints: Every::checkpoints(run.checkpoint_every.map(Every::steps)),
        }
    }

    fn output(&self) -> Output {
        self.scene.output
    }

    fn domain(&self) -> Domain {
        self.domain
    }

    fn particles(&self) -> &Particles {
        &self.particles
    }

    fn seed(&self) -> Option<u64> {
        self.scene.start.seed()
    }

    fn start_file(&self) -> Option<&Path> {
        self.scene.start.file()
    }

    fn facts(&self) -> Vec<Fact> {
        let Checked { scene, domain, particles, diameter, reach, .. } = self;
        let ([x, y], count) = (domain.lengths(), particles.len());
        let density = count as f64 * diameter * diameter / domain.area();
        let by = match &self.found {
            Found::Lattice(shape, _) => format!("lattice of {} × {} cells", shape.columns(), shape.rows()),
            Found::Sectors(grid) => format!("{} × {} sectors", grid.counts[0], grid.counts[1]),
            Found::Lists(_, skin) => format!("neighbour lists to {:.4} beyond the cut-off", skin),
        };
        let mut facts = vec![
            Fact::new("units", scene.units.as_str(), "units", scene.units.as_str()),
            Fact::new("grains", count, "particles", count.to_string()),
            Fact::new("sides", json!([x, y]), "box", format!("{x:.6} × {y:.6}")),
            Fact::data("periodic", json!(domain.periodic())),
            Fact::new("density", density, "density N σ²/A", format!("{density:.4}")),
            Fact::new("law", scene.law.word(), "pairs", scene.law.word()),
        ];
        if scene.law != PairLaw::None {
            facts.push(Fact::new("cutoff", *reach, "cut-off", format!("{reach:.6}")));
        }
        facts.push(Fact::new("search", scene.by.word(), "search", by));
        facts.push(Fact::new("noise_seed", self.seed, "seed of the noise", self.seed.to_string()));
        facts.push(Fact::words("steps", format!("{} of dt = {}", scene.run.steps, scene.dt)));
        facts
    }

    fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    fn choices(&self) -> &[String] {
        &self.choices
    }

    fn left_out(&self) -> &[String] {
        &[]
    }

    fn step_limits(&self) -> Vec<StepLimit> {
        self.limits()
    }

    fn memory(&self) -> Foreseen {
        let count = self.particles.len() as f64;
        // State, sums, ids and numbers; sectors; lists with the places at which they were made.
        let engine = match &self.found {
            Found::Sectors(grid) => 155.0 * count + 8.0 * grid.counts.iter().product::<usize>() as f64,
            Found::Lists(grid, _) => 200.0 * count + 8.0 * grid.counts.iter().product::<usize>() as f64,
            Found::Lattice(shape, _) => {
                // A number and a bit a cell; copies of the places where the lattice is not sparse.
                let copies = if count < SPARSE * shape.cells() as f64 { 0.0 } else { 8.0 };
                195.0 * count + (4.0 + copies + 0.125) * shape.padded() as f64
            }
        };
        // The scene's particles in three places, once more while they are observed, and the frame that is being written.
        let particles = 6.0 * size_of::<Particle>() as f64 * count;
        Foreseen {
            needed: (PROGRAM + engine + particles) as u64,
            available: available(),
            what: format!("{count} particles"),
            remedy: "take fewer particles",
        }
    }

    fn settings(&self) -> Map<String, Value> {
        let Checked { scene, particles, domain, diameter, .. } = self;
        let density = particles.len() as f64 * diameter * diameter / domain.area();
        let settings = [
            ("density", json!(density)),
            ("precision", json!(scene.precision.word())),
            ("integrator", json!(scene.scheme.word())),
            ("law", json!(scene.law.word())),
            ("search", json!(scene.by.word())),
            ("skin", json!(scene.skin)),
            ("instruction_set", json!(scene.instructions().name())),
        ];
        settings.map(|(name, value)| (name.to_owned(), value)).into_iter().collect()
    }

    fn event_columns(&self) -> Option<&'static str> {
        (self.scene.losses && self.scene.most_lost > 0).then_some(losses::COLUMNS)
    }

    fn programs(&self) -> Vec<VectorProgram> {
        programs(self)
    }

    fn start(&self, purpose: Purpose) -> Result<Box<dyn Simulation>, Failure> {
        Ok(Box::new(Running::new(self, purpose)?))
    }

    fn started_from(&self, particles: Particles) -> Box<dyn Prepared> {
        Box::new(Checked { particles, ..self.clone() })
    }
}
