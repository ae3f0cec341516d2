//! Trial contacts: head-on collisions of two typical grains, integrated with the scene's own scheme and step.

use super::contact::HeadOn;
use crate::method::lattice_md::model::{GearValues, GranularScheme};
use stripmine_kernels::integrator;
use stripmine_kernels::integrator::gear::{Acceleration, Gear};
use stripmine_kernels::integrator::single::SingleFreedom;
use stripmine_kernels::integrator::velocity_verlet::VelocityVerlet;

/// Number of phases within a step at which contacts begin.
const PHASES: u32 = 16;
/// Step of the reference, in steps.
const REFERENCE: f64 = 1.0 / 16.0;
/// Largest number of steps in a trial contact.
const MOST: f64 = 1000.0;
/// Duration, in undamped contacts, after which a contact counts as endless.
const ENDLESS: f64 = 20.0;

/// Integration error of a contact.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub(crate) struct ContactError {
    /// Error of the energy after the contact over the energy before: root mean square over the phases of the step.
    pub energy: f64,
    /// Power of the step with which the error falls, estimated from half the step.
    pub order: f64,
    /// Step of the trials (time): the scene's own, or a thousandth of the contact if that is longer.
    pub step: f64,
    /// Number of trial contacts.
    pub phases: u32,
}

/// Measures the error in trial contacts; none where nothing moves, or discs do not separate again.
pub(crate) fn contact_error(contact: HeadOn, scheme: GranularScheme, dt: f64) -> Option<ContactError> {
    let duration = contact.duration();
    if !(duration.is_finite() && duration > 0.0) {
        return None;
    }
    let step = dt.max(duration / MOST);
    let trial = TrialContact(contact);
    let after =
        |step: f64, phase: u32| trial.energy_after(scheme, step, f64::from(phase) / f64::from(PHASES));
    let reference = after(REFERENCE * step, 0)?;
    let error = |step: f64| {
        let off = (0..PHASES).map(|phase| Some((after(step, phase)? - reference).powi(2)));
        Some((off.sum::<Option<f64>>()? / f64::from(PHASES)).sqrt())
    };
    let energy = error(step)?;
    let order = libm::log2(energy / error(0.5 * step)?);
    Some(ContactError { energy, order, step, phases: PHASES })
}

struct TrialContact(HeadOn);

impl TrialContact {
    /// Returns the energy after the contact over that before, if the contact begins a fraction `phase` of a step late.
    fn energy_after(&self, scheme: GranularScheme, step: f64, phase: f64) -> Option<f64> {
        let kind = match self.0.law.normal_damping {
            0.0 => Acceleration::OfPositions,
            _ => Acceleration::OfVelocities,
        };
        match scheme {
            GranularScheme::Gear(GearValues::Four) => self.followed(Gear::<4>::new(kind), step, phase),
            GranularScheme::Gear(GearValues::Five) => self.followed(Gear::<5>::new(kind), step, phase),
            GranularScheme::Gear(GearValues::Six) => self.followed(Gear::<6>::new(kind), step, phase),
            GranularScheme::VelocityVerlet => self.followed(VelocityVerlet, step, phase),
        }
    }

    fn acceleration(&self, overlap: f64, velocity: f64) -> f64 {
        if overlap <= 0.0 {
            return 0.0;
        }
        let HeadOn { law, effective_mass, .. } = self.0;
        let push = law.elastic(|number| number, overlap) / effective_mass + law.normal_damping * velocity;
        -if law.cohesionless { push.max(0.0) } else { push }
    }

    fn followed<C: integrator::Scheme>(&self, scheme: C, step: f64, phase: f64) -> Option<f64> {
        let speed = self.0.speed;
        // Starts a whole step and a fraction before the contact, so that the first derivatives are those of free flight.
        let gap = (1.0 + phase) * speed * step;
        let mut single = SingleFreedom::new(scheme, step).starting(-gap, speed, |_, _| 0.0);
        let most = (ENDLESS * self.0.duration() / step) as u64 + 64;
        for _ in 0..most {
            single.step(|overlap, velocity| self.acceleration(overlap, velocity));
            let [overlap, velocity] = single.motion();
            if !velocity.is_finite() {
                return None;
            }
            // Discs that have passed through each other have not separated.
            if overlap < -gap && velocity < 0.0 {
                return Some((velocity / speed).powi(2));
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_kernels::law::granular::{Contact, ContactArm};
    use stripmine_kernels::law::spring::Spring;

    fn error(damping: f64, scheme: GranularScheme, steps: f64) -> ContactError {
        let law = Contact {
            spring: Spring::Hertz,
            stiffness: 1e4,
            normal_damping: damping,
            shear_damping: 0.0,
            friction: 0.0,
            cohesionless: true,
            arm: ContactArm::Radius,
        };
        let contact = HeadOn { law, speed: 0.5, effective_mass: 0.5 };
        contact_error(contact, scheme, contact.duration() / steps).unwrap()
    }

    /// The kink of Hertz's force limits velocity Verlet to an order of 2½, the jump of the damping any scheme to 1.
    #[test]
    fn error_order_is_limited_by_the_law() {
        let elastic = error(0.0, GranularScheme::VelocityVerlet, 60.0);
        assert!((elastic.order - 2.5).abs() < 0.3, "{elastic:?}");
        for scheme in [GranularScheme::VelocityVerlet, GranularScheme::Gear(GearValues::Five)] {
            let damped = error(4.0, scheme, 60.0);
            assert!((damped.order - 1.0).abs() < 0.3, "{damped:?}");
        }
    }

    #[test]
    fn contact_error_falls_with_more_steps() {
        let scheme = GranularScheme::Gear(GearValues::Four);
        let [few, many] = [4.0, 100.0].map(|steps| error(0.0, scheme, steps).energy);
        assert!(few > 0.03 && many < 1e-3, "{few} {many}");
        // Beyond a thousand steps the reported error is an upper bound.
        let finest = error(0.0, scheme, 1e6);
        assert!(finest.energy <= many && finest.step > 0.0);
    }
}
