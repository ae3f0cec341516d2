//! Seeds of a run's random numbers.

use crate::particles::{Particle, Particles};
use crate::scene::DiscStart;
use stripmine_kernels::noise::seed_of_state;

/// Seed of the random numbers of bath and thermal walls.
///
/// A generated start uses the scene's seed. A start that is listed or read from a file derives its seed from the scene's and from the state, so
/// that a run continued from a frame does not repeat the noise of the previous run.
pub(crate) fn noise_seed(start: &DiscStart, seed: u64, particles: &Particles) -> u64 {
    if start.seed().is_some() {
        return seed;
    }
    let words = |&Particle { id, position: [x, y, _], velocity: [u, v, _], .. }: &Particle| {
        [[u64::from(id), x.to_bits()], [y.to_bits(), u.to_bits()], [v.to_bits(), 0]]
    };
    seed_of_state(seed, particles.all().iter().flat_map(words))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::{METHODS, load};
    use crate::scene::List;

    /// A generated start uses the scene's seed. The same particles as a list have another seed, which depends on the scene's seed and on every
    /// position and velocity.
    #[test]
    fn listed_starts_derive_their_own_seed() {
        let (prepared, _) = load("langevin-free", &["particles.count=5".to_owned()], METHODS).unwrap();
        let particles = prepared.particles().clone();
        let (drawn, listed) = (DiscStart::default(), DiscStart::List(List::default()));
        assert_eq!(noise_seed(&drawn, 9, &particles), 9);
        let own = noise_seed(&listed, 9, &particles);
        let mut seeds = vec![9, own, noise_seed(&listed, 10, &particles)];
        for axis in 0..2 {
            for of_velocity in [false, true] {
                let mut other = particles.clone();
                let particle = &mut other.all_mut()[4];
                let number =
                    &mut if of_velocity { &mut particle.velocity } else { &mut particle.position }[axis];
                *number = f64::from_bits(number.to_bits() + 1);
                seeds.push(noise_seed(&listed, 9, &other));
            }
        }
        assert_eq!(noise_seed(&listed, 9, &particles), own);
        seeds.sort_unstable();
        seeds.dedup();
        assert_eq!(seeds.len(), 7);
    }
}
