//! Preconditions of a scene, checked with their numbers before it runs.

mod geometry;
mod motion;

pub use geometry::Geometry;
pub use motion::MotionEstimates;
use motion::StepRejection;
pub(super) use motion::{FASTEST, FEWEST_STEPS, LEAST_STEPS, MUCH_LOST, NETWORK, rounding};

use super::choice::{self, SearchChoice};
use super::document::GranularDocument;
use super::keys::{SEARCH, VOCABULARY};
use super::scene::{GranularScene, SearchKind};
use crate::domain::Domain;
use crate::method::compress;
use crate::method::entry::left_out;
use crate::method::lattice_md::wall_checks;
use crate::method::pairwise::PlaneWalls;
use crate::method::pairwise::search::OnConflict;
use crate::particles::{Particle, ParticleKind, Particles};
use crate::scene::{MistakeKind, RADIUS, SceneError, SceneErrors, SceneValues, Warning};
use crate::start::{self, InitialState, StatedStart};
use crate::words::Words;
use std::collections::HashMap;
use std::sync::Arc;
use stripmine_kernels::sweep::lattice::LatticeFrame;

/// Checked scene: its discs, its lattice, and reported properties.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckedGranularScene {
    /// The scene.
    pub scene: GranularScene,
    /// The box.
    pub domain: Domain,
    /// The discs at the start, inside the box.
    pub particles: Particles,
    /// True if all discs have one radius and one mass, and there are no walls.
    pub alike: bool,
    /// Plane walls.
    pub walls: Arc<PlaneWalls>,
    /// The lattice.
    pub geometry: Geometry,
    /// Estimates of the motion.
    pub estimates: MotionEstimates,
    /// Choices that the scene left open, with reasons.
    pub choices: Vec<String>,
    /// Parts that the scene does not need, with reasons.
    pub left_out: Vec<String>,
    /// Warnings about settings that seldom work.
    pub warnings: Vec<Warning>,
}

impl GranularDocument {
    /// Generates the discs and checks the scene against the method's preconditions.
    ///
    /// # Errors
    /// [`SceneErrors`]: every violated precondition.
    pub fn check(self) -> Result<CheckedGranularScene, SceneErrors> {
        check(self, AcceptedSteps::Foreseen)
    }

    /// Checks the scene at any step: reasons to reject the step become warnings, so that predictions of theory can be tested.
    ///
    /// # Errors
    /// [`SceneErrors`]: every violated precondition.
    pub(super) fn check_at_any_step(self) -> Result<CheckedGranularScene, SceneErrors> {
        check(self, AcceptedSteps::Any)
    }
}

impl CheckedGranularScene {
    /// Returns the same scene with the lattice search, whatever search its runs use; none where its discs fit no lattice.
    pub(super) fn on_lattice(&self) -> Option<CheckedGranularScene> {
        let mut scene = self.scene.clone();
        scene.search.by = SearchKind::Lattice;
        let document = GranularDocument { scene, values: SceneValues::without_text(&VOCABULARY) };
        let geometry =
            geometry::fit(&document, &self.domain, self.geometry.radii, self.particles.len()).ok()?;
        Some(CheckedGranularScene { scene: document.scene, geometry, ..self.clone() })
    }
}

/// Accepted steps.
#[derive(Clone, Copy, PartialEq, Eq)]
enum AcceptedSteps {
    /// Steps that theory predicts to be stable.
    Foreseen,
    /// All steps.
    Any,
}

impl GranularScene {
    /// Generates the discs and checks the scene against the method's preconditions.
    ///
    /// # Errors
    /// [`SceneErrors`]: every violated precondition.
    pub fn check(&self) -> Result<CheckedGranularScene, SceneErrors> {
        check(
            GranularDocument { scene: self.clone(), values: SceneValues::without_text(&VOCABULARY) },
            AcceptedSteps::Foreseen,
        )
    }
}

/// Generates the discs of a scene and checks it against every precondition.
fn check(mut document: GranularDocument, steps: AcceptedSteps) -> Result<CheckedGranularScene, SceneErrors> {
    let mut errors = Vec::new();
    let mut choices: Vec<String> = choice::engine(&mut document.scene).into_iter().collect();
    let GranularDocument { scene, values } = &document;
    let segments = scene.plane.segments();
    let stated = StatedStart {
        values,
        domain: &scene.domain,
        start: &scene.start,
        walls: scene.walls,
        barriers: &segments,
        conserved: scene.domain.periodic,
        compress,
    };
    let made = match start::create_initial_state(&stated) {
        Ok(made) => Some(made),
        Err(error) => {
            errors.push(error);
            None
        }
    };
    if let Some(InitialState { domain, particles, .. }) = &made {
        errors.extend(start::outside(&stated, domain, particles));
        let limit = document.scene.law.max_penetration;
        let reason = format!("the limit is law.max_penetration = {limit}");
        errors.extend(start::overlaps(&stated, domain, particles, limit, &reason));
    }
    let walls = made.as_ref().map(|InitialState { domain, particles, .. }| {
        let shapes = wall_checks::shapes(&document, domain, particles);
        let sides = wall_checks::closed_sides(&document.scene, particles);
        let reach = particles.grains().iter().map(|grain| grain.radius).fold(0.0, f64::max);
        let walls = document.scene.plane_walls(domain, reach, sides);
        if shapes.is_empty() {
            errors.extend(wall_checks::cut_discs(&document, domain, &walls, particles));
        }
        errors.extend(shapes);
        Arc::new(walls)
    });
    let walls = walls.unwrap_or_default();
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
    let mut refusals: Vec<StepRejection> = motion::instability(&document).into_iter().collect();
    if let (Some(InitialState { domain, particles, .. }), Some(geometry)) = (&made, &geometry) {
        errors.extend(numbered(&document, particles));
        refusals.extend(motion::long_steps(&document, domain, particles, geometry));
    }
    let mut tolerated: Vec<Warning> = vec![];
    match steps {
        AcceptedSteps::Foreseen => errors.extend(refusals.into_iter().map(|refusal| refusal.error)),
        AcceptedSteps::Any => tolerated.extend(refusals.into_iter().map(Warning::from)),
    }
    SceneErrors::ok_if_empty(errors)?;
    let (Some(InitialState { domain, particles, mut warnings }), Some(geometry)) = (made, geometry) else {
        // A missing part has already reported an error above.
        let error =
            document.values.spot(&RADIUS).error(MistakeKind::Geometry, "there is nothing to simulate");
        return Err(error.into());
    };
    let scene = document.scene;
    let estimates = MotionEstimates::of(&scene, &particles);
    warnings.append(&mut tolerated);
    warnings.extend(wall_checks::gaps(&scene, &domain, &walls, &particles));
    warnings.extend(wall_checks::light_walls(&scene, &domain, &particles));
    warnings.extend(motion::warnings(&scene, &domain, &particles, (&geometry, &walls), &estimates));
    let alike = all_alike(&particles);
    let left_out = not_modelled(&scene, &particles, &walls, alike);
    Ok(CheckedGranularScene {
        walls,
        scene,
        domain,
        particles,
        alike,
        geometry,
        estimates,
        choices,
        left_out,
        warnings,
    })
}

/// Returns the geometry of a scene; with an open search, that of the fastest search that has one.
fn fitted(
    document: &mut GranularDocument,
    domain: &Domain,
    radii: [f64; 2],
    particles: &Particles,
    choices: &mut Vec<String>,
) -> Result<Geometry, Vec<SceneError>> {
    let fit = |document: &GranularDocument| {
        let geometry = geometry::fit(document, domain, radii, particles.len())?;
        let search = &document.scene.search;
        let is_exclusive = search.by == SearchKind::Lattice && search.on_conflict == OnConflict::Stop;
        let shared = is_exclusive.then(|| shared_cell(document, &geometry, particles));
        match shared.flatten() {
            Some(error) => Err(vec![error]),
            None => Ok(geometry),
        }
    };
    if document.scene.search.by != SearchKind::Auto {
        return fit(document);
    }
    let mut first: Option<Vec<SceneError>> = None;
    for SearchChoice { by, reason } in choice::searches(&document.scene, domain, particles) {
        document.scene.search.by = by;
        match fit(document) {
            Ok(geometry) => {
                choices.push(format!("search.by = \"{}\": {reason}", by.word()));
                return Ok(geometry);
            }
            Err(errors) => first = first.or(Some(errors)),
        }
    }
    Err(first.unwrap_or_default())
}

/// Error of two wall discs in one cell of the lattice: they may overlap each other, but not there.
fn shared_cell(
    document: &GranularDocument,
    geometry: &Geometry,
    particles: &Particles,
) -> Option<SceneError> {
    let LatticeFrame { origin, edge } = geometry.frame;
    let walls = &particles.all()[particles.grain_count()..];
    let mut taken = HashMap::with_capacity(walls.len());
    for disc in walls {
        let place = disc.planar_position();
        let cell = [0, 1].map(|axis| ((place[axis] - origin[axis]) / edge[axis]).floor() as i64);
        if let Some(other) = taken.insert(cell, disc.id) {
            let [x, y] = place.map(start::rounded_to_nine_digits);
            let message = format!(
                "wall disc {other} and wall disc {} at ({x}, {y}) are in one cell of the lattice, which holds one disc",
                disc.id
            );
            let error = document.values.spot(&SEARCH).error(MistakeKind::Placement, message);
            return Some(
                error.advising("set search.by = \"sectors\" or \"neighbor-list\", or use [[walls]]"),
            );
        }
    }
    None
}

fn all_alike(particles: &Particles) -> bool {
    let Some(first) = particles.all().first() else { return false };
    let same = |disc: &Particle| {
        disc.kind == ParticleKind::Grain && disc.radius == first.radius && disc.mass == first.mass
    };
    particles.all().iter().all(same)
}

/// Error of more discs than the partners in a fast method's lists have bits for.
fn numbered(document: &GranularDocument, particles: &Particles) -> Option<SceneError> {
    const MOST: usize = (1 << 29) - 3;
    let GranularScene { search, machine, .. } = &document.scene;
    let listed = machine.is_fast() && search.by != SearchKind::Lattice;
    (listed && particles.len() > MOST).then(|| {
        let message =
            format!("{} discs are too many: sectors and fast lists can number {MOST}", particles.len());
        document
            .values
            .spot(&SEARCH)
            .error(MistakeKind::Placement, message)
            .advising("set search.by = \"lattice\", which can number more")
    })
}

/// Parts of the model that the scene does not need.
fn not_modelled(
    scene: &GranularScene,
    particles: &Particles,
    walls: &PlaneWalls,
    alike: bool,
) -> Vec<String> {
    let contact = &scene.law.contact;
    let (rubs, smooth) = (contact.friction > 0.0, !scene.has_friction());
    left_out(&[
        (smooth && !rubs, "friction, spin and torque: law.friction is 0"),
        (smooth && rubs, "friction, spin and torque: law.shear_damping is 0"),
        (contact.normal_damping == 0.0, "normal damping: law.normal_damping is 0"),
        (alike, "radius and mass of each disc: all discs are equal, so these are numbers, not vectors"),
        (scene.domain.gravity == [0.0; 2], "gravity: domain.gravity is 0"),
        (particles.grain_count() == particles.len() && walls.is_empty(), "walls: there are no wall discs"),
        (scene.domain.periodic == [false; 2], "periodic images: both sides are open"),
    ])
}
