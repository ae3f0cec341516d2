//! The pair potential of Lennard-Jones, LAN17.

use super::Env;
use super::potential::PairPotential;
use crate::isa::Vector;

/// Particles that repel each other as r⁻¹² and attract each other as r⁻⁶:
///
/// ```text
/// U(r) = 4 ε ((σ/r)¹² − (σ/r)⁶)
/// F(r) = 24 ε (2 (σ/r)¹² − (σ/r)⁶)/r
/// U″(r) = 4 ε (156 (σ/r)¹² − 42 (σ/r)⁶)/r²
/// ```
///
/// with the depth ε (energy) and the diameter σ (length). Cut off at the minimum, 2^(1/6) σ, particles only repel (WCA).
///
/// # As printed
/// The sum of LAN17 multiplies the acceleration by F/m; forces are added here. A particle does not interact with itself.
///
/// # Examples
/// At σ the energy is 0 and the force 24 ε/σ; at the minimum the energy is −ε and the curvature 72 ε/r².
/// ```
/// use stripmine_kernels::law::lennard_jones::LennardJones;
/// use stripmine_kernels::law::potential::PairPotential;
///
/// let potential = LennardJones::new(1.5, 2.0);
/// assert_eq!((potential.energy(2.0), potential.force(2.0)), (0.0, 18.0));
/// let minimum = 2.0 * 2f64.powf(1.0 / 6.0);
/// assert!((potential.energy(minimum) + 1.5).abs() < 1e-14 && potential.force(minimum).abs() < 1e-13);
/// assert!((potential.curvature(minimum) * minimum * minimum - 108.0).abs() < 1e-11);
/// ```
///
/// Cut off at 2.5 diameters and shifted, the energy is 0 at the cut-off:
/// ```
/// # use stripmine_kernels::law::lennard_jones::LennardJones;
/// use stripmine_kernels::law::potential::CutOff;
///
/// let law = CutOff::new(LennardJones::new(1.0, 1.0), 2.5);
/// assert!((law.energy(1.0) - 0.016_316_891).abs() < 1e-9);
/// assert_eq!((law.energy(2.5), law.force(2.5)), (0.0, 0.0));
/// ```
///
/// The force between two particles is the one that sweeps evaluate; two that collide with 48 ε approach to 2^(−1/3) σ:
/// ```
/// # use stripmine_kernels::law::lennard_jones::LennardJones;
/// # use stripmine_kernels::law::potential::{CutOff, PairPotential};
/// use stripmine_kernels::sweep::pair::{PairBody, Pair};
///
/// let law = CutOff::new(LennardJones::new(1.0, 1.0), 2.5);
/// let pair = Pair { bodies: [PairBody::at(1.0, 0.0), PairBody::at(0.0, 0.0)] };
/// assert_eq!(pair.sums(&law), [[24.0, 0.0, 0.0], [-24.0, 0.0, 0.0]]);
/// assert!((law.potential().closest(48.0) - 2f64.powf(-1.0 / 3.0)).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LennardJones {
    /// ε (energy).
    strength: f64,
    /// σ (length).
    diameter: f64,
    /// σ² (length²).
    square: f64,
}

impl LennardJones {
    /// Potential of depth ε (energy) and diameter σ (length).
    #[inline]
    pub fn new(strength: f64, diameter: f64) -> Self {
        LennardJones { strength, diameter, square: diameter * diameter }
    }

    /// (σ/r)⁶.
    fn sixth(&self, distance: f64) -> f64 {
        (self.diameter / distance).powi(6)
    }
}

impl PairPotential for LennardJones {
    fn energy(&self, distance: f64) -> f64 {
        let sixth = self.sixth(distance);
        4.0 * self.strength * sixth * (sixth - 1.0)
    }

    fn force(&self, distance: f64) -> f64 {
        let sixth = self.sixth(distance);
        24.0 * self.strength * (2.0 * sixth * sixth - sixth) / distance
    }

    fn curvature(&self, distance: f64) -> f64 {
        let sixth = self.sixth(distance);
        4.0 * self.strength * (156.0 * sixth * sixth - 42.0 * sixth) / (distance * distance)
    }

    type Shared<V: Vector> = V;

    #[inline(always)]
    fn swept_force<E: Env<2>>(&self, env: E, square: E::V) -> (E::V, E::V) {
        let uniform = |value: f64| env.uniform(value);
        let inverse = uniform(1.0) / square;
        let ratio = uniform(self.square) * inverse;
        let sixth = ratio * ratio * ratio;
        let repulsion = sixth * (sixth + sixth - uniform(1.0));
        (uniform(24.0 * self.strength) * repulsion * inverse, sixth)
    }

    #[inline(always)]
    fn swept_energy<E: Env<2>>(&self, env: E, sixth: E::V) -> E::V {
        env.uniform(4.0 * self.strength) * (sixth * (sixth - env.uniform(1.0)))
    }
}
