//! Compression of discs: they grow to their radii while they move.

use super::filling::{COMPRESSED, fill, grain_count};
use super::{CompressionFailure, StatedStart};
use crate::domain::Domain;
use crate::number::significant;
use crate::particles::Particles;
use crate::placement::Second;
use crate::scene::{Amount, GENERATE, GeneratedDiscs, MistakeKind, SceneError};
use std::f64::consts::PI;

/// Packing fraction at which growth starts.
const SPARSE: f64 = 0.35;

/// Places discs while they are small, then lets them grow.
pub(super) fn compressed(
    stated: &StatedStart<'_>,
    domain: &Domain,
    amount: Amount,
    grains: &GeneratedDiscs,
) -> Result<Particles, SceneError> {
    let count = grain_count(stated, amount, domain.area(), grains, COMPRESSED)?;
    let packing = count as f64 * PI * grains.second.mean_square(grains.radius) / domain.area();
    let scale = (SPARSE / packing).sqrt().min(0.9);
    let far = [0, 1].map(|axis| domain.origin[axis] + domain.length(axis));
    let second = Second { radius: scale * grains.second.radius, ..grains.second };
    let small = GeneratedDiscs { radius: scale * grains.radius, second, ..*grains };
    let mut discs = fill(stated, domain, [domain.corner(), far], &[], count, &small)?;
    discs.iter_mut().for_each(|disc| disc.radius /= scale);
    (stated.compress)(domain, &mut discs, scale, grains.seed).map_err(|why| {
        let spot = stated.spot(&GENERATE);
        match why {
            CompressionFailure::Jammed { reached } => {
                let message = format!(
                    "{count} discs jam at a packing fraction of {}, below the {} asked for",
                    significant(reached, 4),
                    significant(packing, 4)
                );
                spot.error(MistakeKind::Placement, message)
                    .advising("lower count or packing_fraction, or take another seed")
            }
            CompressionFailure::TooSmall => {
                let message =
                    "the box is too small for discs to grow in: one would reach another across two sides";
                spot.error(MistakeKind::Placement, message)
                    .advising("take a larger box, or generate = \"hexagonal\"")
            }
        }
    })?;
    Ok(Particles::new(discs))
}
