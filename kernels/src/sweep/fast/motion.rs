//! Equation of motion: what a pass integrates, with which scheme, step and noise.

use crate::backend::{Registers, Scalar};
use crate::integrator::{Context, DERIVATIVES, Draws, Inertia, Scheme, acceleration};
use crate::isa::Element;
use crate::noise::{self, NoiseSource, RandomPurpose};

/// Equation of motion and its integration: scheme, time step, inertia, gravity, noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EquationOfMotion<C> {
    /// The scheme.
    pub scheme: C,
    /// Time step (time).
    pub dt: f64,
    /// Divisor of the forces.
    pub inertia: Inertia,
    /// Acceleration of gravity (length/time²).
    pub gravity: [f64; 2],
    /// Source of random numbers, for a scheme that draws some.
    pub noise: NoiseSource,
}

impl<C: Scheme> EquationOfMotion<C> {
    /// Context of the scheme for one degree of freedom.
    #[inline(always)]
    pub(super) fn context<R: Registers>(&self, registers: R, inverse: R::V, normal: R::V) -> Context<R> {
        Context { registers, dt: self.dt, inverse, normal }
    }

    /// Draws the random numbers of some discs along x and y, in the pass that corrects the step numbered `step`.
    #[inline(always)]
    pub fn draw<S: Element>(&self, step: u64, ids: &[u32], to: [&mut [S]; 2]) {
        let NoiseSource { seed, parts } = self.noise;
        let first = match C::DRAWS {
            Draws::Never => return,
            Draws::InCorrector => step * u64::from(parts),
            Draws::InPredictor => step * u64::from(parts) + 1,
        };
        match parts {
            1 => noise::draw(seed, RandomPurpose::Thermostat, first, ids, to),
            _ => self.combine_noise(first, ids, to),
        }
    }

    /// Combines the numbers of a step from those of its parts, which are numbered from `first`.
    #[inline(never)]
    fn combine_noise<S: Element>(&self, first: u64, ids: &[u32], [across, along]: [&mut [S]; 2]) {
        let weights = self.scheme.noise_weights(self.noise.parts);
        for ((id, x), y) in ids.iter().zip(across).zip(along) {
            let mut sums = [0.0; 2];
            for (step, weight) in (first..).zip(&weights) {
                let [mut a, mut b] = [[0.0]; 2];
                noise::draw(self.noise.seed, RandomPurpose::Thermostat, step, &[*id], [&mut a, &mut b]);
                sums = [sums[0] + weight * a[0], sums[1] + weight * b[0]];
            }
            [*x, *y] = sums.map(S::from_f64);
        }
    }

    /// Returns one degree of freedom of a disc, corrected. Inputs are the predicted row (its first [`Scheme::CARRIED`] entries), the
    /// force, the inverse mass or moment of inertia, and the random number of a scheme that draws in its corrector.
    #[inline]
    pub fn corrected<S: Element>(
        &self,
        freedom: usize,
        predicted: [S; DERIVATIVES],
        force: S,
        inverse: S,
        normal: S,
    ) -> [S; DERIVATIVES] {
        let context = self.context(Scalar::<S>::default(), inverse, normal);
        let mut row = predicted;
        let acceleration =
            acceleration(|value| context.uniform(value), self.gravity, freedom, force, inverse);
        self.scheme.correct(&context, &mut row, acceleration);
        row
    }
}
