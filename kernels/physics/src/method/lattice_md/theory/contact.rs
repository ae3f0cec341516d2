//! Duration, depth and stiffness of an undamped contact.

use stripmine_kernels::law::granular::Contact;

/// Contact of two discs that approach each other head on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HeadOn {
    pub law: Contact,
    /// Speed of approach (length/time).
    pub speed: f64,
    /// Effective mass m₁ m₂/(m₁ + m₂) (mass).
    pub(crate) effective_mass: f64,
}

impl HeadOn {
    /// Largest overlap (length).
    pub(crate) fn depth(&self) -> f64 {
        self.law.impact_depth(self.effective_mass, self.speed)
    }

    /// Duration (time); infinite at rest.
    pub(crate) fn duration(&self) -> f64 {
        self.law.impact_duration(self.effective_mass, self.speed)
    }

    /// Squared angular frequency of a spring as stiff as the contact at its deepest (1/time²).
    pub(crate) fn stiffest(&self) -> f64 {
        self.law.stiffness_at(self.depth()) / self.effective_mass
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_kernels::integrator::single::SingleFreedom;
    use stripmine_kernels::integrator::velocity_verlet::VelocityVerlet;
    use stripmine_kernels::law::granular::ContactArm;
    use stripmine_kernels::law::spring::Spring;

    fn head_on(spring: Spring) -> HeadOn {
        let law = Contact {
            spring,
            stiffness: 300.0,
            normal_damping: 0.0,
            shear_damping: 0.0,
            friction: 0.0,
            cohesionless: true,
            arm: ContactArm::Radius,
        };
        HeadOn { law, speed: 0.7, effective_mass: 0.4 }
    }

    /// Compared with a contact integrated in 10⁵ steps.
    #[test]
    fn duration_and_depth_match_an_integrated_contact() {
        for spring in [Spring::Hertz, Spring::Linear] {
            let contact = head_on(spring);
            let force = |overlap: f64, _: f64| {
                -contact.law.elastic(|number| number, overlap.max(0.0)) / contact.effective_mass
            };
            let dt = contact.duration() / 1e5;
            let mut single = SingleFreedom::new(VelocityVerlet, dt).starting(0.0, contact.speed, force);
            let (mut deepest, mut steps) = (0.0, 0);
            while single.motion()[0] >= 0.0 {
                single.step(force);
                deepest = f64::max(deepest, single.motion()[0]);
                steps += 1;
            }
            assert!((f64::from(steps) / 1e5 - 1.0).abs() < 1e-4, "{spring:?}: {steps}");
            assert!((deepest / contact.depth() - 1.0).abs() < 1e-6, "{spring:?}: {deepest}");
        }
    }

    /// Energy, stiffness and depth at rest are consistent with the force.
    #[test]
    fn spring_quantities_are_consistent_with_the_force() {
        let number = |number: f64| number;
        for spring in [Spring::Hertz, Spring::Linear] {
            let law = head_on(spring).law;
            let (overlap, h) = (0.03, 1e-6);
            let slope = |of: &dyn Fn(f64) -> f64| (of(overlap + h) - of(overlap - h)) / (2.0 * h);
            let force = law.elastic(number, overlap);
            assert!((slope(&|x| law.energy(number, x)) / force - 1.0).abs() < 1e-8, "{spring:?}");
            let stiffness = law.stiffness_at(overlap);
            assert!((slope(&|x| law.elastic(number, x)) / stiffness - 1.0).abs() < 1e-8, "{spring:?}");
            assert!((law.depth_under(force) / overlap - 1.0).abs() < 1e-14, "{spring:?}");
            let stiffer = Contact { stiffness: law.stiffness_for_rest(2.0), ..law };
            assert!((stiffer.depth_under(force) / (0.5 * overlap) - 1.0).abs() < 1e-14, "{spring:?}");
            let stiffer = Contact { stiffness: law.stiffness_for_impact(2.0), ..law };
            let depths = [law.impact_depth(0.4, 0.7), stiffer.impact_depth(0.4, 0.7)];
            assert!((depths[1] / (0.5 * depths[0]) - 1.0).abs() < 1e-14, "{spring:?}");
            let faster = law.impact_depth(0.4, 3.0 * 0.7) / depths[0];
            assert!((faster / law.depth_of_faster(3.0) - 1.0).abs() < 1e-14, "{spring:?}");
        }
    }
}
