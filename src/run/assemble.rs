//! From a checked scene to the method that runs it.

use crate::method::lattice_md::{
    Contacts, Discs, GearValues, ListOptions, Machine, Model, OnConflict, OnLongStep, Rebuild, Scheme,
    Search, Watch, start,
};
use crate::method::{Failure, Method};
use crate::scene::{self, Checked, MethodKind};
use stripmine_kernels::InstructionSet;
use stripmine_kernels::law::granular::Disc;

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
            on_long_step: match scene.integrator.on_long_step {
                scene::OnLongStep::Stop => OnLongStep::Stop,
                scene::OnLongStep::Count => OnLongStep::Count,
            },
            energy: false,
        }),
    }
}

/// How a checked scene has its contacts found.
pub(super) fn contacts(checked: &Checked) -> Contacts {
    let Checked { scene, geometry, .. } = checked;
    let fast = scene.method.execution == scene::Execution::Fast;
    match scene.method.kind {
        MethodKind::Lattice if fast => Contacts::Fast(Search::Lattice(match scene.method.on_conflict {
            scene::OnConflict::Stop => OnConflict::Stop,
            scene::OnConflict::Resolve => OnConflict::Resolve,
        })),
        MethodKind::Lattice => Contacts::Lattice,
        MethodKind::Sectors => Contacts::Fast(Search::Sectors),
        MethodKind::NeighborList { .. } if fast => Contacts::Fast(Search::Lists { skin: geometry.skin }),
        MethodKind::NeighborList { rebuild, .. } => Contacts::Lists(ListOptions {
            rebuild: match rebuild {
                scene::Rebuild::Cells => Rebuild::Cells,
                scene::Rebuild::AllPairs => Rebuild::AllPairs,
            },
            skin: geometry.skin,
        }),
    }
}

/// The method of a checked scene, at the start.
///
/// # Errors
/// [`Failure`] if the start breaks a precondition, or the processor lacks the instruction set asked for.
pub fn assemble(checked: &Checked) -> Result<Box<dyn Method>, Failure> {
    start_of(checked, model(checked))
}

/// The same, with energy followed: what contacts dissipate, what walls put in, periods that discs cross along gravity.
///
/// # Errors
/// As [`assemble`].
pub fn assemble_following_energy(checked: &Checked) -> Result<Box<dyn Method>, Failure> {
    start_of(checked, model_following_energy(checked))
}

/// What a checked scene models where energy is followed.
pub(super) fn model_following_energy(checked: &Checked) -> Model {
    let mut model = model(checked);
    model.watch = model.watch.map(|watch| Watch { energy: true, ..watch });
    model
}

fn start_of(checked: &Checked, model: Model) -> Result<Box<dyn Method>, Failure> {
    let Checked { scene, particles, .. } = checked;
    let contacts = contacts(checked);
    let machine = Machine {
        execution: scene.method.execution.of_programs(),
        set: scene.method.instruction_set.unwrap_or_else(InstructionSet::best),
    };
    start(scene.method.precision, model, contacts, machine, scene.walls, particles.clone())
}
