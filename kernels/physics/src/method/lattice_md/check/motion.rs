//! Checks that the integrator resolves the motion: damping, contacts, depths.

use super::Geometry;
use crate::domain::Domain;
use crate::method::lattice_md::document::GranularDocument;
use crate::method::lattice_md::keys::{FRICTION, SHEAR_DAMPING, STIFFNESS};
use crate::method::lattice_md::model::{GearValues, GranularScheme, OnLongStep};
use crate::method::lattice_md::scene::{GranularScene, Integrator};
use crate::method::lattice_md::theory::contact::HeadOn;
use crate::method::lattice_md::theory::step_matrix::largest_step;
use crate::method::pairwise::PlaneWalls;
use crate::number::significant;
use crate::particles::{Particle, Particles, longest_step};
use crate::scene::{
    DT, GRAVITY, INSTRUCTION_SET, Key, MistakeKind, PERIODIC, PRECISION, Precision, SceneError, WallMotion,
    Warning,
};
use crate::start::disc_noun;
use serde::Serialize;
use stripmine_kernels::sweep::lattice::Coordinates;

/// Estimates of the motion from the start alone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MotionEstimates {
    /// Typical speed of approach (length/time): the largest of √2 times the root mean square speed, the speed of a fall through a radius, and the
    /// speed of the walls.
    pub(crate) approach_speed: f64,
    /// Duration of an undamped contact at that speed (time); none if nothing moves.
    pub contact_duration: Option<f64>,
    /// Duration of that contact in time steps.
    pub(crate) steps_per_contact: Option<f64>,
    /// Depth of such a contact, as a fraction of the sum of the radii.
    pub(crate) impact_penetration: f64,
    /// Depth to which a grain's own weight presses it into another, as a fraction of its radius.
    pub(crate) resting_depth: f64,
    /// γ_N dt: damping of a single contact.
    pub damping: f64,
    /// 3 γ_N dt: damping in a dense network of contacts.
    pub(crate) network_damping: f64,
    /// Largest stable damping of the integrator.
    pub(crate) damping_limit: f64,
}

/// Largest γ dt for which a scheme is stable for pure drag: 0.545, 0.300 and 0.163 with Gear's 4, 5 and 6 values. Capped at 1, because longer steps
/// reverse a velocity, though velocity Verlet is stable up to 2.
fn damping_limit(scheme: GranularScheme) -> f64 {
    largest_step(scheme, 0.0, 1.0).unwrap_or(1.0).min(1.0)
}

fn scheme_in_words(scheme: GranularScheme) -> String {
    match scheme {
        GranularScheme::Gear(values) => format!("Gear's scheme of {} values", values.count()),
        GranularScheme::VelocityVerlet => "velocity Verlet".to_owned(),
    }
}

/// Largest damping of a disc in a dense network of contacts, in units of γ_N.
pub(in crate::method::lattice_md) const NETWORK: f64 = 3.0;

/// Recommended number of steps in a contact: `pipe` has 17, and half its dt changes no statistics.
pub(in crate::method::lattice_md) const LEAST_STEPS: f64 = 15.0;

/// Minimum number of steps in a contact. With fewer, a collision changes the energy by tens of percent. At this number the change is 15 (Gear of 4
/// values), 18 (5), 9 (6) and 1 % (velocity Verlet).
pub(in crate::method::lattice_md) const FEWEST_STEPS: f64 = 3.0;

/// Speed of the fastest approach over the typical one.
pub(in crate::method::lattice_md) const FASTEST: f64 = 3.0;

impl MotionEstimates {
    /// Estimates for a scene and its discs.
    pub(in crate::method::lattice_md) fn of(scene: &GranularScene, particles: &Particles) -> MotionEstimates {
        let grains = particles.grains();
        let number = grains.len().max(1) as f64;
        let square: f64 =
            grains.iter().map(|disc| disc.velocity.iter().map(|v| v * v).sum::<f64>()).sum::<f64>() / number;
        let mass = grains.iter().map(|disc| disc.mass).fold(f64::INFINITY, f64::min);
        let heaviest = grains.iter().map(|disc| disc.mass).fold(0.0, f64::max);
        let radius = grains.iter().map(|disc| disc.radius).fold(f64::INFINITY, f64::min);
        let [gx, gy] = scene.domain.gravity;
        let gravity = gx.hypot(gy);
        let walls = match scene.walls {
            WallMotion::Fixed => 0.0,
            WallMotion::Oscillating { amplitude: [ax, ay], frequency } => {
                std::f64::consts::TAU * frequency * ax.hypot(ay)
            }
        };
        let planes = scene.plane.list.iter().map(|wall| wall.motion.fastest()).fold(0.0, f64::max);
        let fall = (2.0 * gravity * radius).sqrt();
        let speed = (2.0 * square).sqrt().max(fall).max(walls).max(planes);
        let law = scene.law.contact;
        let contact = HeadOn { law, speed, effective_mass: 0.5 * mass };
        let duration = (speed > 0.0).then(|| contact.duration());
        let [normal_damping, _] = scene.dampings();
        let damping = normal_damping * scene.integrator.dt;
        MotionEstimates {
            approach_speed: speed,
            contact_duration: duration,
            steps_per_contact: duration.map(|duration| duration / scene.integrator.dt),
            impact_penetration: contact.depth() / (2.0 * radius),
            resting_depth: law.depth_under(heaviest * gravity) / radius,
            damping,
            network_damping: NETWORK * damping,
            damping_limit: damping_limit(scene.integrator.scheme),
        }
    }
}

/// Reason to reject a scene's step.
pub(super) struct StepRejection {
    check: &'static str,
    share: f64,
    key: &'static Key,
    /// Message for the user.
    pub(super) error: SceneError,
}

impl From<StepRejection> for Warning {
    fn from(StepRejection { check, share, key, error }: StepRejection) -> Warning {
        let suggestion = error.expected.unwrap_or_default();
        Warning { check, share, is_refusal: true, key: key.path(), message: error.message, suggestion }
    }
}

/// Rejects a damping at which even a single contact is unstable.
pub(super) fn instability(document: &GranularDocument) -> Option<StepRejection> {
    let scene = &document.scene;
    let Integrator { dt, scheme, .. } = scene.integrator;
    let ([gamma, _], limit) = (scene.dampings(), damping_limit(scheme));
    let name = scheme_in_words(scheme);
    (gamma * dt > limit).then(|| {
        let message = format!(
            "unstable: normal_damping·dt = {gamma}·{dt} = {} for a single contact, but {name} is stable below \
             about {limit:.2}",
            significant(gamma * dt, 4)
        );
        let error = document.values.spot(&DT).error(MistakeKind::Stability, message);
        let error = error
            .expecting(format!("dt below {} (time), {} where packings are dense", significant(limit / gamma, 5), significant({
                limit / (NETWORK * gamma)
            }, 5)))
            .advising(match scheme {
                GranularScheme::Gear(GearValues::Four) | GranularScheme::VelocityVerlet => "lower dt or law.normal_damping",
                _ => "lower dt or law.normal_damping, or use fewer Gear values",
            });
        StepRejection { check: "damping of a contact", share: gamma * dt / limit, key: &DT, error }
    })
}

/// Rejects steps too long for the discs at the start: discs would pass through each other undetected, collide in too few steps, or lose their motion
/// to rounding.
pub(super) fn long_steps(
    document: &GranularDocument,
    domain: &Domain,
    particles: &Particles,
    geometry: &Geometry,
) -> Vec<StepRejection> {
    let scene = &document.scene;
    let dt = scene.integrator.dt;
    let estimates = MotionEstimates::of(scene, particles);
    let mut refusals = Vec::new();
    let speed = |disc: &Particle| disc.velocity[0].hypot(disc.velocity[1]);
    let fastest = particles.all().iter().max_by(|a, b| speed(a).total_cmp(&speed(b)));
    let limit = longest_step(geometry.radii[0], scene.law.max_penetration);
    if let Some(disc) = fastest
        && scene.integrator.on_long_step == OnLongStep::Stop
        && speed(disc) * dt > limit
    {
        let (what, speed) = (disc_noun(disc.kind), speed(disc));
        let message = format!(
            "{what} {} moves at {speed}, {} in a step; beyond {limit}, contacts deeper than law.max_penetration = {} \
             could be missed between two steps",
            disc.id,
            significant(speed * dt, 5),
            scene.law.max_penetration,
            speed = significant(speed, 5),
            limit = significant(limit, 5)
        );
        let error = document.values.spot(&DT).error(MistakeKind::Stability, message);
        let error = error.expecting(format!("dt below {} (time)", significant(limit / speed, 5))).advising(
            "lower dt, slow the discs, or count such steps instead: integrator.on_long_step = \"count\"",
        );
        refusals.push(StepRejection { check: "mask", share: speed * dt / limit, key: &DT, error });
    }
    if let (Some(steps), Some(duration)) = (estimates.steps_per_contact, estimates.contact_duration)
        && steps < FEWEST_STEPS
    {
        let message = format!(
            "a contact at speed {} lasts {duration}, {steps:.2} steps: with fewer than {FEWEST_STEPS} a collision \
             changes the energy by tens of percent, up or down",
            significant(estimates.approach_speed, 5),
            duration = significant(duration, 5)
        );
        let error = document.values.spot(&DT).error(MistakeKind::Stability, message);
        let error = error.expecting(format!(
            "dt below {} (time), and below {} for {LEAST_STEPS} steps a contact",
            significant(duration / FEWEST_STEPS, 5),
            significant(duration / LEAST_STEPS, 5)
        ));
        refusals.push(StepRejection {
            check: "3 steps a contact",
            share: FEWEST_STEPS / steps,
            key: &DT,
            error,
        });
    }
    if let Some((rounding, step)) = lost_motion(scene, domain, geometry, &estimates)
        && rounding > MOST_LOST * step
    {
        let absolute = are_absolute(scene);
        let message = format!(
            "positions in single precision, {}, are rounded by up to {rounding}, but a typical step is {step}: \
             discs would move by wrong distances or not at all",
            if absolute { "measured from the origin" } else { "measured from the cells' centres" },
            rounding = significant(rounding, 2),
            step = significant(step, 2)
        );
        let error = document.values.spot(&PRECISION).error(MistakeKind::Geometry, message);
        let error = error
            .expecting(format!("steps longer than {} (length)", significant(rounding / MOST_LOST, 2)))
            .advising(match absolute {
                true => {
                    "set machine.coordinates = \"cell-relative\", or machine.precision = \"mixed\" or \"f64\""
                }
                false => "set machine.precision = \"mixed\" or \"f64\"",
            });
        let share = rounding / (MOST_LOST * step);
        refusals.push(StepRejection { check: "lost motion", share, key: &PRECISION, error });
    }
    refusals
}

/// Largest ratio of rounding to step: beyond it scenes are rejected, because most discs would not move.
const MOST_LOST: f64 = 1.0;

/// Ratio of rounding to step beyond which users are warned. Errors of up to ± r of a displacement of mean square s²/2 along an axis add a
/// fraction 2 r²/(3 s²) to its mean square: 6 % here.
pub(in crate::method::lattice_md) const MUCH_LOST: f64 = 0.3;

/// True if the state's positions are measured from the origin.
fn are_absolute(scene: &GranularScene) -> bool {
    !scene.machine.is_fast() && scene.machine.coordinates == Coordinates::Absolute
}

/// Largest rounding of a position in a step, and typical step (length); none unless the state is in single precision and something moves.
fn lost_motion(
    scene: &GranularScene,
    domain: &Domain,
    geometry: &Geometry,
    estimates: &MotionEstimates,
) -> Option<(f64, f64)> {
    let typical = estimates.approach_speed / std::f64::consts::SQRT_2 * scene.integrator.dt;
    (typical > 0.0).then_some((rounding(scene, domain, geometry)?, typical))
}

/// Largest rounding of a position (length), if the state is in single precision.
pub(in crate::method::lattice_md) fn rounding(
    scene: &GranularScene,
    domain: &Domain,
    geometry: &Geometry,
) -> Option<f64> {
    let farthest = |axis: usize| match are_absolute(scene) {
        true => domain.origin[axis].abs() + domain.length(axis),
        false => 0.5 * geometry.widest_cell[axis],
    };
    let is_single = scene.machine.precision == Precision::F32;
    is_single.then(|| 0.5 * f64::from(f32::EPSILON) * farthest(0).max(farthest(1)))
}

/// Returns warnings about settings that seldom work.
pub(super) fn warnings(
    scene: &GranularScene,
    domain: &Domain,
    particles: &Particles,
    (geometry, walls): (&Geometry, &PlaneWalls),
    estimates: &MotionEstimates,
) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let mut warn = |check: &'static str, share: f64, key: &Key, message: String, suggestion: String| {
        warnings.push(Warning { check, share, is_refusal: false, key: key.path(), message, suggestion });
    };
    let contact = &scene.law.contact;
    let rubs = scene.has_friction();
    if !rubs && contact.friction > 0.0 {
        let why = "law.friction bounds a shear force that law.shear_damping = 0 makes zero".to_owned();
        warn(
            "no friction",
            f64::INFINITY,
            &FRICTION,
            why,
            "raise law.shear_damping, or set law.friction = 0".to_owned(),
        );
    } else if !rubs && contact.shear_damping > 0.0 {
        let why = "law.shear_damping has no effect while law.friction is 0".to_owned();
        warn(
            "no friction",
            f64::INFINITY,
            &SHEAR_DAMPING,
            why,
            "raise law.friction, or set law.shear_damping = 0".to_owned(),
        );
    }
    depth_warnings(scene, domain, particles, estimates, &mut warn);
    let [gx, gy] = scene.domain.gravity;
    let has_no_walls = particles.grain_count() == particles.len() && walls.is_empty();
    if (gx != 0.0 || gy != 0.0) && has_no_walls {
        let why = "there is gravity but there are no walls: discs fall forever, or out of the box".to_owned();
        warn(
            "no walls",
            f64::INFINITY,
            &GRAVITY,
            why,
            "add walls, or set domain.gravity = [0, 0]".to_owned(),
        );
    }
    // Along an open side a grain without collisions leaves the box before the run ends.
    let time = scene.duration();
    let leaves = |grain: &Particle| {
        (0..2).filter(|&axis| !domain.is_periodic(axis)).any(|axis| {
            let displacement = time * (grain.velocity[axis] + 0.5 * scene.domain.gravity[axis] * time);
            !(0.0..=domain.length(axis))
                .contains(&(grain.position[axis] - domain.origin[axis] + displacement))
        })
    };
    if has_no_walls && particles.grains().iter().any(leaves) {
        let why = "sides that are not periodic do not confine discs, and there are no wall discs: a grain that leaves the box ends the run";
        let what = "set domain.closed_sides = \"wall\", make them periodic, or line them with wall discs (particles.wall_positions)";
        warn("open sides", f64::INFINITY, &PERIODIC, why.to_owned(), what.to_owned());
    }
    if let Some((rounding, step)) = lost_motion(scene, domain, geometry, estimates)
        && rounding > MUCH_LOST * step
    {
        let message = format!(
            "positions in single precision are rounded by up to {rounding}, {} of a typical step",
            significant(rounding / step, 2),
            rounding = significant(rounding, 2)
        );
        warn(
            "rounding",
            rounding / (MUCH_LOST * step),
            &PRECISION,
            message,
            "use \"mixed\" or \"f64\"".to_owned(),
        );
    }
    if let Some(set) = scene.machine.instruction_set.filter(|set| !set.is_available()) {
        let message = format!("this processor has no {}", set.name());
        warn("instruction set", f64::INFINITY, &INSTRUCTION_SET, message, "use \"auto\"".to_owned());
    }
    warnings
}

fn depth_warnings(
    scene: &GranularScene,
    domain: &Domain,
    particles: &Particles,
    estimates: &MotionEstimates,
    warn: &mut impl FnMut(&'static str, f64, &Key, String, String),
) {
    let law = &scene.law.contact;
    // Contacts deeper than law.max_penetration are counted, and exact; at law.stop_penetration the run ends.
    let stop = scene.law.stop_penetration;
    let deepest = estimates.impact_penetration * law.depth_of_faster(FASTEST);
    if deepest > stop {
        warn(
            "depth of impact",
            deepest / stop,
            &STIFFNESS,
            format!(
                "approaches {FASTEST} times as fast as {} reach a penetration of {}, above \
                 law.stop_penetration = {stop}: the run would stop",
                significant(estimates.approach_speed, 5),
                significant(deepest, 3)
            ),
            format!(
                "a stiffness above {}, with a smaller dt, or slower discs",
                significant(law.stiffness_for_impact(deepest / stop), 5)
            ),
        );
    }
    let (most, column) = (scene.law.max_penetration, column(scene, domain, particles));
    let bottom = 0.5 * law.depth_under(column) / smallest_radius(particles);
    if bottom > most {
        warn(
            "depth at rest",
            bottom / most,
            &STIFFNESS,
            format!(
                "a grain's own weight presses it {} of its radius into another; under the weight of a column of this scene, \
                 grains reach a penetration of {}, above law.max_penetration = {most}",
                significant(estimates.resting_depth, 4),
                significant(bottom, 3)
            ),
            format!(
                "a stiffness above {}, or lighter grains",
                significant(law.stiffness_for_rest(bottom / most), 5)
            ),
        );
    }
}

fn smallest_radius(particles: &Particles) -> f64 {
    particles.grains().iter().map(|disc| disc.radius).fold(f64::INFINITY, f64::min)
}

/// Weight of the highest possible column of grains: all of them, spread over the box across gravity.
fn column(scene: &GranularScene, domain: &Domain, particles: &Particles) -> f64 {
    let diameter = 2.0 * smallest_radius(particles);
    let heaviest = particles.grains().iter().map(|disc| disc.mass).fold(0.0, f64::max);
    let total: f64 = particles.grains().iter().map(|disc| disc.mass).sum();
    let along = |axis: usize| {
        let gravity = scene.domain.gravity[axis].abs();
        let across = (domain.length(1 - axis) / diameter).max(1.0);
        gravity * (total / across).max(heaviest)
    };
    if particles.grain_count() == 0 { 0.0 } else { along(0).max(along(1)) }
}
