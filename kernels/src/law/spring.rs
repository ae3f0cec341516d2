//! Springs of contacts: the elastic force as a function of the overlap, and every quantity derived from it.
//!
//! This module alone contains the formula. Laws, observers, checks and theory call it; another spring is another variant of
//! [`Spring`].

use super::granular::Contact;
use crate::isa::Vector;
use std::f64::consts::PI;

/// An elastic force k ξ^p of the overlap ξ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Spring {
    /// k ξ^(3/2), elastic spheres (Hertz).
    #[default]
    Hertz,
    /// k ξ.
    Linear,
}

impl Spring {
    /// Exponent p of the overlap.
    pub const fn exponent(self) -> f64 {
        match self {
            Spring::Hertz => 1.5,
            Spring::Linear => 1.0,
        }
    }

    /// Describes the kink of the force that limits a scheme's order to that of ξ^(p + 1).
    pub const fn kink(self) -> &'static str {
        match self {
            Spring::Hertz => "the Hertz force ξ^1.5 has a kink where a contact begins and ends",
            Spring::Linear => "the linear force ξ has a kink where a contact begins and ends",
        }
    }

    /// ξ^p.
    #[inline(always)]
    fn power<V: Vector>(self, overlap: V) -> V {
        match self {
            Spring::Hertz => overlap * overlap.sqrt(),
            Spring::Linear => overlap,
        }
    }

    /// Duration of an undamped head-on impact in units of depth/speed: 2 ∫ (1 − x^(p + 1))^(−1/2) dx from 0 to 1.
    const fn duration(self) -> f64 {
        match self {
            Spring::Hertz => 2.943_275,
            Spring::Linear => PI,
        }
    }
}

/// Outcome of a head-on impact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadOnImpact {
    /// Relative speed after the impact divided by that before.
    pub restitution: f64,
    /// Duration (time).
    pub duration: f64,
}

impl Spring {
    /// Integrates a head-on impact. `stiffness` is that of the spring divided by the effective mass, `damping` likewise (1/time),
    /// `speed` the relative speed (length/time). The force never pulls.
    pub fn impact(self, stiffness: f64, damping: f64, speed: f64) -> HeadOnImpact {
        let acceleration = |depth: f64, speed: f64| {
            (-stiffness * depth.max(0.0).powf(self.exponent()) - damping * speed).min(0.0)
        };
        // Deepest overlap of the undamped impact.
        let deepest =
            (0.5 * (self.exponent() + 1.0) * speed * speed / stiffness).powf(1.0 / (self.exponent() + 1.0));
        let dt = deepest / speed / IMPACT_STEPS;
        let (mut depth, mut v, mut steps) = (0.0, speed, 0.0);
        while (depth > 0.0 || steps == 0.0) && steps < MOST_IMPACT_STEPS {
            // Second-order Runge–Kutta: far more precise than its uses require.
            let half = v + 0.5 * dt * acceleration(depth, v);
            let middle = depth + 0.5 * dt * v;
            v += dt * acceleration(middle, half);
            depth += dt * half;
            steps += 1.0;
        }
        HeadOnImpact { restitution: (-v / speed).max(0.0), duration: steps * dt }
    }
}

/// Steps per time to reach the deepest overlap at full speed, and the limit of all steps.
const IMPACT_STEPS: f64 = 2000.0;
const MOST_IMPACT_STEPS: f64 = 200_000.0;

/// Quantities that follow from the spring of a contact.
impl Contact {
    /// Force of an overlap (length, at least 0), k ξ^p.
    #[inline(always)]
    pub fn elastic<V: Vector>(&self, uniform: impl Fn(f64) -> V, overlap: V) -> V {
        uniform(self.stiffness) * self.spring.power(overlap)
    }

    /// Energy stored by an overlap (length, at least 0), k ξ^(p + 1)/(p + 1).
    #[inline(always)]
    pub fn energy<V: Vector>(&self, uniform: impl Fn(f64) -> V, overlap: V) -> V {
        match self.spring {
            Spring::Hertz => uniform(0.4 * self.stiffness) * overlap * overlap * overlap.sqrt(),
            Spring::Linear => uniform(0.5 * self.stiffness) * overlap * overlap,
        }
    }

    /// Stiffness of a contact at an overlap (length), p k ξ^(p − 1) (force/length).
    pub fn stiffness_at(&self, overlap: f64) -> f64 {
        match self.spring {
            Spring::Hertz => 1.5 * self.stiffness * overlap.sqrt(),
            Spring::Linear => self.stiffness,
        }
    }

    /// Overlap (length) at rest under a force.
    pub fn depth_under(&self, force: f64) -> f64 {
        (force / self.stiffness).powf(1.0 / self.spring.exponent())
    }

    /// Largest overlap (length) of an undamped head-on impact with effective mass m and speed v (length/time): there the stored
    /// energy is ½ m v².
    pub fn impact_depth(&self, effective_mass: f64, speed: f64) -> f64 {
        let power = self.spring.exponent() + 1.0;
        (0.5 * power * effective_mass * speed * speed / self.stiffness).powf(1.0 / power)
    }

    /// Duration of such an impact (time); infinite at rest.
    pub fn impact_duration(&self, effective_mass: f64, speed: f64) -> f64 {
        self.spring.duration() * self.impact_depth(effective_mass, speed) / speed
    }

    /// Factor by which the impact depth grows if the speed grows by `faster`.
    pub fn depth_of_faster(&self, faster: f64) -> f64 {
        faster.powf(2.0 / (self.spring.exponent() + 1.0))
    }

    /// Stiffness that reduces the impact depth by the factor `less`.
    pub fn stiffness_for_impact(&self, less: f64) -> f64 {
        self.stiffness * less.powf(self.spring.exponent() + 1.0)
    }

    /// Stiffness that reduces the overlap at rest by the factor `less`.
    pub fn stiffness_for_rest(&self, less: f64) -> f64 {
        self.stiffness * less.powf(self.spring.exponent())
    }
}
