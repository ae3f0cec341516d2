//! Identities of the discs: the part of the start that the engine does not have.

use crate::particles::{Particle, ParticleKind, Particles, in_space};
use stripmine_kernels::flight::FlyingDisc;

/// Ids, order and spins of the discs. Engines number discs in the order of their ids.
///
/// A generated start has the ids 1, 2, … in this order and no spins, so nothing is stored.
#[derive(Clone, Debug)]
pub(super) struct DiscIdentities {
    count: usize,
    /// Id of each number; empty if all ids are one more than the number.
    ids: Vec<u32>,
    /// Index in the scene of each number; empty if the scene lists the discs in the order of their ids.
    places: Vec<u32>,
    /// Angle (radian) and angular velocity (radian/time) of each number; empty if all are zero.
    spins: Vec<[f64; 2]>,
}

impl DiscIdentities {
    /// Identities of the discs of a scene.
    pub(super) fn of(particles: &Particles) -> DiscIdentities {
        let all = particles.all();
        let mut places = vec![];
        if !all.is_sorted_by_key(|disc| disc.id) {
            places = (0..all.len() as u32).collect();
            places.sort_by_key(|&place| all[place as usize].id);
        }
        let mut identities = DiscIdentities { count: all.len(), ids: vec![], places, spins: vec![] };
        let by_number = || (0..all.len() as u32).map(|number| &all[identities.place(number)]);
        let ids = match by_number().zip(1..).all(|(disc, id)| disc.id == id) {
            true => vec![],
            false => by_number().map(|disc| disc.id).collect(),
        };
        // A negative zero is stored, too.
        let is_zero = |number: f64| number.to_bits() == 0;
        let spins = match all.iter().all(|disc| is_zero(disc.angle) && is_zero(disc.omega)) {
            true => vec![],
            false => by_number().map(|disc| [disc.angle, disc.omega]).collect(),
        };
        (identities.ids, identities.spins) = (ids, spins);
        identities
    }

    /// True if the scene lists the discs in the order of their ids.
    pub(super) fn are_in_order(&self) -> bool {
        self.places.is_empty()
    }

    /// Number of discs.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Id of the disc with a number.
    pub(super) fn id(&self, number: u32) -> u32 {
        self.ids.get(number as usize).copied().unwrap_or(number + 1)
    }

    /// Index in the scene of the disc with a number.
    pub(super) fn place(&self, number: u32) -> usize {
        self.places.get(number as usize).copied().unwrap_or(number) as usize
    }

    /// Values of all numbers, in the order of the scene.
    pub(super) fn in_scene_order<X>(&self, of: impl Fn(u32) -> X) -> Vec<X> {
        if self.places.is_empty() {
            return (0..self.count as u32).map(of).collect();
        }
        let mut numbers = vec![0; self.count];
        self.places.iter().zip(0..).for_each(|(&place, number)| numbers[place as usize] = number);
        numbers.into_iter().map(of).collect()
    }

    /// Disc with a number as a particle, with a position and velocity.
    pub(super) fn particle(
        &self,
        number: u32,
        disc: &FlyingDisc,
        position: [f64; 2],
        velocity: [f64; 2],
    ) -> Particle {
        let [angle, omega] = self.spins.get(number as usize).copied().unwrap_or_default();
        Particle {
            id: self.id(number),
            kind: ParticleKind::Grain,
            species: 0,
            position: in_space(position),
            velocity: in_space(velocity),
            angle,
            omega,
            radius: disc.radius,
            mass: disc.mass,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Discs with gaps in their ids, out of order and spinning, and those of a generated start.
    #[test]
    fn identities_give_back_the_start() {
        let disc = |id: u32, omega: f64| Particle {
            id,
            kind: ParticleKind::Grain,
            species: 0,
            position: [f64::from(id), 2.0, 0.0],
            velocity: [0.5, -f64::from(id), 0.0],
            angle: 3.0 * omega,
            omega,
            radius: 0.25 * f64::from(id),
            mass: 2.0,
        };
        for (ids, omega, stored) in [
            (vec![1, 2, 3], 0.0, [0, 0, 0]),
            (vec![2, 3, 4], 0.0, [3, 0, 0]),
            (vec![7, 2, 5, 9], 0.5, [4, 4, 4]),
            (vec![3, 1, 2], -0.0, [0, 3, 3]),
        ] {
            let start = Particles::new(ids.iter().map(|&id| disc(id, omega)).collect());
            let identities = DiscIdentities::of(&start);
            let DiscIdentities { ids, places, spins, .. } = &identities;
            assert_eq!([ids.len(), places.len(), spins.len()], stored);
            let particle = |number: u32| {
                let own = &start.all()[identities.place(number)];
                let flying = FlyingDisc {
                    position: own.planar_position(),
                    velocity: own.planar_velocity(),
                    time: 0.0,
                    radius: own.radius,
                    mass: own.mass,
                    events: 0,
                };
                identities.particle(number, &flying, flying.position, flying.velocity)
            };
            let numbered: Vec<Particle> = (0..identities.count() as u32).map(particle).collect();
            assert!(numbered.is_sorted_by_key(|disc| disc.id));
            let again = identities.in_scene_order(|number| numbered[number as usize]);
            assert_eq!(again, start.all());
            let bits =
                |discs: &[Particle]| discs.iter().map(|disc| disc.omega.to_bits()).collect::<Vec<u64>>();
            assert_eq!(bits(&again), bits(start.all()));
        }
    }
}
