//! Velocities of particles at the start.

use super::binding::Binding;
use super::disc_keys::{EXACT_TEMPERATURE, SPEED, TEMPERATURE};

/// Velocities at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Speed {
    /// Gaussian velocities with this standard deviation for each component (length/time); 0 is rest.
    Deviation(f64),
    /// Maxwell velocities with this kT (mass·length²/time²).
    Temperature(f64),
}

impl Speed {
    /// Standard deviation of each component of the velocity of a disc of a mass (length/time).
    pub fn deviation(self, mass: f64) -> f64 {
        match self {
            Speed::Deviation(speed) => speed,
            Speed::Temperature(kt) => (kt / mass).sqrt(),
        }
    }

    /// Binds its keys; none if neither is given.
    pub(super) fn bind(binding: &mut dyn Binding, given: &mut Option<Speed>) {
        let (mut speed, mut temperature) = match *given {
            Some(Speed::Deviation(speed)) => (Some(speed), None),
            Some(Speed::Temperature(kt)) => (None, Some(kt)),
            None => (None, None),
        };
        binding.number_if_any(&SPEED, &mut speed);
        binding.number_if_any(&TEMPERATURE, &mut temperature);
        if binding.reads() {
            *given = temperature.map(Speed::Temperature).or(speed.map(Speed::Deviation));
        }
    }
}

impl Default for Speed {
    fn default() -> Self {
        Speed::Deviation(0.0)
    }
}

/// Binds the key for exact temperatures; it is written only where it is set, so that scenes without it keep their text.
pub(super) fn bind_exactness(binding: &mut dyn Binding, is_exact: &mut bool) {
    let mut given = is_exact.then_some(true);
    binding.switch_if_any(&EXACT_TEMPERATURE, &mut given);
    if binding.reads() {
        *is_exact = given.unwrap_or(false);
    }
}
