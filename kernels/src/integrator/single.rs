//! A single degree of freedom, moved by the code that moves the discs: for theory and tests of a scheme.

use super::{Context, DERIVATIVES, Scheme};
use crate::backend::Scalar;

/// One degree of freedom under a given acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SingleFreedom<C> {
    scheme: C,
    dt: f64,
    /// Derivatives, scaled as the scheme requires.
    pub row: [f64; DERIVATIVES],
}

impl<C: Scheme> SingleFreedom<C> {
    /// At rest at the origin, with steps of `dt` (time).
    #[inline]
    pub fn new(scheme: C, dt: f64) -> Self {
        SingleFreedom { scheme, dt, row: [0.0; DERIVATIVES] }
    }

    /// Sets the initial position (length) and velocity (length/time), and the acceleration there (length/time²).
    #[must_use]
    #[inline]
    pub fn starting(self, position: f64, velocity: f64, acceleration: impl Fn(f64, f64) -> f64) -> Self {
        let scales = C::scales(self.dt);
        let mut row = [0.0; DERIVATIVES];
        (row[0], row[1]) = (position, velocity * scales[1]);
        self.scheme.begin(&self.context(), &mut row, acceleration(position, velocity));
        SingleFreedom { row, ..self }
    }

    /// Position (length) and velocity (length/time).
    #[inline]
    pub fn motion(&self) -> [f64; 2] {
        [self.row[0], self.row[1] / C::scales(self.dt)[1]]
    }

    /// Makes a step; `acceleration` (length/time²) is a function of the predicted position and velocity.
    #[inline]
    pub fn step(&mut self, acceleration: impl Fn(f64, f64) -> f64) {
        let mut row = self.row;
        self.scheme.predict(&self.context(), &mut row);
        let [position, velocity] = SingleFreedom { row, ..*self }.motion();
        self.scheme.correct(&self.context(), &mut row, acceleration(position, velocity));
        self.row = row;
    }

    fn context(&self) -> Context<Scalar<f64>> {
        Context {
            registers: Scalar::default(),
            dt: self.dt,
            inverse: 1.0,
            // Theory considers the motion without noise.
            normal: 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::gear::{Acceleration, Gear};
    use crate::integrator::velocity_verlet::VelocityVerlet;

    /// A quarter of a period of x″ = −x from rest at 1 ends at the origin with velocity −1.
    fn oscillator_error<C: Scheme>(scheme: C, steps: u32) -> f64 {
        let spring = |position: f64, _: f64| -position;
        let dt = std::f64::consts::FRAC_PI_2 / f64::from(steps);
        let mut single = SingleFreedom::new(scheme, dt).starting(1.0, 0.0, spring);
        (0..steps).for_each(|_| single.step(spring));
        let [position, velocity] = single.motion();
        position.abs().max((velocity + 1.0).abs())
    }

    #[test]
    fn errors_have_the_order_of_the_scheme() {
        let order = |off: &dyn Fn(u32) -> f64| (off(40) / off(80)).log2();
        assert!((order(&|n| oscillator_error(VelocityVerlet, n)) - 2.0).abs() < 0.1);
        let gear = order(&|n| oscillator_error(Gear::<4>::new(Acceleration::OfPositions), n));
        assert!((1.9..4.5).contains(&gear), "{gear}");
        assert!(oscillator_error(Gear::<5>::new(Acceleration::OfPositions), 80) < 1e-4);
    }
}
