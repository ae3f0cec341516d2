//! A scene of particles in a bath, held against what the method demands.

use super::found::{Found, found};
use super::limits::{Colliding, bound, step_limits};
use super::scene::Scene;
use crate::domain::Domain;
use crate::method::{Prepared, StepLimit, compress};
use crate::number::significant;
use crate::particles::{Particle, Particles};
use crate::scene::{
    DT, GENERATE, RADIUS, Read, Reason, SceneError, SceneErrors, Values, WallMotion, Warning,
};
use crate::start::{Stated, make, noise_seed, outside, overlaps};
use stripmine_kernels::noise::NoiseSource;

/// Particles may start as near as their potential is so many ε.
const HIGHEST: f64 = 100.0;

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
    /// Seed of the noise, as the scene says.
    pub(super) seed: u64,
    /// Numbers that the bath draws.
    pub(super) noise: NoiseSource,
    pub(super) warnings: Vec<Warning>,
    pub(super) choices: Vec<String>,
}

/// Makes the particles of a scene and holds it against every precondition.
///
/// # Errors
/// [`SceneErrors`]: every precondition that does not hold.
pub(super) fn prepare(values: Values) -> Result<Prepared, SceneErrors> {
    Ok(checked(values)?.prepared())
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
    if scene.law.has_pairs() {
        let deepest = 1.0 - scene.law.nearest(&scene.parameters, HIGHEST);
        let why = "so near they would be thrown apart";
        errors.extend(overlaps(&stated, &domain, &particles, deepest, why));
    }
    let first = match of_one_kind(&values, &particles) {
        Ok(first) => first,
        Err(error) => {
            errors.push(error);
            return Err(SceneErrors(errors));
        }
    };
    let (diameter, mass) = (2.0 * first.radius, first.mass);
    let reach = scene.law_at(diameter).cutoff();
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
    let noise = NoiseSource::new(noise_seed(&scene.start, seed, &particles));
    Ok(Checked { scene, domain, particles, diameter, mass, reach, found, seed, noise, warnings, choices })
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
    (scene.law.has_pairs() && scene.dt > step).then(|| Warning {
        check: "source-bound",
        share: scene.dt / step,
        is_refusal: false,
        key: DT.path(),
        message: format!(
            "dt = {} is beyond √(2 m r_c/F) = {step}, in which a particle crosses the cut-off: particles will be lost",
            scene.dt
        , step = significant(step, 5)),
        suggestion: format!("take a step of at most {}", significant(0.1 * step, 2)),
    })
}

impl Checked {
    /// Whether particles act on each other.
    pub(super) fn has_pairs(&self) -> bool {
        self.scene.law.has_pairs()
    }

    /// What bounds the step.
    pub(super) fn limits(&self) -> Vec<StepLimit> {
        let (diameter, mass) = (self.diameter, self.mass);
        let (count, area) = (self.particles.len(), self.domain.area());
        step_limits(&self.scene, Colliding { diameter, mass, count, area })
    }
}
