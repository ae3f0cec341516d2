//! Rows of wall discs.

use crate::domain::Domain;
use crate::particles::{Particle, ParticleKind, in_space};

/// Row of wall discs along x, across the whole box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WallRow {
    /// Height of the centres (length).
    pub y: f64,
    /// Shift of the row along x, in units of the spacing.
    pub shift: f64,
    /// Radius (length).
    pub radius: f64,
    /// Distance of neighbouring centres (length); rounded so that it divides the side of the box.
    pub spacing: f64,
    /// Mass; it only describes the material.
    pub mass: f64,
}

/// Discs of a row, with ids from `first_id` on.
pub(crate) fn wall_row(domain: &Domain, row: &WallRow, first_id: u32) -> Vec<Particle> {
    let count = (domain.length(0) / row.spacing).round().clamp(1.0, f64::from(u32::MAX / 4)) as u32;
    let spacing = domain.length(0) / f64::from(count);
    let disc = |i: u32| Particle {
        id: first_id + i,
        kind: ParticleKind::Wall,
        species: 0,
        position: in_space(domain.wrapped([domain.origin[0] + (f64::from(i) + row.shift) * spacing, row.y])),
        velocity: [0.0; 3],
        angle: 0.0,
        omega: 0.0,
        radius: row.radius,
        mass: row.mass,
    };
    (0..count).map(disc).collect()
}

#[cfg(test)]
mod tests {

    use super::*;

    #[test]
    fn a_row_closes_across_the_periodic_side() {
        let domain = Domain::planar([1.0, 0.0], [8.1, 0.1], [true, false]);
        for shift in [0.0, 0.5] {
            let discs =
                wall_row(&domain, &WallRow { y: 0.03, shift, radius: 0.009, spacing: 0.0271, mass: 1.0 }, 7);
            assert_eq!(discs.len(), 299);
            assert_eq!((discs[0].id, discs[298].id), (7, 305));
            let spacing = 8.1 / 299.0;
            for pair in 0..299 {
                let (a, b) = (discs[pair].planar_position(), discs[(pair + 1) % 299].planar_position());
                assert!((domain.distance(a, b) - spacing).abs() < 1e-9);
            }
        }
    }
}
