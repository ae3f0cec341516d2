//! Checks a scene of particles in a bath against the preconditions of the method.

use super::chosen_search::{ChosenSearch, choose_pair_search};
use super::laws::{PairLaw, Parameters, TABLE_FILE};
use super::limits::{CollidingParticles, hardest_collision_energy, lan17_step_bound, step_limits};
use super::scene::LangevinScene;
use crate::domain::Domain;
use crate::method::{Prepared, StepLimit, compress};
use crate::number::significant;
use crate::particles::{Particle, Particles};
use crate::scene::{
    DT, GENERATE, MistakeKind, RADIUS, ReadBinding, SceneError, SceneErrors, SceneValues, WallMotion, Warning,
};
use crate::start::{StatedStart, create_initial_state, noise_seed, outside, overlaps};
use stripmine_kernels::law::potential::PairPotential;
use stripmine_kernels::noise::NoiseSource;

/// Largest pair energy at the start, in ε.
const HIGHEST: f64 = 100.0;

/// Checked scene of Langevin dynamics.
#[derive(Clone)]
pub(super) struct CheckedLangevin {
    pub(super) scene: LangevinScene,
    pub(super) domain: Domain,
    pub(super) particles: Particles,
    /// Diameter σ and mass of every particle (length, mass).
    pub(super) diameter: f64,
    pub(super) mass: f64,
    /// Cut-off (length); the diameter without pairs.
    pub(super) reach: f64,
    pub(super) found: ChosenSearch,
    /// Seed of the noise given by the scene.
    pub(super) seed: u64,
    /// Source of the bath's random numbers.
    pub(super) noise: NoiseSource,
    pub(super) warnings: Vec<Warning>,
    pub(super) choices: Vec<String>,
}

/// Places the particles of a scene and checks every precondition.
///
/// # Errors
/// [`SceneErrors`] with every violated precondition.
pub(super) fn prepare(values: SceneValues) -> Result<Prepared, SceneErrors> {
    Ok(check_langevin_scene(values)?.prepared())
}

/// Checks a scene and returns the method's own representation.
pub(super) fn check_langevin_scene(values: SceneValues) -> Result<CheckedLangevin, SceneErrors> {
    let (mut scene, mut read) = (LangevinScene::default(), ReadBinding::new(&values));
    scene.bind(&mut read);
    read.finish_reading()?;
    let stated = StatedStart {
        values: &values,
        domain: &scene.domain,
        barriers: &[],
        conserved: [scene.bath.friction == 0.0; 2],
        start: &scene.start,
        walls: WallMotion::Fixed,
        compress,
    };
    let made = create_initial_state(&stated)?;
    let (domain, particles) = (made.domain, made.particles);
    let mut errors = outside(&stated, &domain, &particles);
    if scene.law == PairLaw::Table {
        errors.extend(read_table(&values, &mut scene.parameters, &particles).err());
    }
    if scene.law.has_pairs() {
        let diameter = particles.all().first().map_or(1.0, |first| 2.0 * first.radius);
        let deepest = 1.0 - scene.law.nearest(&scene.parameters, diameter, HIGHEST);
        let why = "that near, they would be thrown apart";
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
    let found =
        choose_pair_search(&values, &mut scene, &domain, [diameter, reach], particles.len(), &mut choices);
    let found = match found {
        Ok(found) => found,
        Err(error) => {
            errors.push(error);
            return Err(SceneErrors(errors));
        }
    };
    SceneErrors::ok_if_empty(errors)?;
    let mut warnings = made.warnings;
    warnings.extend(too_long(&scene, diameter, mass));
    let (count, area) = (particles.len(), domain.area());
    warnings.extend(too_short_table(&scene, CollidingParticles { diameter, mass, count, area }));
    // Written into the scene if the start has no seed. Otherwise the noise follows the seed of the start, also if a
    // resolved scene is run again with another one.
    if scene.start.seed().is_none() {
        scene.noise_seed.get_or_insert(1);
    }
    let seed = scene.noise_seed.or(scene.start.seed()).unwrap_or(1);
    let noise = NoiseSource::new(noise_seed(&scene.start, seed, &particles));
    Ok(CheckedLangevin {
        scene,
        domain,
        particles,
        diameter,
        mass,
        reach,
        found,
        seed,
        noise,
        warnings,
        choices,
    })
}

/// Returns the first particle if all particles are equal and mobile.
fn of_one_kind(values: &SceneValues, particles: &Particles) -> Result<Particle, SceneError> {
    let refused = |message: String| values.spot(&RADIUS).error(MistakeKind::Contradiction, message);
    let Some(&first) = particles.all().first() else {
        return Err(refused("there is no particle".to_owned()));
    };
    let walls = particles.len() - particles.grain_count();
    if walls > 0 {
        let error = values
            .spot(&GENERATE)
            .error(MistakeKind::Contradiction, format!("{walls} wall discs, but every particle moves"));
        return Err(error.expecting(
            "generate = \"mesh\", \"random\", \"hexagonal\" or \"list\", or a file without wall discs",
        ));
    }
    let differs = |other: &&Particle| other.radius != first.radius || other.mass != first.mass;
    match particles.all().iter().find(differs) {
        None => Ok(first),
        Some(other) => Err(refused(format!(
            "particle {} has radius {} and mass {}, but particle {} has {} and {}: all particles in a bath must be equal",
            first.id, first.radius, first.mass, other.id, other.radius, other.mass
        ))
        .expecting("one radius and one mass, no radius_spread")),
    }
}

/// Reads the table of the pair law.
fn read_table(
    values: &SceneValues,
    parameters: &mut Parameters,
    particles: &Particles,
) -> Result<(), SceneError> {
    let refused = |message: String| {
        let error = values.spot(&TABLE_FILE).error(MistakeKind::StartFile, message);
        error.advising("correct the table, or name another one")
    };
    let Parameters { table, strength, .. } = parameters;
    table.read(*strength).map_err(|error| refused(format!("the table cannot be used: {error}")))?;
    let [first, _] = table.potential.ends();
    match particles.all().first().map(|particle| 2.0 * particle.radius) {
        Some(diameter) if first > diameter => {
            let message =
                format!("the table begins at r = {first}, beyond the diameter {diameter} of the particles");
            Err(refused(message)
                .expecting(format!("a first row at r <= {diameter}, or particles.radius >= {}", 0.5 * first)))
        }
        _ => Ok(()),
    }
}

/// Warning for a table that ends below the energy of collisions.
fn too_short_table(scene: &LangevinScene, particles: CollidingParticles) -> Option<Warning> {
    let potential = &scene.parameters.table.potential;
    let first = potential.ends()[0];
    let (reached, needed) =
        (potential.energy(first), scene.bath.temperature * hardest_collision_energy(scene, particles));
    (scene.law == PairLaw::Table && first > 0.0 && reached < needed).then(|| Warning {
        check: "table-begins-late",
        share: if reached > 0.0 { needed / reached } else { f64::INFINITY },
        is_refusal: false,
        key: TABLE_FILE.path(),
        message: format!(
            "the table begins at r = {first} with an energy of {}, but the hardest collision has about {}: particles that come nearer are lost",
            significant(reached, 3),
            significant(needed, 3)
        ),
        suggestion: "add rows at smaller distances".to_owned(),
    })
}

/// Warning for a step beyond LAN17's bound.
fn too_long(scene: &LangevinScene, diameter: f64, mass: f64) -> Option<Warning> {
    let (step, _) = lan17_step_bound(scene, diameter, mass);
    (scene.law.has_pairs() && scene.dt > step).then(|| Warning {
        check: "source-bound",
        share: scene.dt / step,
        is_refusal: false,
        key: DT.path(),
        message: format!(
            "dt = {} is beyond √(2 m r_c/F) = {step}, in which a particle crosses the cut-off: particles will be lost",
            scene.dt
        , step = significant(step, 5)),
        suggestion: format!("set integrator.dt to at most {}", significant(0.1 * step, 2)),
    })
}

impl CheckedLangevin {
    /// True if particles exert pair forces.
    pub(super) fn has_pairs(&self) -> bool {
        self.scene.law.has_pairs()
    }

    /// Stability limits of the step.
    pub(super) fn limits(&self) -> Vec<StepLimit> {
        let (diameter, mass) = (self.diameter, self.mass);
        let (count, area) = (self.particles.len(), self.domain.area());
        step_limits(&self.scene, CollidingParticles { diameter, mass, count, area })
    }
}
