//! The pair potential of Yukawa: screened charges.

use super::Env;
use super::potential::PairPotential;
use crate::isa::Vector;

/// Particles that repel each other like charges in a screening medium, such as colloids in an electrolyte or dust in a plasma
/// (Yukawa, Debye and Hückel):
///
/// ```text
/// U(r) = ε (σ/r) exp(−κ (r − σ))
/// F(r) = U (κ + 1/r)
/// U″(r) = U (κ² + 2 κ/r + 2/r²)
/// ```
///
/// with ε, the energy at the distance σ (energy), the diameter σ (length) and 1/κ, the screening length (length). LAMMPS and
/// HOOMD-blue use the factor ε σ exp(κσ) as a single parameter.
///
/// # Examples
/// At σ the energy is ε and the force ε (κ + 1/σ):
/// ```
/// use stripmine_kernels::law::potential::PairPotential;
/// use stripmine_kernels::law::yukawa::Yukawa;
///
/// let potential = Yukawa::new(3.0, 0.5, 4.0);
/// assert_eq!((potential.energy(0.5), potential.force(0.5)), (3.0, 18.0));
/// assert_eq!(potential.curvature(0.5), 120.0);
/// ```
///
/// At twice that distance the energy is exp(−κσ)/2 times as large, minus its value at the cut-off:
/// ```
/// # use stripmine_kernels::law::yukawa::Yukawa;
/// use stripmine_kernels::law::potential::CutOff;
///
/// let law = CutOff::new(Yukawa::new(1.0, 1.0, 5.0), 2.5);
/// assert!((law.energy(2.0) - (0.5 * (-5f64).exp() - 0.4 * (-7.5f64).exp())).abs() < 1e-16);
/// assert_eq!((law.energy(2.5), law.force(2.5)), (0.0, 0.0));
/// ```
///
/// Sweeps replace the exponential by a series, which is exact to the precision of their numbers up to 16 screening lengths beyond
/// σ:
/// ```
/// # use stripmine_kernels::law::potential::{CutOff, PairPotential};
/// # use stripmine_kernels::law::yukawa::Yukawa;
/// use stripmine_kernels::sweep::pair::{PairBody, Pair};
///
/// let law = CutOff::new(Yukawa::new(1.0, 1.0, 5.0), 4.2);
/// for distance in [0.2, 1.0, 2.0, 4.1] {
///     let pair = Pair { bodies: [PairBody::at(distance, 0.0), PairBody::at(0.0, 0.0)] };
///     let [[force, ..], _] = pair.sums(&law);
///     assert!((force / law.potential().force(distance) - 1.0).abs() < 5e-14);
/// }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Yukawa {
    /// ε (energy).
    strength: f64,
    /// σ (length).
    diameter: f64,
    /// κ (1/length).
    screening: f64,
    /// Number of times the exponent is halved before the series and the result squared after it.
    halvings: u32,
    /// κ after these halvings (1/length).
    part: f64,
}

/// Order of the exponential series, with coefficients 1/k!: at an exponent of 1/4 the remainder is 1.3 · 10⁻¹⁶.
const ORDER: usize = 11;
const SERIES: [f64; ORDER + 1] = {
    let mut series = [1.0; ORDER + 1];
    let mut k = 1;
    while k < series.len() {
        series[k] = series[k - 1] / k as f64;
        k += 1;
    }
    series
};

impl Yukawa {
    /// Potential with ε (energy), σ (length) and κ (1/length).
    pub fn new(strength: f64, diameter: f64, screening: f64) -> Self {
        let (mut halvings, mut part) = (6, screening / 64.0);
        // The exponent is κσ for particles at the same position.
        while part * diameter > 0.25 && halvings < 32 {
            (halvings, part) = (halvings + 1, 0.5 * part);
        }
        Yukawa { strength, diameter, screening, halvings, part }
    }
}

impl PairPotential for Yukawa {
    fn energy(&self, distance: f64) -> f64 {
        self.strength * self.diameter / distance * libm::exp(-self.screening * (distance - self.diameter))
    }

    fn force(&self, distance: f64) -> f64 {
        self.energy(distance) * (self.screening + 1.0 / distance)
    }

    fn curvature(&self, distance: f64) -> f64 {
        let (screening, inverse) = (self.screening, 1.0 / distance);
        self.energy(distance) * (screening * screening + 2.0 * screening * inverse + 2.0 * inverse * inverse)
    }

    type Shared<V: Vector> = V;

    #[inline(always)]
    fn swept_force<E: Env<2>>(&self, env: E, square: E::V) -> (E::V, E::V) {
        let uniform = |value: f64| env.uniform(value);
        let distance = square.sqrt();
        let inverse = uniform(1.0) / distance;
        let part = (uniform(self.diameter) - distance) * uniform(self.part);
        let mut exponential = uniform(SERIES[ORDER]);
        for coefficient in SERIES[..ORDER].iter().rev() {
            exponential = exponential.times_plus(part, uniform(*coefficient));
        }
        for _ in 0..self.halvings {
            exponential = exponential * exponential;
        }
        let energy = uniform(self.strength * self.diameter) * inverse * exponential;
        (energy * (uniform(self.screening) + inverse) * inverse, energy)
    }

    #[inline(always)]
    fn swept_energy<E: Env<2>>(&self, _: E, energy: E::V) -> E::V {
        energy
    }
}
