//! Langevin dynamics: friction and noise of a bath of temperature kT, m a = F − γ v + √(2 γ kT) ξ(t), LAN17.

use super::velocity_verlet::{drift, kick};
use super::{Context, DERIVATIVES, Draws, Scheme};
use crate::backend::Registers;

/// A heat bath.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bath {
    /// Friction γ (mass/time).
    pub friction: f64,
    /// Temperature kT (energy).
    pub temperature: f64,
}

/// Scheme of LAN17: velocity Verlet with friction and noise inside the acceleration, −γ v + √(2 γ kT/dt) η. If the friction uses
/// the velocity v_h after half a kick, ⟨v²⟩ is exactly kT/m.
///
/// # As printed
/// The friction uses the velocity of the previous step (`OLD`), which heats the particles to kT/(1 − γ dt/2m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stochastic<const OLD: bool> {
    /// The bath.
    pub bath: Bath,
}

impl<const OLD: bool> Stochastic<OLD> {
    /// Total acceleration from the force, the friction at a velocity, and the noise.
    #[inline(always)]
    fn total_acceleration<R: Registers>(
        &self,
        context: &Context<R>,
        velocity: R::V,
        acceleration: R::V,
    ) -> R::V {
        let Bath { friction, temperature } = self.bath;
        let strength = (2.0 * friction * temperature / context.dt()).sqrt();
        let bath = context.uniform(strength) * context.normal() - context.uniform(friction) * velocity;
        acceleration + bath * context.inverse()
    }
}

impl<const OLD: bool> Scheme for Stochastic<OLD> {
    const CARRIED: usize = if OLD { 3 } else { 2 };
    const DRAWS: Draws = Draws::InCorrector;

    #[inline(always)]
    fn scales(_: f64) -> [f64; DERIVATIVES] {
        [1.0; DERIVATIVES]
    }

    #[inline(always)]
    fn begin<R: Registers>(&self, context: &Context<R>, row: &mut [R::V; DERIVATIVES], acceleration: R::V) {
        row[2] = self.total_acceleration(context, row[1], acceleration);
    }

    #[inline(always)]
    fn correct<R: Registers>(&self, context: &Context<R>, row: &mut [R::V; DERIVATIVES], acceleration: R::V) {
        let half = context.uniform(0.5 * context.dt());
        let velocity = if OLD { row[1] - row[2] * half } else { row[1] };
        let whole = self.total_acceleration(context, velocity, acceleration);
        kick(|value| context.uniform(value), context.dt(), row, whole);
    }

    #[inline(always)]
    fn predict<R: Registers>(&self, context: &Context<R>, row: &mut [R::V; DERIVATIVES]) {
        drift(|value| context.uniform(value), context.dt(), row);
    }
}

/// The BAOAB scheme (Leimkuhler & Matthews 2013): half a kick, half a drift, friction and noise exactly, half a drift, the
/// forces, half a kick. Positions have errors of order dt², and none in a harmonic trap. There the velocities right after the
/// bath are exact too. Velocities at the end of the step have m⟨v²⟩ = kT − dt²⟨F²⟩/(4 m); in a trap of frequency ω this is kT (1
/// − ω²dt²/4).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Baoab {
    kept: f64,
    /// kT (1 − e^(−2 γ dt/m)), the variance of the noise times a mass (energy).
    drawn: f64,
}

impl Baoab {
    /// Scheme with steps of `dt` (time), for particles of equal mass.
    #[inline]
    pub fn new(bath: Bath, dt: f64, mass: f64) -> Self {
        let kept = libm::exp(-bath.friction * dt / mass);
        Baoab { kept, drawn: bath.temperature * (1.0 - kept * kept) }
    }
}

impl Scheme for Baoab {
    const CARRIED: usize = 2;
    const DRAWS: Draws = Draws::InPredictor;

    /// The bath is exact, so the noise of a part decays until the end of the step: v' = c v + s Σ_j c^((p−1−j)/p) ξ_j / norm.
    fn noise_weights(&self, parts: u32) -> Vec<f64> {
        let of_part = libm::pow(self.kept, 1.0 / f64::from(parts));
        let decayed: Vec<f64> = (0..parts).rev().map(|left| libm::pow(of_part, f64::from(left))).collect();
        let norm = decayed.iter().map(|weight| weight * weight).sum::<f64>().sqrt();
        decayed.into_iter().map(|weight| weight / norm).collect()
    }

    #[inline(always)]
    fn scales(_: f64) -> [f64; DERIVATIVES] {
        [1.0; DERIVATIVES]
    }

    #[inline(always)]
    fn begin<R: Registers>(&self, _: &Context<R>, row: &mut [R::V; DERIVATIVES], acceleration: R::V) {
        row[2] = acceleration;
    }

    #[inline(always)]
    fn correct<R: Registers>(&self, context: &Context<R>, row: &mut [R::V; DERIVATIVES], acceleration: R::V) {
        kick(|value| context.uniform(value), context.dt(), row, acceleration);
    }

    #[inline(always)]
    fn predict<R: Registers>(&self, context: &Context<R>, row: &mut [R::V; DERIVATIVES]) {
        use crate::isa::Vector;
        let half = context.uniform(0.5 * context.dt());
        row[1] = row[1] + row[2] * half;
        row[0] = row[0] + row[1] * half;
        let deviation = (context.uniform(self.drawn) * context.inverse()).sqrt();
        row[1] = context.uniform(self.kept) * row[1] + deviation * context.normal();
        row[0] = row[0] + row[1] * half;
    }
}
