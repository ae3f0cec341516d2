//! A scene of bodies, held against what the method demands.

use super::choice;
use super::field::Attraction;
use super::keys::{BODIES, ENGINE, GENERATE, SOFTENING};
use super::options::{Engine, StartKind};
use super::scene::Scene;
use super::shifted::counted;
use super::simulation::Running;
use super::starts::{ORBIT, bodies};
use crate::domain::{Domain, Side};
use crate::memory::{Foreseen, PROGRAM, available};
use crate::method::{
    Beyond, Every, Fact, Failure, Prepared, Purpose, Schedule, Simulation, StepLimit, Until, VectorProgram,
};
use crate::particles::{Kind, Particle, Particles};
use crate::scene::{Output, PRECISION, Precision, Read, Reason, SceneError, SceneErrors, Values, Warning};
use crate::words::Words;
use serde_json::{Map, Value, json};
use std::collections::HashMap;
use std::path::Path;

/// The lightest body over the heaviest in single precision: products of two such masses are still normal numbers.
const LIGHTEST: f64 = 1e-18;

/// A checked scene.
#[derive(Clone)]
pub(super) struct Checked {
    pub(super) scene: Scene,
    pub(super) particles: Particles,
    choices: Vec<String>,
}

/// Makes the bodies of a scene and holds it against every precondition.
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
    let mut errors = vec![];
    if scene.precision == Precision::F32 {
        let error = values.spot(&PRECISION).error(
            Reason::Contradiction,
            "`machine.precision` is \"f32\", but the state of bodies is in double precision",
        );
        errors.push(error.expecting("\"f64\", or \"mixed\" for forces in single precision"));
    }
    if scene.engine == Engine::Reference && scene.precision == Precision::Mixed {
        let message = format!(
            "`machine.precision` is \"mixed\", but `{}` = \"reference\" sums in double precision only",
            ENGINE.path()
        );
        let error = values.spot(&PRECISION).error(Reason::Contradiction, message);
        errors.push(error.expecting("\"f64\", or another engine"));
    }
    if scene.start.kind == StartKind::List {
        errors.extend(wrong_rows(&values, &scene));
        SceneErrors::none_of(std::mem::take(&mut errors))?;
    }
    let of = bodies(&scene.start, scene.softening);
    let all = of.iter().zip(1..).map(|(&(mass, position, velocity), id)| Particle {
        id,
        kind: Kind::Grain,
        position,
        velocity,
        angle: 0.0,
        omega: 0.0,
        // Points have none; it is what a viewer draws.
        radius: scene.softening.max(0.01),
        mass,
    });
    let particles = Particles::new(all.collect());
    if scene.softening == 0.0 {
        errors.extend(coincident(&values, &particles));
    }
    if scene.precision == Precision::Mixed {
        errors.extend(too_light(&values, &particles));
    }
    SceneErrors::none_of(errors)?;
    let choices = choice::choose(&mut scene, particles.len());
    Ok(Checked { scene, particles, choices })
}

/// Fewer than two bodies, or masses that are not positive.
fn wrong_rows(values: &Values, scene: &Scene) -> Vec<SceneError> {
    let rows = &scene.start.bodies;
    let mut errors = vec![];
    if rows.len() < 2 {
        let message =
            format!("`particles.bodies` lists {}, but one body alone does not attract anything", rows.len());
        errors.push(values.spot(&BODIES).error(Reason::Range, message).expecting("two bodies or more"));
    }
    for (number, row) in rows.iter().enumerate().filter(|(_, row)| row[0] <= 0.0).take(5) {
        let message = format!("body {} has the mass {:?}", number + 1, row[0]);
        errors.push(
            values.item_spot(&BODIES, number).error(Reason::Range, message).expecting("a mass above 0"),
        );
    }
    errors
}

/// A body so light beside the heaviest that forces in single precision vanish.
fn too_light(values: &Values, particles: &Particles) -> Option<SceneError> {
    let heaviest = particles.all().iter().max_by(|a, b| a.mass.total_cmp(&b.mass))?;
    let lightest = particles.all().iter().min_by(|a, b| a.mass.total_cmp(&b.mass))?;
    if lightest.mass >= LIGHTEST * heaviest.mass {
        return None;
    }
    let message = format!(
        "body {} has the mass {:?}, less than {LIGHTEST:e} of the {:?} of body {}: its forces vanish in single precision",
        lightest.id, lightest.mass, heaviest.mass, heaviest.id
    );
    let error = values.spot(&PRECISION).error(Reason::Contradiction, message);
    Some(error.expecting("machine.precision = \"f64\", or a heavier body"))
}

/// Two bodies at one place, whose attraction is without bound where it is not softened.
fn coincident(values: &Values, particles: &Particles) -> Option<SceneError> {
    let mut places: HashMap<[u64; 3], u32> = HashMap::new();
    for (number, body) in particles.all().iter().enumerate() {
        // −0 and 0 are one place.
        let place = body.position.map(|x| (x + 0.0).to_bits());
        if let Some(first) = places.insert(place, body.id) {
            let [x, y, z] = body.position;
            let message = format!(
                "bodies {first} and {} are both at ({x}, {y}, {z}), and nothing softens their attraction",
                body.id
            );
            let spot = if values.gives(&BODIES) {
                values.item_spot(&BODIES, number)
            } else {
                values.spot(&GENERATE)
            };
            let error = spot.error(Reason::Overlap, message);
            return Some(error.advising(format!("set `{}` above 0, or move one of them", SOFTENING.path())));
        }
    }
    None
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
        Domain { origin: [0.0; 3], sides: [Side::Open; 3] }
    }

    fn particles(&self) -> &Particles {
        &self.particles
    }

    fn seed(&self) -> Option<u64> {
        self.scene.start.is_drawn().then_some(self.scene.start.seed)
    }

    fn start_file(&self) -> Option<&Path> {
        None
    }

    fn facts(&self) -> Vec<Fact> {
        let (scene, count) = (&self.scene, self.particles.len());
        vec![
            Fact::new("units", scene.units.as_str(), "units", scene.units.as_str()),
            Fact::new("grains", count, "bodies", count.to_string()),
            Fact::new("start", scene.start.kind.word(), "start", scene.start.kind.word()),
            Fact::new("softening", scene.softening, "softening", scene.softening.to_string()),
            Fact::new("integrator", scene.scheme.word(), "integrator", scene.scheme.word()),
            Fact::words("steps", format!("{} of dt = {}", scene.run.steps, scene.dt)),
        ]
    }

    fn warnings(&self) -> &[Warning] {
        &[]
    }

    fn choices(&self) -> &[String] {
        &self.choices
    }

    fn left_out(&self) -> &[String] {
        &[]
    }

    fn step_limits(&self) -> Vec<StepLimit> {
        let scene = &self.scene;
        match scene.start.kind {
            StartKind::Kepler => {
                // At their nearest the bodies turn as on a circle of that radius.
                let step = ORBIT * (1.0 - scene.start.eccentricity).powf(1.5) / 20.0;
                let why =
                    "a twentieth of the time of a circle through the nearest point, 2π (1 − e)^{3/2}/20"
                        .to_owned();
                vec![StepLimit {
                    name: "nearest-passage",
                    step,
                    share: scene.dt / step,
                    beyond: Beyond::Inaccurate,
                    why,
                }]
            }
            _ if scene.softening > 0.0 => {
                let heaviest = self.particles.all().iter().map(|body| body.mass).fold(0.0, f64::max);
                let step = (scene.softening.powi(3) / (2.0 * heaviest)).sqrt();
                let why =
                    "√(ε³/2m): the time of a swing of two of the heaviest bodies through each other, over 2π"
                        .to_owned();
                vec![StepLimit {
                    name: "closest-encounter",
                    step,
                    share: scene.dt / step,
                    beyond: Beyond::Inaccurate,
                    why,
                }]
            }
            _ => vec![],
        }
    }

    fn memory(&self) -> Foreseen {
        let count = self.particles.len();
        let [held, carried] = self.scene.scheme.held();
        // Positions, velocities and masses, and the state before a step; what a scheme holds; what half of the mass and the nearest
        // two are sorted for. Particles of the scene, of the run, and of two frames.
        let columns = 24 * (2 + 2 + held + carried) + 8 + 3 * 16 + 4;
        let particles = 4 * size_of::<Particle>();
        let needed = PROGRAM + (count * (columns + particles) + Attraction::bytes(&self.scene, count)) as f64;
        Foreseen {
            needed: needed as u64,
            available: available(),
            what: format!("{count} bodies"),
            remedy: "take fewer bodies",
        }
    }

    fn settings(&self) -> Map<String, Value> {
        let scene = &self.scene;
        let settings = [
            ("precision", json!(scene.precision.word())),
            ("integrator", json!(scene.scheme.word())),
            ("engine", json!(scene.engine.word())),
            ("arithmetic", json!(scene.arithmetic.word())),
            ("instruction_set", json!(scene.instructions().name())),
        ];
        settings.map(|(name, value)| (name.to_owned(), value)).into_iter().collect()
    }

    fn programs(&self) -> Vec<VectorProgram> {
        counted(self.scene.softening, self.particles.len())
    }

    fn start(&self, purpose: Purpose) -> Result<Box<dyn Simulation>, Failure> {
        Ok(Box::new(Running::new(self, purpose)?))
    }

    fn started_from(&self, particles: Particles) -> Box<dyn Prepared> {
        Box::new(Checked { particles, ..self.clone() })
    }
}
