//! Plausibility check of restored discs: an impossible state would cause infinitely many events.

use super::event::Arena;
use crate::domain::BoxSide;
use crate::method::{Clock, Snapshot};
use crate::near::NeighbourSearch;
use crate::particles::{Particle, Particles};
use stripmine_kernels::flight::FlyingDisc;

/// Largest overlap, of discs or with the box, as a fraction of a radius: many times the rounding of any run.
const ROUNDING: f64 = 1e-6;
/// Largest ratio of the energy to that offered by the scene, at the start or per event.
const MOST_ENERGY: f64 = 1e4;

/// Checks that discs are inside the box, do not overlap, are not ahead of the clock, and have no more energy than the scene can give.
/// `energy_at_start` is the [`available_energy`] (energy). The time of the engine (`engine.time`) lies between the local times and the clock.
///
/// # Errors
/// A message that names the first violation.
pub(super) fn check_restored_discs(
    arena: &Arena,
    energy_at_start: f64,
    discs: &[FlyingDisc],
    clock: &Clock,
    snapshot: &Snapshot,
) -> Result<(), String> {
    let now = clock.time;
    if let Some(disc) = discs.iter().find(|disc| !(0.0..=now).contains(&disc.time)) {
        return Err(format!(
            "the local time of a disc is {:?}, outside the range from 0 to the clock's {now:?}",
            disc.time
        ));
    }
    let engine = snapshot.sum("engine.time")?;
    if engine > now || discs.iter().any(|disc| disc.time > engine) {
        return Err(format!(
            "the time of the engine is {engine:?}, before the local time of a disc or after the clock's {now:?}"
        ));
    }
    let places: Vec<[f64; 2]> = discs.iter().map(|disc| arena.position_at(disc, now)).collect();
    for (disc, place) in discs.iter().zip(&places) {
        if !is_inside(arena, disc, disc.position) || !is_inside(arena, disc, *place) {
            return Err(format!("a disc at {place:?} is outside the box"));
        }
    }
    let kinetic: f64 = discs.iter().map(|disc| 0.5 * disc.mass * disc.speed().powi(2)).sum();
    // Only a floor adds energy with every event; a thermal side re-emits at its own temperature.
    let given = if arena.law.floor.is_some() { 1.0 + clock.events as f64 } else { 1.0 };
    let most = MOST_ENERGY * given * energy_at_start;
    if kinetic > most || kinetic.is_nan() {
        return Err(format!(
            "the discs have the kinetic energy {kinetic:?}, but the scene can give at most {most:?}"
        ));
    }
    let largest = discs.iter().map(|disc| disc.radius).fold(0.0, f64::max);
    let near = NeighbourSearch::over_positions(arena.domain, places.iter().copied(), 2.0 * largest);
    for (number, (disc, place)) in (0u32..).zip(discs.iter().zip(&places)) {
        let overlaps = |(other, there): (u32, [f64; 2])| {
            let apart = disc.radius + discs[other as usize].radius;
            other > number && arena.domain.distance(*place, there) < (1.0 - ROUNDING) * apart
        };
        if near.candidates_near(*place).any(overlaps) {
            return Err(format!("a disc at {place:?} overlaps another one"));
        }
    }
    Ok(())
}

fn is_inside(arena: &Arena, disc: &FlyingDisc, place: [f64; 2]) -> bool {
    let least = (1.0 - ROUNDING) * disc.radius;
    (0..2).all(|axis| {
        let above = place[axis] - arena.domain.origin[axis];
        match arena.domain.sides[axis] {
            BoxSide::Periodic(side) => (0.0..side).contains(&above),
            BoxSide::Closed(side) => (least..=side - least).contains(&above),
            BoxSide::Open => above >= least,
            BoxSide::Flat => true,
        }
    })
}

/// Energy available to the discs: at the start, by falling, and from a side in one event (energy).
pub(super) fn available_energy(arena: &Arena, start: &Particles) -> f64 {
    let gravity = arena.space.gravity().unwrap_or_default();
    let thermal = arena.law.thermal.map_or(0.0, |thermal| thermal.temperature);
    let floor =
        arena.law.floor.map_or(0.0, |floor| floor.amplitude * floor.frequency * std::f64::consts::TAU);
    let of = |disc: &Particle| {
        let square: f64 = disc.planar_velocity().iter().map(|v| v * v).sum();
        let fall = |axis: usize| {
            let above = disc.position[axis] - arena.domain.origin[axis];
            let side = arena.domain.length(axis);
            gravity[axis].abs() * if side.is_finite() { side } else { above.abs() }
        };
        disc.mass * (0.5 * square + fall(0) + fall(1) + floor * floor) + thermal
    };
    start.all().iter().map(of).sum()
}
