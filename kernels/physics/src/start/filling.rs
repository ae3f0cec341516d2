//! Common parts of all placements: limits on the number of discs, one disc, and a region filled at random.

use super::StatedStart;
use crate::domain::Domain;
use crate::memory::{self, Available};
use crate::number::significant;
use crate::particles::{MOST_PARTICLES, Particle, ParticleKind, in_space};
use crate::placement::{RandomPlacement, place_randomly, set_gaussian_velocities};
use crate::scene::{Amount, COUNT, GENERATE, GeneratedDiscs, Key, MistakeKind, PACKING_FRACTION, SceneError};
use std::f64::consts::PI;

/// Largest number of discs of one kind, grains or walls.
pub(super) const MOST: f64 = (MOST_PARTICLES / 2) as f64;
/// Packing fraction at which random sequential placement jams, however large the box.
pub(super) const JAMMING: f64 = 0.547;
/// Largest packing fraction of growing discs: beyond it they find no order that fits within a reasonable time.
pub(super) const COMPRESSED: f64 = 0.885;

/// Checks, before anything is placed, that the machine has the memory to place the discs and to search for overlaps: each disc, and its entry in a
/// map of squares whose size is a power of two.
pub(super) fn check_placement_memory(
    stated: &StatedStart<'_>,
    count: f64,
    key: &Key,
) -> Result<(), SceneError> {
    /// Size of an entry of the map, and of a disc in its square (bytes).
    const SQUARE: [f64; 2] = [25.0, 40.0];
    let squares = (count * 8.0 / 7.0).log2().ceil().exp2();
    let needed = count * (size_of::<Particle>() as f64 + SQUARE[1]) + squares * SQUARE[0];
    match memory::available() {
        Some(Available { bytes, by }) if needed > bytes as f64 => {
            let message = format!(
                "placing {} discs takes {} of memory; {} has {} left",
                significant(count, 5),
                memory::in_words(needed as u64),
                by.in_words(),
                memory::in_words(bytes)
            );
            Err(stated.spot(key).error(MistakeKind::Memory, message).advising("take fewer discs"))
        }
        _ => Ok(()),
    }
}

pub(super) fn disc(
    id: u32,
    kind: ParticleKind,
    position: [f64; 2],
    radius: f64,
    [unit, mass]: [f64; 2],
) -> Particle {
    let share = radius / unit;
    Particle {
        id,
        kind,
        species: 0,
        position: in_space(position),
        velocity: [0.0; 3],
        angle: 0.0,
        omega: 0.0,
        radius,
        mass: mass * share * share,
    }
}

/// Number of grains that fill an area, up to a packing fraction.
pub(super) fn grain_count(
    stated: &StatedStart<'_>,
    amount: Amount,
    open: f64,
    grains: &GeneratedDiscs,
    most: f64,
) -> Result<usize, SceneError> {
    let share = PI * grains.second.mean_square(grains.radius) / open;
    let (count, key): (f64, &Key) = match amount {
        Amount::Count(count) => (count as f64, &COUNT),
        Amount::Both(count, _) => (count as f64, &PACKING_FRACTION),
        Amount::PackingFraction(fraction) => ((fraction / share).round(), &PACKING_FRACTION),
    };
    let fraction = count * share;
    let refuse = |message: String| stated.spot(key).error(MistakeKind::Placement, message);
    if count > MOST {
        return Err(refuse(format!(
            "{count} discs are more than the {MOST} that can be numbered",
            count = significant(count, 5),
            MOST = significant(MOST, 4)
        )));
    }
    if count < 1.0 {
        let error = refuse(format!(
            "this is less than one disc, which alone fills {} of the area open to grains",
            significant(share, 4)
        ));
        let error = error.expecting("at least one disc");
        return Err(error.advising("raise particles.packing_fraction, or make the discs smaller"));
    }
    // A few discs in a small box may reach a higher fraction than many in a large one.
    let compresses = most == COMPRESSED;
    let bound = if compresses { most } else { most * (1.0 + 2.0 / count.sqrt()) };
    if fraction > bound {
        let how = if compresses { "growing discs jam at about" } else { "random placement jams at about" };
        let error = refuse(format!(
            "{count} discs fill {} of the area open to grains; {how} {most}",
            significant(fraction, 4)
        ));
        return Err(error.advising(match compresses {
            true => "place fewer discs, or start from generate = \"hexagonal\"",
            false => "place fewer discs, or start from generate = \"compressed\" or \"hexagonal\"",
        }));
    }
    check_placement_memory(stated, count, key)?;
    Ok(count as usize)
}

pub(super) fn fill(
    stated: &StatedStart<'_>,
    domain: &Domain,
    room: [[f64; 2]; 2],
    obstacles: &[Particle],
    count: usize,
    grains: &GeneratedDiscs,
) -> Result<Vec<Particle>, SceneError> {
    let GeneratedDiscs { radius, spread, cut, second, mass, seed, .. } = *grains;
    let cut = if spread > 0.0 { cut } else { 0.0 };
    let (domain, barriers) = (*domain, stated.barriers);
    let filling =
        RandomPlacement { domain, room, obstacles, barriers, count, radius, spread, cut, second, mass, seed };
    let mut discs = place_randomly(&filling).map_err(|jammed| {
        let error = stated.spot(&GENERATE).error(MistakeKind::Placement, jammed.to_string());
        error.advising("lower count or packing_fraction, or enlarge the box")
    })?;
    // Walls absorb momentum, so it is balanced without walls only.
    let balanced = domain.periodic() == [true; 2] && obstacles.is_empty() && discs.len() > 1;
    set_gaussian_velocities(&mut discs, seed, balanced, |disc| grains.speed.deviation(disc.mass));
    Ok(discs)
}
