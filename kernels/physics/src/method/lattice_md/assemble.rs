//! From a checked scene to discs that are stepped.

use super::check::Checked;
use super::model::sides_of;
use super::scene::{By, ProgramText};
use super::{Contacts, Discs, FastSearch, Grains, ListOptions, Machine, Model, Watch};
use crate::method::Failure;
use crate::method::refuse_several_ranks;
use stripmine_kernels::law::granular::Disc;

/// What a checked scene models: no more than it needs.
pub fn model(checked: &Checked) -> Model {
    let Checked { scene, domain, particles, alike, geometry, .. } = checked;
    let factor = scene.law.inertia.factor();
    let is_printed = scene.machine.text == ProgramText::Printed;
    let discs = match particles.grains().first() {
        Some(disc) if *alike && !is_printed => Discs::Equal {
            disc: Disc { radius: disc.radius, inverse_mass: 1.0 / disc.mass },
            inverse_inertia: 1.0 / (factor * disc.mass * disc.radius * disc.radius),
        },
        _ => Discs::Varying,
    };
    Model {
        text: scene.machine.text,
        shape: geometry.shape,
        frame: geometry.frame,
        sides: sides_of(domain, &geometry.shape, &geometry.frame),
        mask: geometry.mask.clone(),
        coordinates: scene.machine.coordinates,
        contact: scene.law.contact,
        friction: scene.law.has_friction() || is_printed,
        discs,
        inertia_factor: factor,
        scheme: scene.integrator.scheme,
        dt: scene.integrator.dt,
        gravity: scene.domain.gravity,
        watch: Some(Watch {
            max_penetration: scene.law.max_penetration,
            stop_penetration: scene.law.stop_penetration,
            smallest_radius: geometry.radii[0],
            on_long_step: scene.integrator.on_long_step,
            energy: false,
            motion: false,
        }),
    }
}

/// How a checked scene has its contacts found.
pub(super) fn contacts(checked: &Checked) -> Contacts {
    let Checked { scene, geometry, .. } = checked;
    let (search, skin) = (&scene.search, geometry.skin);
    match search.by {
        By::Auto | By::Lattice if scene.machine.is_fast() => {
            Contacts::Fast(FastSearch::Lattice(search.on_conflict))
        }
        By::Auto | By::Lattice => Contacts::Lattice,
        By::Sectors => Contacts::Fast(FastSearch::Sectors),
        By::NeighborList if scene.machine.is_fast() => Contacts::Fast(FastSearch::Lists { skin }),
        By::NeighborList => Contacts::Lists(ListOptions { rebuild: search.rebuild, skin }),
    }
}

/// The discs of a checked scene, at the start.
///
/// # Errors
/// [`Failure`] if the start breaks a precondition, or the processor lacks the instruction set asked for.
pub fn assemble(checked: &Checked) -> Result<Grains, Failure> {
    start_of(checked, model(checked))
}

/// The same, with energy followed: what contacts dissipate, what walls put in, periods that discs cross along gravity; and along every
/// axis, where the scene asks for displacements.
///
/// # Errors
/// As [`assemble`].
pub fn assemble_following_energy(checked: &Checked) -> Result<Grains, Failure> {
    start_of(checked, model_following_energy(checked))
}

/// What a checked scene models where energy is followed.
pub(super) fn model_following_energy(checked: &Checked) -> Model {
    let mut model = model(checked);
    let motion = checked.scene.output.follows_motion();
    model.watch = model.watch.map(|watch| Watch { energy: true, motion, ..watch });
    model
}

fn start_of(checked: &Checked, model: Model) -> Result<Grains, Failure> {
    let Checked { scene, particles, .. } = checked;
    if !scene.machine.is_fast() {
        refuse_several_ranks(
            "the source's programs are of whole arrays: machine.engine = \"fast\" has bands",
        )?;
    }
    let contacts = contacts(checked);
    let machine = Machine { execution: scene.machine.execution, set: scene.machine.instructions() };
    Grains::start(scene.machine.precision, model, contacts, machine, scene.walls, particles.clone())
}
