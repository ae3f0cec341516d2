//! From a checked scene to the method that runs it.

use crate::method::lattice_md::{
    Contacts, Discs, GearValues, ListOptions, Machine, Model, OnConflict, Rebuild, Scheme, Search, Watch,
    start,
};
use crate::method::{Failure, Method};
use crate::scene::{self, Checked, MethodKind};
use stripmine_kernels::InstructionSet;
use stripmine_kernels::law::granular::Disc;

/// Skin of neighbour lists where the scene gives none, in largest radii.
const SKIN: f64 = 0.3;

/// Skin of the fast lists (length) where the scene gives none: half of the gap between the discs, were they spread evenly,
/// within bounds. The wider the skin, the longer the lists, and the longer they last.
fn roomy_skin(checked: &Checked) -> f64 {
    let Checked { domain, particles, geometry, .. } = checked;
    let largest = geometry.radii[1];
    let area = domain.sides[0] * domain.sides[1] / particles.len().max(1) as f64;
    // Neighbours on a hexagonal lattice are so far apart.
    let spacing = (area * 2.0 / 3f64.sqrt()).sqrt();
    (0.5 * (spacing - 2.0 * largest)).clamp(SKIN * largest, largest)
}

/// What a checked scene models: no more than it needs.
pub fn model(checked: &Checked) -> Model {
    let Checked { scene, particles, alike, geometry, .. } = checked;
    let factor = scene.law.inertia.factor();
    let discs = match particles.grains().first() {
        Some(disc) if *alike => Discs::Equal {
            disc: Disc { radius: disc.radius, inverse_mass: 1.0 / disc.mass },
            inverse_inertia: 1.0 / (factor * disc.mass * disc.radius * disc.radius),
        },
        _ => Discs::Varying,
    };
    Model {
        shape: geometry.shape,
        frame: geometry.frame,
        mask: geometry.mask.clone(),
        coordinates: scene.method.coordinates,
        contact: scene.law.contact,
        friction: scene.law.has_friction(),
        discs,
        inertia_factor: factor,
        scheme: match scene.integrator.scheme {
            scene::Scheme::Gear { values: 4 } => Scheme::Gear(GearValues::Four),
            scene::Scheme::Gear { values: 5 } => Scheme::Gear(GearValues::Five),
            scene::Scheme::Gear { .. } => Scheme::Gear(GearValues::Six),
            scene::Scheme::VelocityVerlet => Scheme::VelocityVerlet,
        },
        dt: scene.integrator.dt,
        gravity: scene.domain.gravity,
        watch: Some(Watch {
            max_penetration: scene.law.max_penetration,
            stop_penetration: scene.law.stop_penetration,
            smallest_radius: geometry.radii[0],
        }),
    }
}

/// The method of a checked scene, at the start.
///
/// # Errors
/// [`Failure`] if the start breaks a precondition, or the processor lacks the instruction set asked for.
pub fn assemble(checked: &Checked) -> Result<Box<dyn Method>, Failure> {
    let Checked { scene, particles, geometry, .. } = checked;
    let fast = scene.method.execution == scene::Execution::Fast;
    let contacts = match scene.method.kind {
        MethodKind::Lattice if fast => Contacts::Fast(Search::Lattice(match scene.method.on_conflict {
            scene::OnConflict::Stop => OnConflict::Stop,
            scene::OnConflict::Resolve => OnConflict::Resolve,
        })),
        MethodKind::Lattice => Contacts::Lattice,
        MethodKind::Sectors => Contacts::Fast(Search::Sectors),
        MethodKind::NeighborList { skin, .. } if fast => {
            Contacts::Fast(Search::Lists { skin: skin.unwrap_or_else(|| roomy_skin(checked)) })
        }
        MethodKind::NeighborList { rebuild, skin } => Contacts::Lists(ListOptions {
            rebuild: match rebuild {
                scene::Rebuild::Cells => Rebuild::Cells,
                scene::Rebuild::AllPairs => Rebuild::AllPairs,
            },
            skin: skin.unwrap_or(SKIN * geometry.radii[1]),
        }),
    };
    let machine = Machine {
        execution: scene.method.execution.of_programs(),
        set: scene.method.instruction_set.unwrap_or_else(InstructionSet::best),
    };
    let (model, particles) = (model(checked), particles.clone());
    start(scene.method.precision, model, contacts, machine, scene.walls, particles)
}
