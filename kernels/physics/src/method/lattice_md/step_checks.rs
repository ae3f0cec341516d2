//! Checks of a step of granular discs: contacts that are too deep, discs that are too fast.

use super::wall_checks::wall_name;
use super::{ContactWatch, GranularModel, GranularTotals, OnLongStep};
use crate::method::pairwise::{NameableDiscs, PrescribedMotion, WallTouch};
use crate::method::{Clock, Culprit, FailureKind, PhysicsFailure};
use crate::number::significant;

/// Counts discs so fast that a step may miss their contacts, and stops if none are allowed.
pub(super) fn check_step_lengths(
    discs: &(impl NameableDiscs + ?Sized),
    far: &[u32],
    watch: Option<ContactWatch>,
    totals: &mut GranularTotals,
) -> Result<(), PhysicsFailure> {
    let Some(watch) = watch else { return Ok(()) };
    let speed = |disc: usize| {
        let [x, y] = discs.velocity(disc);
        x.hypot(y)
    };
    // NaN is detected with the cells.
    let far: Vec<usize> =
        far.iter().map(|&disc| disc as usize).filter(|&disc| !speed(disc).is_nan()).collect();
    let count = far.len() as u64;
    totals.long_steps += count;
    let first = far.into_iter().min_by_key(|&disc| discs.number(disc));
    match (watch.on_long_step, first) {
        (OnLongStep::Stop, Some(first)) => {
            let limit = watch.longest_step();
            let dt = limit / speed(first);
            Err(long_step(discs.clock(), count, discs.culprit(first), limit, dt))
        }
        _ => Ok(()),
    }
}

/// Fails if a wall moves so far in a step that contacts may be missed.
pub(super) fn check_wall_steps(
    discs: &(impl NameableDiscs + ?Sized),
    model: &GranularModel,
    motions: &[PrescribedMotion],
) -> Result<(), PhysicsFailure> {
    let Some(watch) = model.watch else { return Ok(()) };
    let limit = watch.longest_step();
    let step = |motion: &PrescribedMotion| motion.velocity[0].hypot(motion.velocity[1]) * model.dt;
    let Some(wall) = motions.iter().position(|motion| step(motion) > limit) else { return Ok(()) };
    let (speed, dt) = (step(&motions[wall]) / model.dt, model.dt * limit / step(&motions[wall]));
    let what = format!(
        "{} moves at {} and farther than {} in the step; it could pass discs between two steps",
        wall_name(&model.walls.all()[wall].label),
        significant(speed, 5),
        significant(limit, 7)
    );
    let remedy =
        format!("lower dt to {}, or give the wall more mass, less force or less speed", significant(dt, 5));
    let failure = PhysicsFailure::new(FailureKind::LONG_STEP, what, remedy).at(discs.clock());
    Err(failure.with([("limit", limit), ("dt", dt)]))
}

/// Counts grains in contacts that are too deep, and stops above the limit. A pair may be listed once or from both sides.
pub(super) fn check_contact_depths(
    discs: &(impl NameableDiscs + ?Sized),
    (pairs, touches): (&[[u32; 2]], &[WallTouch]),
    model: &GranularModel,
    totals: &mut GranularTotals,
) -> Result<(), PhysicsFailure> {
    let Some(watch) = model.watch else { return Ok(()) };
    let is_grain = |disc: &usize| discs.grains().contains(disc);
    let (mut grains, mut deepest): (Vec<usize>, Option<(f64, [usize; 2])>) = (vec![], None);
    let pairs = pairs.iter().map(|pair| pair.map(|disc| disc as usize));
    for pair in pairs.filter(|pair| pair.iter().any(is_grain)) {
        let penetration = discs.penetration(pair);
        if penetration > watch.max_penetration {
            grains.extend(pair.iter().filter(|disc| is_grain(disc)));
            if deepest.is_none_or(|(deepest, _)| penetration > deepest) {
                deepest = Some((penetration, pair));
            }
        }
    }
    let deep = touches.iter().filter(|touch| touch.penetration > watch.max_penetration);
    grains.extend(deep.clone().map(|touch| touch.disc as usize));
    let at_wall = deep.max_by(|a, b| a.penetration.total_cmp(&b.penetration));
    grains.sort_unstable();
    grains.dedup();
    let most = deepest.map_or(0.0, |(depth, _)| depth).max(at_wall.map_or(0.0, |touch| touch.penetration));
    if grains.is_empty() {
        return Ok(());
    }
    totals.add_deep(discs.clock().steps, grains.len() as u64, most);
    if most > watch.stop_penetration {
        let (at, limit) = (discs.clock(), watch.stop_penetration);
        return Err(match (at_wall, deepest) {
            (Some(touch), _) if touch.penetration == most => {
                let wall = wall_name(&model.walls.all()[touch.wall as usize].label);
                too_deep_in_wall(at, discs.culprit(touch.disc as usize), (touch, &wall), limit)
            }
            (_, Some((_, pair))) => too_deep(at, pair.map(|disc| discs.culprit(disc)), most, limit),
            _ => return Ok(()),
        });
    }
    Ok(())
}

/// Failure of discs that moved farther than `limit` (length) in a step; a step of `dt` (time) is short enough for the first.
fn long_step(at: Clock, count: u64, first: Culprit, limit: f64, dt: f64) -> PhysicsFailure {
    let what = format!(
        "{count} discs moved farther than {} in the step, first {first}; contacts deeper than law.max_penetration \
         could be missed between two steps",
        significant(limit, 7)
    );
    let remedy = format!(
        "lower dt to {dt}, slow the discs, or set integrator.on_long_step = \"count\"",
        dt = significant(dt, 5)
    );
    let failure = PhysicsFailure::new(FailureKind::LONG_STEP, what, remedy).at(at).of(count, [first]);
    failure.with([("limit", limit), ("dt", dt)])
}

/// Failure of a disc that has entered a plane wall too deeply.
fn too_deep_in_wall(
    at: Clock,
    disc: Culprit,
    (touch, wall): (&WallTouch, &str),
    limit: f64,
) -> PhysicsFailure {
    let what = format!(
        "{disc} has entered {wall} by {} of its radius, more than law.stop_penetration = {limit}",
        significant(touch.penetration, 4)
    );
    let remedy = "the contacts are too soft for these weights and speeds: raise law.stiffness (and lower dt), or slow the discs or the wall";
    let failure = PhysicsFailure::new(FailureKind::TOO_DEEP, what, remedy).at(at).of(1, [disc]);
    failure.with([("penetration", touch.penetration), ("limit", limit)])
}

/// Failure of a contact of penetration ξ/(R_i + R_j) beyond the limit.
fn too_deep(at: Clock, [first, second]: [Culprit; 2], penetration: f64, limit: f64) -> PhysicsFailure {
    let what = format!(
        "{first} and {second} overlap by {} of the sum of their radii, more than law.stop_penetration = {limit}",
        significant(penetration, 4)
    );
    let remedy = "the contacts are too soft for these weights and speeds: raise law.stiffness (and lower dt), or slow the discs";
    let failure = PhysicsFailure::new(FailureKind::TOO_DEEP, what, remedy).at(at).of(2, [first, second]);
    failure.with([("penetration", penetration), ("limit", limit)])
}
