//! Bodies of a start file, completed by the keys of the scene.

use super::keys::{FILE, MASS, SEED, VIRIAL};
use super::scene::NbodyScene;
use super::starts::{InitialBody, stir};
use crate::io::start_files::{StartFrame, StartQuantity};
use crate::particles::ParticleKind;
use crate::quoted;
use crate::scene::{MistakeKind, SceneError, SceneValues, Warning};
use crate::start::StartCompletion;

/// Reads the bodies of a start file with their ids.
///
/// # Errors
/// If the file cannot be read, or lacks what no key supplies.
pub(super) fn bodies_of_file(
    values: &SceneValues,
    scene: &NbodyScene,
    warnings: &mut Vec<Warning>,
) -> Result<(Vec<u32>, Vec<InitialBody>), SceneError> {
    let file = &scene.start.file;
    let wrong = |message: String| values.spot(&FILE).error(MistakeKind::StartFile, message);
    let frame: StartFrame =
        file.read(false).map_err(|error| wrong(format!("the start file cannot be used: {error}")))?;
    let path = quoted::path(file.path());
    let mut bodies = frame.particles.all().to_vec();
    if bodies.len() < 2 {
        let message = format!("the start file {path} has {} bodies", bodies.len());
        return Err(wrong(message).expecting("two bodies or more"));
    }
    if let Some(wall) = bodies.iter().find(|body| body.kind == ParticleKind::Wall) {
        let message =
            format!("particle {} of the start file {path} is a wall disc; expected bodies only", wall.id);
        return Err(wrong(message).advising("rename its species W, or remove it"));
    }
    let completion = StartCompletion {
        values,
        frame: &frame,
        path: &path,
        file: &FILE,
        rest: "virial = 0.0 starts at rest",
    };
    completion.check(&[
        (StartQuantity::Mass, &MASS, file.supplied.mass.is_some()),
        (StartQuantity::Velocity, &VIRIAL, scene.start.file_virial.is_some()),
    ])?;
    completion.quantity((StartQuantity::Mass, &MASS), file.supplied.mass, &mut bodies, warnings, |body| {
        &mut body.mass
    })?;
    if frame.has_momenta {
        bodies.iter_mut().for_each(|body| body.velocity = body.velocity.map(|p| p / body.mass));
    }
    let is_drawn =
        completion.is_supplied((StartQuantity::Velocity, &VIRIAL), scene.start.file_virial, warnings)?;
    let ids = bodies.iter().map(|body| body.id).collect();
    let mut all: Vec<InitialBody> =
        bodies.iter().map(|body| (body.mass, body.position, body.velocity)).collect();
    if let (true, Some(virial)) = (is_drawn, scene.start.file_virial) {
        stir(&mut all, [virial, scene.softening, scene.gravitational_constant], scene.start.seed);
    } else if values.is_given(&SEED) {
        let message = format!("`{}` has no effect: the start file {path} has velocities", SEED.path());
        return Err(values.spot(&SEED).error(MistakeKind::Unused, message));
    }
    Ok((ids, all))
}
