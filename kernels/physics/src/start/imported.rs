//! Discs of a start file, completed by the keys of the scene.

use super::StatedStart;
use super::completion::{StartCompletion, warning};
use super::exact_speed::scale_velocities;
use crate::domain::Domain;
use crate::io::start_files::{StartBox, StartFrame, StartQuantity};
use crate::particles::Particle;
use crate::placement::set_gaussian_velocities;
use crate::quoted;
use crate::scene::{
    FILE, Key, MASS, MistakeKind, ORIGIN, PERIODIC, RADIUS, SEED, SIDES, SPEED, SceneError, StartFile,
    TEMPERATURE, Warning,
};

/// Reads the discs of a start file in their box.
///
/// # Errors
/// If the file cannot be read, contradicts a key, or lacks what no key supplies.
pub(super) fn read_start(
    stated: &StatedStart<'_>,
    file: &StartFile,
    warnings: &mut Vec<Warning>,
) -> Result<(Domain, Vec<Particle>), SceneError> {
    let frame = file.read(true).map_err(|error| {
        stated.spot(&FILE).error(MistakeKind::StartFile, format!("the start file cannot be used: {error}"))
    })?;
    let path = quoted::path(file.path());
    if frame.particles.is_empty() {
        let message = format!("the start file {path} contains no disc");
        return Err(stated.spot(&FILE).error(MistakeKind::StartFile, message));
    }
    let domain = box_of(stated, &frame, &path)?;
    if let Some(found) = frame.periodic.filter(|&found| found != domain.periodic()) {
        let message = format!(
            "`domain.periodic` is {:?}, but the start file {path} has pbc = {found:?} along x and y",
            domain.periodic(),
        );
        let error = stated.spot(&PERIODIC).error(MistakeKind::Contradiction, message);
        return Err(error.expecting(format!("periodic = {found:?}")));
    }
    if frame.has_raised_ids {
        warnings.push(warning(
            &FILE,
            "raised-ids",
            format!(
                "ids of the start file {path} begin at 0; each is raised by one, also in all files of the run"
            ),
            "number ids from 1, or subtract 1 to compare particles with those of the start file",
        ));
    }
    let mut discs = frame.particles.all().to_vec();
    if let Some(StartBox { corner, is_movable: true, .. }) = frame.cell {
        for disc in &mut discs {
            (0..2).for_each(|axis| disc.position[axis] += domain.origin[axis] - corner[axis]);
        }
    }
    let complete = StartCompletion {
        values: stated.values,
        frame: &frame,
        path: &path,
        file: &FILE,
        rest: "temperature = 0.0 starts at rest",
    };
    let supplied = file.supplied;
    let speed: &Key = if stated.values.is_given(&SPEED) { &SPEED } else { &TEMPERATURE };
    complete.check(&[
        (StartQuantity::Radius, &RADIUS, supplied.radius.is_some()),
        (StartQuantity::Mass, &MASS, supplied.mass.is_some()),
        (StartQuantity::Velocity, speed, supplied.speed.is_some()),
    ])?;
    let radius = (StartQuantity::Radius, &RADIUS);
    complete.quantity(radius, supplied.radius, &mut discs, warnings, |disc| &mut disc.radius)?;
    complete
        .quantity((StartQuantity::Mass, &MASS), supplied.mass, &mut discs, warnings, |disc| &mut disc.mass)?;
    if frame.has_momenta {
        discs.iter_mut().for_each(|disc| disc.velocity = disc.velocity.map(|p| p / disc.mass));
    }
    match (
        complete.is_supplied((StartQuantity::Velocity, speed), supplied.speed.map(|_| 0.0), warnings)?,
        supplied.speed,
    ) {
        (true, Some(drawn)) => {
            let is_balanced = domain.periodic() == [true; 2] && discs.len() > 1;
            set_gaussian_velocities(&mut discs, supplied.seed, is_balanced, |disc| {
                drawn.deviation(disc.mass)
            });
            if supplied.is_exact {
                scale_velocities(&mut discs, drawn, stated.conserved);
            }
        }
        _ if stated.values.is_given(&SEED) => {
            let message = format!("`{}` has no effect: the start file {path} has velocities", SEED.path());
            return Err(stated.spot(&SEED).error(MistakeKind::Unused, message));
        }
        _ => {}
    }
    Ok((domain, discs))
}

/// Box of the scene, which is that of the file where the scene states none.
fn box_of(stated: &StatedStart<'_>, frame: &StartFrame, path: &str) -> Result<Domain, SceneError> {
    let (here, cell) = match (stated.domain.stated(), frame.cell) {
        (Some(domain), None) => return Ok(domain),
        (Some(domain), Some(cell)) => (domain, cell),
        (None, Some(cell)) => {
            (Domain::planar(stated.domain.origin, cell.sides, stated.domain.periodic), cell)
        }
        (None, None) => {
            let message = format!("`{}` is missing, and the start file {path} has no box", SIDES.path());
            return Err(stated.spot(&SIDES).error(MistakeKind::Missing, message).expecting(SIDES.expected()));
        }
    };
    let corner = if cell.is_movable { here.corner() } else { cell.corner };
    for (found, stated_here, key) in [(cell.sides, here.lengths(), &SIDES), (corner, here.corner(), &ORIGIN)]
    {
        let apart =
            |axis: usize| (found[axis] - stated_here[axis]).abs() > cell.precision * here.length(axis);
        if apart(0) || apart(1) {
            let message = format!(
                "`{}` is {stated_here:?}, but the box of the start file {path} has {found:?}",
                key.path(),
            );
            let error = stated.spot(key).error(MistakeKind::Contradiction, message);
            return Err(error.expecting(format!("{} = {found:?}", key.name)));
        }
    }
    Ok(here)
}
