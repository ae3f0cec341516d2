//! Assembly of a checked scene into a model and its discs.

use super::check::CheckedGranularScene;
use super::model::sides_of;
use super::scene::{ProgramVersion, SearchKind};
use super::{
    ContactSearch, ContactWatch, DiscUniformity, FastSearch, GranularModel, ListOptions, ProgramExecution,
    SteppedGrains,
};
use crate::method::PhysicsFailure;
use crate::method::reject_several_ranks;
use stripmine_kernels::law::granular::EqualDiscs;

/// Returns the model of a checked scene, without the parts that it does not need.
pub fn model(checked: &CheckedGranularScene) -> GranularModel {
    let CheckedGranularScene { scene, domain, particles, alike, geometry, .. } = checked;
    let factor = scene.law.inertia.factor();
    let is_printed = scene.machine.text == ProgramVersion::Printed;
    let discs = match particles.grains().first() {
        Some(disc) if *alike && !is_printed => DiscUniformity::Equal {
            disc: EqualDiscs { radius: disc.radius, inverse_mass: 1.0 / disc.mass },
            inverse_inertia: 1.0 / (factor * disc.mass * disc.radius * disc.radius),
        },
        _ => DiscUniformity::Varying,
    };
    GranularModel {
        text: scene.machine.text,
        shape: geometry.shape,
        frame: geometry.frame,
        sides: sides_of(domain, &geometry.shape, &geometry.frame),
        mask: geometry.mask.clone(),
        coordinates: scene.machine.coordinates,
        contact: scene.law.contact,
        walls: checked.walls.clone(),
        lines: scene.plane.lines.clone(),
        friction: scene.has_friction() || is_printed,
        discs,
        inertia_factor: factor,
        scheme: scene.integrator.scheme,
        dt: scene.integrator.dt,
        gravity: scene.domain.gravity,
        watch: Some(ContactWatch {
            max_penetration: scene.law.max_penetration,
            stop_penetration: scene.law.stop_penetration,
            smallest_radius: geometry.radii[0],
            on_long_step: scene.integrator.on_long_step,
            energy: false,
            motion: false,
        }),
    }
}

/// Returns the contact search of a checked scene.
pub(super) fn contacts(checked: &CheckedGranularScene) -> ContactSearch {
    let CheckedGranularScene { scene, geometry, .. } = checked;
    let (search, skin) = (&scene.search, geometry.skin);
    match search.by {
        SearchKind::Auto | SearchKind::Lattice if scene.machine.is_fast() => {
            ContactSearch::Fast(FastSearch::Lattice(search.on_conflict))
        }
        SearchKind::Auto | SearchKind::Lattice => ContactSearch::Lattice,
        SearchKind::Sectors => ContactSearch::Fast(FastSearch::Sectors),
        SearchKind::NeighborList if scene.machine.is_fast() => {
            ContactSearch::Fast(FastSearch::Lists { skin })
        }
        SearchKind::NeighborList => ContactSearch::Lists(ListOptions { rebuild: search.rebuild, skin }),
    }
}

/// Builds the discs of a checked scene at the start.
///
/// # Errors
/// [`PhysicsFailure`] if the start violates a precondition, or the processor lacks the requested instruction set.
pub fn assemble(checked: &CheckedGranularScene) -> Result<SteppedGrains, PhysicsFailure> {
    started_grains(checked, model(checked))
}

/// Builds the discs of a checked scene and tracks energy: dissipation, wall work, and periods crossed along gravity; and along every axis if the
/// scene asks for displacements.
///
/// # Errors
/// As [`assemble`].
pub fn assemble_following_energy(checked: &CheckedGranularScene) -> Result<SteppedGrains, PhysicsFailure> {
    started_grains(checked, model_following_energy(checked))
}

/// Returns the model of a checked scene that tracks energy.
pub(super) fn model_following_energy(checked: &CheckedGranularScene) -> GranularModel {
    let mut model = model(checked);
    let motion = checked.scene.output.follows_motion();
    model.watch = model.watch.map(|watch| ContactWatch { energy: true, motion, ..watch });
    model
}

fn started_grains(
    checked: &CheckedGranularScene,
    model: GranularModel,
) -> Result<SteppedGrains, PhysicsFailure> {
    let CheckedGranularScene { scene, particles, .. } = checked;
    if !scene.machine.is_fast() {
        reject_several_ranks(
            "BP93's programs act on whole arrays; only machine.engine = \"fast\" has bands",
        )?;
    }
    if !model.walls.is_empty() || !model.lines.is_empty() {
        reject_several_ranks(
            "plane walls, closed sides included, and lines that count grains are those of one rank",
        )?;
    }
    let contacts = contacts(checked);
    let machine = ProgramExecution { execution: scene.machine.execution, set: scene.machine.instructions() };
    SteppedGrains::start(scene.machine.precision, model, contacts, machine, scene.walls, particles.clone())
}
