//! Initial positions and velocities.

mod mesh;
mod random;
mod rows;

pub(crate) use mesh::random_mesh_sites;
pub use random::Second;
pub(crate) use random::set_gaussian_velocities;
pub(crate) use random::{RandomPlacement, place_randomly};
pub(crate) use rows::{WallRow, wall_row};

use crate::particles::{Particle, ParticleKind, Particles, in_space};
use rand::RngExt;
use stripmine_kernels::noise::{RandomPurpose, Stream, normals};

/// Periodic box filled with equal discs.
#[derive(Clone, Debug, PartialEq)]
pub struct Packing {
    /// Discs of the packing.
    pub particles: Particles,
    /// Sides of the box (length).
    pub sides: [f64; 2],
}

/// Places `least` or a few more discs of diameter 1 and mass 1 on a hexagonal lattice of the given packing fraction, in a box as square as whole
/// rows allow. Each disc is shifted at random by at most 0.45 of the gap. Velocities are Maxwellian of temperature `kt` (mass · length²/time²)
/// without net momentum; discs do not spin.
pub fn hexagonal(least: usize, packing_fraction: f64, kt: f64, seed: u64) -> Packing {
    // Area of the plane for each disc: spacing² √3/2.
    let spacing = (std::f64::consts::PI / (2.0 * 3f64.sqrt() * packing_fraction)).sqrt();
    let row_height = spacing * 3f64.sqrt() / 2.0;
    // Rows come in pairs, so that the pattern closes across the periodic side.
    let pairs = ((least as f64 * spacing / row_height).sqrt() / 2.0).round().max(1.0) as usize;
    let rows = 2 * pairs;
    let columns = least.div_ceil(rows);
    let mut random = Stream::new(seed, RandomPurpose::Placement, 0);
    let mut discs = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let id = discs.len() as u32 + 1;
            let offset = 0.25 + 0.5 * (row % 2) as f64;
            let reach = 0.45 * (spacing - 1.0).max(0.0);
            let length = reach * random.random::<f64>();
            let angle = random.random_range(0.0..std::f64::consts::TAU);
            discs.push(Particle {
                id,
                kind: ParticleKind::Grain,
                species: 0,
                position: in_space([
                    (column as f64 + offset) * spacing + length * libm::cos(angle),
                    (row as f64 + 0.5) * row_height + length * libm::sin(angle),
                ]),
                velocity: in_space(normals(seed, RandomPurpose::Placement, id, 1).map(|v| v * kt.sqrt())),
                angle: 0.0,
                omega: 0.0,
                radius: 0.5,
                mass: 1.0,
            });
        }
    }
    for axis in 0..2 {
        let mean = discs.iter().map(|disc| disc.velocity[axis]).sum::<f64>() / discs.len() as f64;
        discs.iter_mut().for_each(|disc| disc.velocity[axis] -= mean);
    }
    Packing { particles: Particles::new(discs), sides: [columns as f64 * spacing, rows as f64 * row_height] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packings_have_their_fraction_without_overlap() {
        for fraction in [0.84, 0.3] {
            let packing = hexagonal(300, fraction, 0.01, 3);
            let n = packing.particles.len();
            let area = n as f64 * std::f64::consts::PI / 4.0;
            assert!((area / (packing.sides[0] * packing.sides[1]) - fraction).abs() < 1e-12);
            let position: Vec<_> = packing.particles.all().iter().map(|disc| disc.position).collect();
            for i in 0..n {
                for j in 0..i {
                    let square: f64 = (0..2)
                        .map(|axis| {
                            let apart = position[i][axis] - position[j][axis];
                            let side = packing.sides[axis];
                            (apart - (apart / side).round() * side).powi(2)
                        })
                        .sum();
                    assert!(square > 1.0, "discs {i} and {j} overlap at fraction {fraction}");
                }
            }
        }
    }

    #[test]
    fn velocities_are_thermal_and_carry_no_momentum() {
        let packing = hexagonal(20_000, 0.5, 0.01, 1);
        let n = packing.particles.len() as f64;
        let velocities = || packing.particles.all().iter().map(|disc| disc.velocity);
        let momentum: f64 = velocities().map(|v| v[0] + v[1]).sum();
        let kt = velocities().map(|v| (v[0] * v[0] + v[1] * v[1]) / 2.0).sum::<f64>() / n;
        assert!(momentum.abs() < 1e-9);
        assert!((kt / 0.01 - 1.0).abs() < 5.0 / n.sqrt());
    }
}
