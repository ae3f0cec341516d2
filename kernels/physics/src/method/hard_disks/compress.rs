//! Dense starts by the Lubachevsky–Stillinger method: discs move and collide while their radii grow to the final values.

use super::engine::{EventEngine, FlyingDiscs};
use super::event::{Arena, CollisionLaw};
use super::fast::{Fast, displacement_limit};
use crate::domain::Domain;
use crate::particles::{Particle, in_space};
use crate::start::CompressionFailure;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::flight::{FlyingDisc, RadiusGrowth};
use stripmine_kernels::noise::{RandomPurpose, normals};

/// Relative growth of the radii while a typical disc flies through the mean radius: fast at low density, slow where the
/// discs have to order.
const GROWTH: [f64; 2] = [0.02, 0.001];
/// Packing fraction above which the radii grow slowly.
const CROWDED: f64 = 0.65;
/// Relative excess of the final radii, so that rounding causes no overlap.
const BEYOND: f64 = 1e-9;
/// Events per disc between rescalings of the velocities: growth heats the discs.
const BETWEEN: u64 = 20;
/// Events per disc after which the compression is given up as jammed.
const MOST: u64 = 40_000;

/// Moves discs so that they can grow from `scale` times their radii to the full radii. Velocities stay unchanged.
///
/// # Errors
/// [`CompressionFailure`], with the packing fraction reached, or if the box is too small.
pub fn compress(
    domain: &Domain,
    grains: &mut [Particle],
    scale: f64,
    seed: u64,
) -> Result<(), CompressionFailure> {
    let count = grains.len() as u64;
    let mean = grains.iter().map(|grain| grain.radius).sum::<f64>() / count.max(1) as f64;
    let area: f64 = grains.iter().map(|grain| std::f64::consts::PI * grain.radius * grain.radius).sum();
    let packing = area / domain.area();
    let law = CollisionLaw::ELASTIC;
    let arena = Arena::new(*domain, [0.0; 2], law);
    if displacement_limit(&arena, grains.iter().map(|grain| grain.radius)).is_none() {
        return Err(CompressionFailure::TooSmall);
    }
    // Masses do not matter here: all masses and kT are 1; speeds are in mean radii.
    let mut discs: Vec<FlyingDisc> = grains
        .iter()
        .map(|grain| FlyingDisc {
            position: domain.wrapped(grain.planar_position()),
            velocity: normals(seed, RandomPurpose::Placement, grain.id, 2).map(|v| mean * v),
            time: 0.0,
            radius: grain.radius * (1.0 + BEYOND),
            mass: 1.0,
            events: 0,
        })
        .collect();
    let (mut scale, mut events) = (scale, 0);
    while scale < 1.0 {
        let crowded = packing * scale * scale > CROWDED;
        let rate = GROWTH[usize::from(crowded)];
        let end = (1.0 - scale) / rate;
        let growing = arena.growing(RadiusGrowth { from: scale, rate });
        let mut engine = Fast::new(growing, discs.clone(), InstructionSet::best(), 0.0);
        engine.begin().map_err(|_| CompressionFailure::TooSmall)?;
        let mut time = end;
        for _ in 0..BETWEEN * count / 2 {
            match engine.next(end, u64::MAX) {
                Ok(Some(happened)) => time = happened.time,
                Ok(None) => {
                    time = end;
                    break;
                }
                Err(_) => return Err(CompressionFailure::Jammed { reached: packing * scale * scale }),
            }
        }
        events += BETWEEN;
        scale = if time == end { 1.0 } else { scale + rate * time };
        for (number, disc) in discs.iter_mut().enumerate() {
            let after = engine.disc(number as u32);
            (disc.position, disc.velocity) = (growing.position_at(after, time), after.velocity);
        }
        let square: f64 = discs.iter().map(|disc| disc.speed().powi(2)).sum();
        let cooled = mean / (square / (2.0 * count as f64)).sqrt();
        for disc in &mut discs {
            disc.velocity = disc.velocity.map(|v| cooled * v);
        }
        if events > MOST {
            return Err(CompressionFailure::Jammed { reached: packing * scale * scale });
        }
    }
    for (grain, disc) in grains.iter_mut().zip(&discs) {
        grain.position = in_space(disc.position);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::particles::ParticleKind;
    use crate::placement::{RandomPlacement, Second, place_randomly};

    fn start(domain: Domain, packing: f64, spread: f64, scale: f64) -> Vec<Particle> {
        let mean = 0.5;
        let count = (packing * domain.area() / (std::f64::consts::PI * mean * mean)) as usize;
        let [x, y] = domain.lengths();
        let filling = RandomPlacement {
            domain,
            room: [[0.0; 2], [x, y]],
            obstacles: &[],
            barriers: &[],
            count,
            radius: scale * mean,
            spread,
            cut: 2.0 * spread,
            second: Second::default(),
            mass: 1.0,
            seed: 3,
        };
        let mut grains = place_randomly(&filling).unwrap();
        grains.iter_mut().for_each(|grain| grain.radius /= scale);
        assert!(grains.iter().all(|grain| grain.kind == ParticleKind::Grain));
        grains
    }

    /// No disc overlaps another or a closed side, at packing fractions that random placement cannot reach.
    #[test]
    fn compression_reaches_the_full_radii() {
        for (packing, spread, periodic) in
            [(0.70, 0.0, [true; 2]), (0.75, 0.1, [true; 2]), (0.70, 0.1, [false; 2])]
        {
            let domain = Domain::planar([0.0; 2], [16.0, 15.0], periodic);
            let mut grains = start(domain, packing, spread, 0.6);
            compress(&domain, &mut grains, 0.6, 3).unwrap();
            for (number, a) in grains.iter().enumerate() {
                for b in &grains[number + 1..] {
                    assert!(domain.distance(a.planar_position(), b.planar_position()) >= a.radius + b.radius);
                }
                for axis in (0..2).filter(|&axis| !periodic[axis]) {
                    let along = a.position[axis];
                    assert!(along >= a.radius && along <= domain.length(axis) - a.radius);
                }
            }
        }
    }

    #[test]
    fn compression_rejects_too_small_boxes() {
        let domain = Domain::planar([0.0; 2], [2.1; 2], [true; 2]);
        let mut grains = start(domain, 0.6, 0.0, 0.6);
        assert_eq!(compress(&domain, &mut grains, 0.6, 3), Err(CompressionFailure::TooSmall));
    }
}
