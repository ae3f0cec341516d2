//! Discs at random sites of a mesh.

use super::StatedStart;
use super::filling::{MOST, check_placement_memory, disc};
use crate::domain::Domain;
use crate::number::significant;
use crate::particles::{Particle, ParticleKind, Particles};
use crate::placement::{random_mesh_sites, set_gaussian_velocities};
use crate::scene::{Amount, COUNT, GeneratedDiscs, MistakeKind, PACKING_FRACTION, SPACING, SceneError};
use std::f64::consts::PI;

/// Largest number of sites, which most meshes have far more of than discs.
const MOST_SITES: f64 = (u32::MAX / 2) as f64;

/// Places discs at random sites of a square mesh.
pub(super) fn on_mesh(
    stated: &StatedStart<'_>,
    domain: &Domain,
    amount: Amount,
    grains: &GeneratedDiscs,
    spacing: f64,
) -> Result<Particles, SceneError> {
    let counts = [0, 1].map(|axis| (domain.length(axis) / spacing).floor().max(1.0));
    let key = if stated.values.is_given(&COUNT) { &COUNT } else { &PACKING_FRACTION };
    let count = match amount {
        Amount::Count(count) | Amount::Both(count, _) => count as f64,
        Amount::PackingFraction(fraction) => {
            (fraction * domain.area() / (PI * grains.radius * grains.radius)).round()
        }
    };
    let refuse = |message: String| stated.spot(key).error(MistakeKind::Placement, message);
    if !(1.0..=MOST).contains(&count) {
        return Err(refuse(format!(
            "{count} discs are not between 1 and the {MOST} that can be numbered",
            count = significant(count, 5),
            MOST = significant(MOST, 4)
        )));
    }
    if count > counts[0] * counts[1] {
        let message = format!(
            "{count} discs, but the mesh has {} × {} = {} sites {spacing} apart",
            counts[0],
            counts[1],
            counts[0] * counts[1]
        );
        return Err(refuse(message).advising("take fewer discs, a larger box or a smaller particles.spacing"));
    }
    if counts[0] * counts[1] > MOST_SITES {
        let message = format!(
            "a mesh of {} × {} sites has more than the {most} that can be numbered",
            counts[0],
            counts[1],
            most = significant(MOST_SITES, 4)
        );
        let error = stated.spot(&SPACING).error(MistakeKind::Placement, message);
        return Err(error.advising("set a larger particles.spacing"));
    }
    check_placement_memory(stated, count, key)?;
    let edge = [0, 1].map(|axis| domain.length(axis) / counts[axis]);
    let places = random_mesh_sites(counts.map(|count| count as usize), count as usize, grains.seed);
    let at = |[column, row]: [usize; 2]| {
        [0, 1].map(|axis| domain.origin[axis] + ([column, row][axis] as f64 + 0.5) * edge[axis])
    };
    let of = [grains.radius, grains.mass];
    let discs = places
        .into_iter()
        .zip(1..)
        .map(|(place, id)| disc(id, ParticleKind::Grain, at(place), grains.radius, of));
    let mut discs: Vec<Particle> = discs.collect();
    let balanced = domain.periodic() == [true; 2] && discs.len() > 1;
    set_gaussian_velocities(&mut discs, grains.seed, balanced, |disc| grains.speed.deviation(disc.mass));
    Ok(Particles::new(discs))
}
