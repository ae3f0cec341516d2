//! Preconditions of a scene, checked with their numbers before it runs.

mod geometry;
mod motion;

pub use geometry::Geometry;
pub use motion::Estimates;
use motion::Refusal;
pub(super) use motion::{FASTEST, FEWEST_STEPS, LEAST_STEPS, MUCH_LOST, NETWORK, rounding};

use super::choice::{self, Choice};
use super::document::Document;
use super::keys::{SEARCH, VOCABULARY};
use super::scene::{By, Scene};
use crate::domain::Domain;
use crate::method::compress;
use crate::method::entry::left_out;
use crate::particles::{Kind, Particle, Particles};
use crate::scene::{RADIUS, Reason, SceneError, SceneErrors, Values, Warning};
use crate::start::{self, Made, Stated};
use crate::words::Words;

/// Checked scene: its discs, its lattice, and reported properties.
#[derive(Clone, Debug, PartialEq)]
pub struct Checked {
    /// The scene.
    pub scene: Scene,
    /// The box.
    pub domain: Domain,
    /// The discs at the start, inside the box.
    pub particles: Particles,
    /// True if all discs have one radius and one mass, and there are no walls.
    pub alike: bool,
    /// The lattice.
    pub geometry: Geometry,
    /// Estimates of the motion.
    pub estimates: Estimates,
    /// Choices that the scene left open, with reasons.
    pub choices: Vec<String>,
    /// Parts that the scene does not need, with reasons.
    pub left_out: Vec<String>,
    /// Warnings about settings that seldom work.
    pub warnings: Vec<Warning>,
}

impl Document {
    /// Generates the discs and checks the scene against the method's preconditions.
    ///
    /// # Errors
    /// [`SceneErrors`]: every violated precondition.
    pub fn check(self) -> Result<Checked, SceneErrors> {
        check(self, Steps::Foreseen)
    }

    /// Checks the scene at any step: reasons to reject the step become warnings, so that predictions of theory can be tested.
    ///
    /// # Errors
    /// [`SceneErrors`]: every violated precondition.
    pub(super) fn check_at_any_step(self) -> Result<Checked, SceneErrors> {
        check(self, Steps::Any)
    }
}

impl Checked {
    /// Returns the same scene with the lattice search, whatever search its runs use; none where its discs fit no lattice.
    pub(super) fn on_lattice(&self) -> Option<Checked> {
        let mut scene = self.scene.clone();
        scene.search.by = By::Lattice;
        let document = Document { scene, values: Values::of_no_text(&VOCABULARY) };
        let geometry =
            geometry::fit(&document, &self.domain, self.geometry.radii, self.particles.len()).ok()?;
        Some(Checked { scene: document.scene, geometry, ..self.clone() })
    }
}

/// Accepted steps.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Steps {
    /// Steps that theory predicts to be stable.
    Foreseen,
    /// All steps.
    Any,
}

impl Scene {
    /// Generates the discs and checks the scene against the method's preconditions.
    ///
    /// # Errors
    /// [`SceneErrors`]: every violated precondition.
    pub fn check(&self) -> Result<Checked, SceneErrors> {
        check(Document { scene: self.clone(), values: Values::of_no_text(&VOCABULARY) }, Steps::Foreseen)
    }
}

/// Generates the discs of a scene and checks it against every precondition.
fn check(mut document: Document, steps: Steps) -> Result<Checked, SceneErrors> {
    let mut errors = Vec::new();
    let mut choices: Vec<String> = choice::engine(&mut document.scene).into_iter().collect();
    let Document { scene, values } = &document;
    let stated = Stated { values, domain: &scene.domain, start: &scene.start, walls: scene.walls, compress };
    let made = match start::make(&stated) {
        Ok(made) => Some(made),
        Err(error) => {
            errors.push(error);
            None
        }
    };
    if let Some(Made { domain, particles, .. }) = &made {
        errors.extend(start::outside(&stated, domain, particles));
        let limit = document.scene.law.max_penetration;
        let reason = format!("the limit is law.max_penetration = {limit}");
        errors.extend(start::overlaps(&stated, domain, particles, limit, &reason));
    }
    let radii = made.as_ref().and_then(|made| made.particles.radii());
    let radii = start::radii(&document.scene.start, radii);
    let domain = made.as_ref().map(|made| made.domain).or_else(|| document.scene.domain.stated());
    let count = made.as_ref().map_or(0, |made| made.particles.len());
    let geometry = match (domain, radii) {
        (Some(domain), Some(radii)) => {
            let tried = match &made {
                Some(made) => fitted(&mut document, &domain, radii, &made.particles, &mut choices),
                None => geometry::fit(&document, &domain, radii, count),
            };
            tried.map_err(|more| errors.extend(more)).ok()
        }
        _ => None,
    };
    let mut refusals: Vec<Refusal> = motion::instability(&document).into_iter().collect();
    if let (Some(Made { domain, particles, .. }), Some(geometry)) = (&made, &geometry) {
        errors.extend(numbered(&document, particles));
        refusals.extend(motion::long_steps(&document, domain, particles, geometry));
    }
    let mut tolerated: Vec<Warning> = vec![];
    match steps {
        Steps::Foreseen => errors.extend(refusals.into_iter().map(|refusal| refusal.error)),
        Steps::Any => tolerated.extend(refusals.into_iter().map(Warning::from)),
    }
    SceneErrors::none_of(errors)?;
    let (Some(Made { domain, particles, mut warnings }), Some(geometry)) = (made, geometry) else {
        // A missing part has already reported an error above.
        let error = document.values.spot(&RADIUS).error(Reason::Geometry, "there is nothing to simulate");
        return Err(error.into());
    };
    let scene = document.scene;
    let estimates = Estimates::of(&scene, &particles);
    warnings.append(&mut tolerated);
    warnings.extend(motion::warnings(&scene, &domain, &particles, &geometry, &estimates));
    let alike = all_alike(&particles);
    let left_out = not_modelled(&scene, &particles, alike);
    Ok(Checked { scene, domain, particles, alike, geometry, estimates, choices, left_out, warnings })
}

/// Returns the geometry of a scene; with an open search, that of the fastest search that has one.
fn fitted(
    document: &mut Document,
    domain: &Domain,
    radii: [f64; 2],
    particles: &Particles,
    choices: &mut Vec<String>,
) -> Result<Geometry, Vec<SceneError>> {
    if document.scene.search.by != By::Auto {
        return geometry::fit(document, domain, radii, particles.len());
    }
    let mut first: Option<Vec<SceneError>> = None;
    for Choice { by, reason } in choice::searches(&document.scene, domain, particles) {
        document.scene.search.by = by;
        match geometry::fit(document, domain, radii, particles.len()) {
            Ok(geometry) => {
                choices.push(format!("search.by = \"{}\": {reason}", by.word()));
                return Ok(geometry);
            }
            Err(errors) => first = first.or(Some(errors)),
        }
    }
    Err(first.unwrap_or_default())
}

fn all_alike(particles: &Particles) -> bool {
    let Some(first) = particles.all().first() else { return false };
    let same =
        |disc: &Particle| disc.kind == Kind::Grain && disc.radius == first.radius && disc.mass == first.mass;
    particles.all().iter().all(same)
}

/// Error of more discs than the partners in a fast method's lists have bits for.
fn numbered(document: &Document, particles: &Particles) -> Option<SceneError> {
    const MOST: usize = (1 << 29) - 3;
    let Scene { search, machine, .. } = &document.scene;
    let listed = machine.is_fast() && search.by != By::Lattice;
    (listed && particles.len() > MOST).then(|| {
        let message =
            format!("{} discs are too many: sectors and fast lists can number {MOST}", particles.len());
        document
            .values
            .spot(&SEARCH)
            .error(Reason::Placement, message)
            .advising("set search.by = \"lattice\", which can number more")
    })
}

/// Parts of the model that the scene does not need.
fn not_modelled(scene: &Scene, particles: &Particles, alike: bool) -> Vec<String> {
    let contact = &scene.law.contact;
    let rubs = contact.friction > 0.0;
    left_out(&[
        (!rubs, "friction, spin and torque: law.friction is 0"),
        (rubs && contact.shear_damping == 0.0, "friction, spin and torque: law.shear_damping is 0"),
        (contact.normal_damping == 0.0, "normal damping: law.normal_damping is 0"),
        (alike, "radius and mass of each disc: all discs are equal, so these are numbers, not vectors"),
        (scene.domain.gravity == [0.0; 2], "gravity: domain.gravity is 0"),
        (particles.grain_count() == particles.len(), "walls: there are no wall discs"),
        (scene.domain.periodic == [false; 2], "periodic images: both sides are open"),
    ])
}
