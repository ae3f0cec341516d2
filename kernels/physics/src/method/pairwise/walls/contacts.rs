//! Contacts of discs with plane walls.

use super::PlaneWalls;
use crate::method::pairwise::PrescribedMotion;
use crate::particles::Particles;
use stripmine_kernels::isa::Element;
use stripmine_kernels::law::Law;
use stripmine_kernels::over_parts;
use stripmine_kernels::sweep::walls::{ElementShape, TouchingDisc, WallContact, touch};

/// Contact of a disc with a plane wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WallTouch {
    /// Index of the disc in memory.
    pub(crate) disc: u32,
    /// Number of the wall.
    pub(crate) wall: u32,
    /// Force on the disc along x and y, and torque on it.
    pub(crate) sums: [f64; 3],
    /// Penetration, as a fraction of the disc's radius.
    pub(crate) penetration: f64,
    /// Power that it dissipates (energy/time).
    pub(crate) power: f64,
    /// Energy that it stores.
    pub(crate) energy: f64,
}

impl WallTouch {
    /// Contact of a disc of a radius (length) with a wall.
    pub(crate) fn new<P: Element>(
        disc: usize,
        wall: u32,
        radius: f64,
        contact: &WallContact<P>,
    ) -> WallTouch {
        WallTouch {
            disc: disc as u32,
            wall,
            sums: contact.sums.map(P::to_f64),
            penetration: contact.penetration.to_f64() / radius,
            power: contact.power.to_f64(),
            energy: contact.energy.to_f64(),
        }
    }
}

/// Disc with rates in other units of time, for the law.
pub(crate) fn touching_disc<P: Element>(
    position: [f64; 2],
    velocity: [f64; 2],
    omega: f64,
    [radius, inverse_mass]: [f64; 2],
) -> TouchingDisc<P> {
    let [radius, inverse_mass, omega] = [radius, inverse_mass, omega].map(P::from_f64);
    TouchingDisc {
        position: position.map(P::from_f64),
        velocity: velocity.map(P::from_f64),
        omega,
        radius,
        inverse_mass,
    }
}

/// Lists the contacts of all grains with all moved walls, by testing every grain against every piece, in double precision, each with its
/// point (length). The disc of a contact is its number in the scene.
pub(crate) fn each_touch<L: Law<2> + Sync>(
    law: &L,
    walls: &PlaneWalls,
    particles: &Particles,
    wrapped: impl Fn([f64; 2]) -> [f64; 2] + Sync,
    motions: &[PrescribedMotion],
) -> Vec<(WallTouch, [f64; 2])> {
    let (pieces, surfaces, images) = (walls.pieces_at(motions), walls.surfaces_at(motions), walls.images());
    let parts = over_parts(0..particles.grain_count(), |grains| {
        let mut found = vec![];
        for (number, grain) in grains.clone().zip(&particles.grains()[grains]) {
            let at = wrapped(grain.planar_position());
            let disc = touching_disc(
                [0.0; 2],
                grain.planar_velocity(),
                grain.omega,
                [grain.radius, 1.0 / grain.mass],
            );
            for piece in &pieces {
                for image in &images {
                    let Some(shape) = ElementShape::seen(&piece.moved(*image), at, grain.radius) else {
                        continue;
                    };
                    let element = shape.numbers(&surfaces[piece.wall as usize], [0.0; 2]);
                    if let Some(contact) = touch::<f64, L>(law, &disc, &element) {
                        let ElementShape { point: [x, y], along: [dx, dy], .. } = shape;
                        let beside = x * dx + y * dy;
                        let nearest = [at[0] + x - beside * dx, at[1] + y - beside * dy];
                        found.push((WallTouch::new(number, piece.wall, grain.radius, &contact), nearest));
                    }
                }
            }
        }
        found
    });
    parts.concat()
}
