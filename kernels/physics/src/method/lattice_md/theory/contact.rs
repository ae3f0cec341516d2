//! An undamped Hertz contact: how long it lasts, how deep and how stiff it becomes.

/// Duration over depth/speed: 2 ∫ (1 − x^(5/2))^(−1/2) dx from 0 to 1.
const DURATION: f64 = 2.943_275;

/// A contact of two discs that approach each other head on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HertzContact {
    /// Speed of approach (length/time).
    pub speed: f64,
    /// Stiffness k of the force k ξ^(3/2) (force/length^1.5).
    pub stiffness: f64,
    /// Effective mass m₁ m₂/(m₁ + m₂) (mass).
    pub effective_mass: f64,
}

impl HertzContact {
    /// Largest overlap ξ (length): where ⅖ k ξ^(5/2) is the energy ½ m v².
    pub fn depth(&self) -> f64 {
        (1.25 * self.effective_mass * self.speed * self.speed / self.stiffness).powf(0.4)
    }

    /// How long it lasts (time); infinite at rest.
    pub fn duration(&self) -> f64 {
        DURATION * self.depth() / self.speed
    }

    /// Square of the angular frequency of a spring that is as stiff as the contact where it is deepest (1/time²).
    pub fn stiffest(&self) -> f64 {
        1.5 * self.stiffness * self.depth().sqrt() / self.effective_mass
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_kernels::integrator::single::Single;
    use stripmine_kernels::integrator::velocity_verlet::VelocityVerlet;

    /// The contact followed in 10⁵ steps.
    #[test]
    fn duration_and_depth_are_those_of_a_contact_that_is_followed() {
        let contact = HertzContact { speed: 0.7, stiffness: 300.0, effective_mass: 0.4 };
        let force = |overlap: f64, _: f64| {
            -contact.stiffness / contact.effective_mass * overlap.max(0.0) * overlap.max(0.0).sqrt()
        };
        let dt = contact.duration() / 1e5;
        let mut single = Single::new(VelocityVerlet, dt).starting(0.0, contact.speed, force);
        let (mut deepest, mut steps) = (0.0, 0);
        while single.motion()[0] >= 0.0 {
            single.step(force);
            deepest = f64::max(deepest, single.motion()[0]);
            steps += 1;
        }
        assert!((f64::from(steps) / 1e5 - 1.0).abs() < 1e-4, "{steps}");
        assert!((deepest / contact.depth() - 1.0).abs() < 1e-6, "{deepest}");
    }
}
