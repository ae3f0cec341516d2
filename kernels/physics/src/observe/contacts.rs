//! Contacts and sums over them in the order of the discs: the sequential reference for faster versions.

use crate::domain::Domain;
use crate::near::NeighbourSearch;
use crate::particles::{Particle, ParticleKind, Particles};
use std::ops::Range;
use stripmine_kernels::law::granular::{Contact, EqualDiscs, Granular};
use stripmine_kernels::sweep::pair::{Pair, PairBody};

/// Sums over the contacts with at least one grain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactSums {
    /// Number of contacts.
    pub count: u64,
    /// Stored energy.
    pub elastic: f64,
    /// Sum of (r_i − r_j)·F_i over contacts between grains (energy), damping included.
    pub virial: f64,
    /// Deepest contact (fraction of the sum of the radii).
    pub deepest: f64,
}

impl ContactSums {
    /// Sums over the contacts of some grains with the discs after each of them.
    pub(super) fn over(grains: Range<usize>, discs: &WrappedDiscs<'_>, contact: &Contact) -> ContactSums {
        let mut sums = ContactSums::default();
        discs.each_contact(grains, |i, j, penetration, reach| {
            sums.count += 1;
            sums.elastic += contact.energy(|number| number, penetration * reach);
            sums.deepest = sums.deepest.max(penetration);
            if discs.all[j].kind == ParticleKind::Grain {
                sums.virial += discs.virial(contact, i, j);
            }
        });
        sums
    }

    /// Adds a contact with a plane wall, which has no virial, by its stored energy and its depth (a fraction of the radius).
    pub(crate) fn add(&mut self, elastic: f64, depth: f64) {
        self.count += 1;
        self.elastic += elastic;
        self.deepest = self.deepest.max(depth);
    }

    /// Adds the sums of grains that follow.
    pub(super) fn join(&mut self, more: &ContactSums) {
        self.count += more.count;
        self.elastic += more.elastic;
        self.virial += more.virial;
        self.deepest = self.deepest.max(more.deepest);
    }
}

/// Discs, grains first, with their positions inside the box.
pub(super) struct WrappedDiscs<'a> {
    domain: Domain,
    all: &'a [Particle],
    /// Positions inside the box (length).
    places: Vec<[f64; 2]>,
    near: NeighbourSearch,
}

impl<'a> WrappedDiscs<'a> {
    /// Wraps the particles and sorts them for neighbour searches.
    pub(super) fn new(particles: &'a Particles, domain: &Domain) -> Self {
        let all = particles.all();
        let places: Vec<[f64; 2]> = all.iter().map(|disc| domain.wrapped(disc.planar_position())).collect();
        let reach = 2.0 * particles.radii().map_or(1.0, |[_, largest]| largest);
        let near = NeighbourSearch::over_positions(*domain, places.iter().copied(), reach);
        WrappedDiscs { domain: *domain, all, places, near }
    }

    /// Position of a disc inside the box (length).
    pub(super) fn place(&self, disc: usize) -> [f64; 2] {
        self.places[disc]
    }

    /// Calls `take(i, j, penetration, sum of the radii)` for each contact of some grains `i` with discs `j` after them.
    fn each_contact(&self, grains: Range<usize>, mut take: impl FnMut(usize, usize, f64, f64)) {
        let mut near: Vec<usize> = Vec::new();
        for i in grains {
            near.clear();
            near.extend(
                self.near.candidates_near(self.places[i]).map(|(j, _)| j as usize).filter(|&j| j > i),
            );
            near.sort_unstable();
            for &j in &near {
                let [dx, dy] = self.domain.displacement(self.places[i], self.places[j]);
                let reach = self.all[i].radius + self.all[j].radius;
                let penetration = 1.0 - dx.hypot(dy) / reach;
                if penetration > 0.0 {
                    take(i, j, penetration, reach);
                }
            }
        }
    }

    /// Virial (r_i − r_j)·F_i of two grains in contact (energy). Friction is perpendicular to the line of centres and does not contribute.
    fn virial(&self, contact: &Contact, i: usize, j: usize) -> f64 {
        let [own, partner] = [&self.all[i], &self.all[j]];
        let body = |particle: &Particle, [x, y]: [f64; 2]| PairBody {
            velocity: particle.planar_velocity(),
            radius: particle.radius,
            inverse_mass: 1.0 / particle.mass,
            ..PairBody::at(x, y)
        };
        // The law reads radius and mass of each disc from the pair.
        let alike = EqualDiscs { radius: own.radius, inverse_mass: 1.0 / own.mass };
        let law = Granular::<false, false> { contact: *contact, disc: alike };
        // Each disc has the velocity of its own position.
        let apart = self.domain.displacement(self.places[j], self.places[i]);
        Pair { bodies: [body(own, apart), body(partner, [0.0; 2])] }.energy_and_virial(&law)[1]
    }
}

/// Lists pairs in contact with at least one grain: the two indices, the penetration (fraction of the sum of the radii) and that sum (length), in
/// order of the first disc, then of the second.
pub fn contacts(particles: &Particles, domain: &Domain) -> Vec<(usize, usize, f64, f64)> {
    let mut found = Vec::new();
    let discs = WrappedDiscs::new(particles, domain);
    discs.each_contact(0..particles.grain_count(), |i, j, penetration, reach| {
        found.push((i, j, penetration, reach));
    });
    found
}
