//! Checks a scene of bodies against the preconditions of the method.

use super::choice;
use super::imported::bodies_of_file;
use super::keys::{BODIES, ENGINE, FILE, GENERATE, ROOTS, SOFTENING};
use super::options::{ArithmeticKind, ForceEngine, StartKind};
use super::scene::NbodyScene;
use super::starts::{InitialBody, initial_bodies};
use crate::method::Prepared;
use crate::particles::{Particle, ParticleKind, Particles};
use crate::scene::{
    Key, MistakeKind, PRECISION, Precision, ReadBinding, SceneError, SceneErrors, SceneValues, Warning,
};
use crate::words::Words;
use std::collections::HashMap;

/// Smallest mass ratio in single precision: products of two such masses are still normal numbers.
const LIGHTEST: f64 = 1e-18;

/// Checked scene of bodies.
#[derive(Clone)]
pub(super) struct CheckedNbody {
    pub(super) scene: NbodyScene,
    pub(super) particles: Particles,
    pub(super) choices: Vec<String>,
    pub(super) warnings: Vec<Warning>,
}

/// Creates the bodies of a scene and checks every precondition.
///
/// # Errors
/// [`SceneErrors`] with every violated precondition.
pub(super) fn prepare(values: SceneValues) -> Result<Prepared, SceneErrors> {
    Ok(check_nbody_scene(values)?.prepared())
}

/// Checks a scene and returns the method's own representation.
pub(super) fn check_nbody_scene(values: SceneValues) -> Result<CheckedNbody, SceneErrors> {
    let (mut scene, mut read) = (NbodyScene::default(), ReadBinding::new(&values));
    scene.bind(&mut read);
    read.finish_reading()?;
    let mut errors = vec![];
    if scene.precision == Precision::F32 {
        let error = values.spot(&PRECISION).error(
            MistakeKind::Contradiction,
            "`machine.precision` is \"f32\", but the state of bodies is in double precision",
        );
        errors.push(error.expecting("\"f64\", or \"mixed\" for forces in single precision"));
    }
    if scene.engine == ForceEngine::Reference && scene.precision == Precision::Mixed {
        let message = format!(
            "`machine.precision` is \"mixed\", but `{}` = \"reference\" sums in double precision only",
            ENGINE.path()
        );
        let error = values.spot(&PRECISION).error(MistakeKind::Contradiction, message);
        errors.push(error.expecting("\"f64\", or another engine"));
    }
    if scene.scheme.is_adaptive() {
        errors.extend(without_direct_sum(&values, &scene));
    }
    if scene.start.kind == StartKind::List {
        errors.extend(wrong_rows(&values, &scene));
        SceneErrors::ok_if_empty(std::mem::take(&mut errors))?;
    }
    let mut warnings = vec![];
    let (ids, of) = match scene.start.kind {
        StartKind::File => bodies_of_file(&values, &scene, &mut warnings)?,
        _ => (vec![], initial_bodies(&scene.start, scene.softening, scene.gravitational_constant)),
    };
    let radius = radius_shown(&scene, &of);
    let all = of.iter().zip(1..).map(|(&(mass, position, velocity), number)| Particle {
        id: ids.get(number as usize - 1).copied().unwrap_or(number),
        kind: ParticleKind::Grain,
        species: 0,
        position,
        velocity,
        angle: 0.0,
        omega: 0.0,
        radius,
        mass,
    });
    let particles = Particles::new(all.collect());
    if scene.softening == 0.0 {
        errors.extend(coincident(&values, &particles));
    }
    if scene.precision == Precision::Mixed {
        errors.extend(too_light(&values, &particles));
    }
    SceneErrors::ok_if_empty(errors)?;
    let choices = choice::resolve_engine(&mut scene, particles.len());
    Ok(CheckedNbody { scene, particles, choices, warnings })
}

/// Radius for viewers, as points have none: the softening, or a hundredth of the median distance from the middle.
fn radius_shown(scene: &NbodyScene, bodies: &[InitialBody]) -> f64 {
    /// Drawn radius relative to the scale of the start.
    const SMALL: f64 = 0.01;
    let mut scale = 1.0;
    if matches!(scene.start.kind, StartKind::List | StartKind::File) {
        let count = bodies.len() as f64;
        let middle = [0, 1, 2].map(|axis| bodies.iter().map(|(_, at, _)| at[axis] / count).sum::<f64>());
        let offset = |at: &[f64; 3], axis: usize| at[axis] - middle[axis];
        let far = |at: &[f64; 3]| libm::hypot(libm::hypot(offset(at, 0), offset(at, 1)), offset(at, 2));
        let mut distances: Vec<f64> = bodies.iter().map(|(_, at, _)| far(at)).collect();
        distances.sort_by(f64::total_cmp);
        scale = distances.get(distances.len() / 2).copied().unwrap_or(scale);
    }
    scene.softening.max((SMALL * scale).clamp(f64::MIN_POSITIVE, f64::MAX))
}

/// Errors for sums that round more than the direct sum in double precision, which steps that adapt need.
fn without_direct_sum(values: &SceneValues, scene: &NbodyScene) -> Vec<SceneError> {
    let mut errors = vec![];
    let kind = scene.scheme.word();
    let mut refuse = |key: &Key, word: &str, expected: &str| {
        let message = format!(
            "`{}` is \"{word}\", but integrator.kind = \"{kind}\" sums forces pair by pair in double precision",
            key.path()
        );
        errors.push(values.spot(key).error(MistakeKind::Contradiction, message).expecting(expected));
    };
    if !matches!(scene.engine, ForceEngine::Auto | ForceEngine::Reference) {
        refuse(&ENGINE, scene.engine.word(), "\"auto\", \"reference\", or another integrator.kind");
    }
    if scene.precision == Precision::Mixed {
        refuse(&PRECISION, scene.precision.word(), "\"f64\", or another integrator.kind");
    }
    if scene.arithmetic != ArithmeticKind::Exact {
        refuse(&ROOTS, scene.arithmetic.word(), "\"exact\", or another integrator.kind");
    }
    errors
}

/// Errors for fewer than two bodies, or for masses that are not positive.
fn wrong_rows(values: &SceneValues, scene: &NbodyScene) -> Vec<SceneError> {
    let rows = &scene.start.bodies;
    let mut errors = vec![];
    if rows.len() < 2 {
        let message =
            format!("`particles.bodies` lists {}, but one body alone has nothing to attract", rows.len());
        errors.push(values.spot(&BODIES).error(MistakeKind::Range, message).expecting("two bodies or more"));
    }
    for (number, row) in rows.iter().enumerate().filter(|(_, row)| row[0] <= 0.0).take(5) {
        let message = format!("body {} has the mass {:?}", number + 1, row[0]);
        errors.push(
            values.item_spot(&BODIES, number).error(MistakeKind::Range, message).expecting("a mass above 0"),
        );
    }
    errors
}

/// Error for a body so light that its forces vanish in single precision.
fn too_light(values: &SceneValues, particles: &Particles) -> Option<SceneError> {
    let heaviest = particles.all().iter().max_by(|a, b| a.mass.total_cmp(&b.mass))?;
    let lightest = particles.all().iter().min_by(|a, b| a.mass.total_cmp(&b.mass))?;
    if lightest.mass >= LIGHTEST * heaviest.mass {
        return None;
    }
    let message = format!(
        "body {} has the mass {:?}, less than {LIGHTEST:e} times the {:?} of body {}: its forces vanish in single precision",
        lightest.id, lightest.mass, heaviest.mass, heaviest.id
    );
    let error = values.spot(&PRECISION).error(MistakeKind::Contradiction, message);
    Some(error.expecting("machine.precision = \"f64\", or a heavier body"))
}

/// Error for two bodies at one position, whose attraction is infinite without softening.
fn coincident(values: &SceneValues, particles: &Particles) -> Option<SceneError> {
    let mut places: HashMap<[u64; 3], u32> = HashMap::new();
    for (number, body) in particles.all().iter().enumerate() {
        // −0 and 0 are the same position.
        let place = body.position.map(|x| (x + 0.0).to_bits());
        if let Some(first) = places.insert(place, body.id) {
            let [x, y, z] = body.position;
            let message = format!(
                "bodies {first} and {} are both at ({x}, {y}, {z}), and their attraction is not softened",
                body.id
            );
            let spot = if values.is_given(&BODIES) {
                values.item_spot(&BODIES, number)
            } else {
                values.spot(if values.is_given(&FILE) { &FILE } else { &GENERATE })
            };
            let error = spot.error(MistakeKind::Overlap, message);
            return Some(error.advising(format!("set `{}` above 0, or move one of them", SOFTENING.path())));
        }
    }
    None
}
