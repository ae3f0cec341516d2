//! Observables of particles, independent of the method.

mod contacts;
mod grains;
mod thermal;
pub mod waves;

pub use contacts::{ContactSums, contacts};
pub use grains::GrainSums;
pub use thermal::AxisMotion;
pub(crate) use thermal::{conserved_axes, relative_energy_error, temperature};

use crate::domain::Domain;
use crate::particles::{Particle, Particles};
use contacts::WrappedDiscs;
use serde::Serialize;
use std::ops::Range;
use stripmine_kernels::law::granular::Contact;
use stripmine_kernels::over_parts;

/// Properties of a scene that observables depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneProperties {
    /// Box.
    pub domain: Domain,
    /// Contact law.
    pub contact: Contact,
    /// Acceleration of gravity (length/time²).
    pub gravity: [f64; 2],
    /// Moment of inertia of a disc of mass and radius 1; 0 without rotation.
    pub inertia_factor: f64,
}

/// Observables of one moment. Energies in mass · length²/time².
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Observation {
    /// Number of the step.
    pub step: u64,
    /// Simulated time.
    pub time: f64,
    /// Kinetic energy of the grains' translation.
    pub kinetic: f64,
    /// Kinetic energy of the grains' rotation.
    pub rotational: f64,
    /// Elastic energy of the contacts.
    pub elastic: f64,
    /// Potential energy in gravity, relative to the box's corner; jumps when a grain crosses a periodic side along gravity.
    pub gravitational: f64,
    /// Momentum of the grains along x (mass · length/time).
    pub momentum_x: f64,
    /// Momentum of the grains along y.
    pub momentum_y: f64,
    /// Temperature of the grains' translation (`temperature()`), relative to the mean motion along periodic axes.
    pub temperature: f64,
    /// Pressure of the grains (force/length): (K + ½ Σ F_N |r_i − r_j|)/A over the contacts between grains, with their kinetic energy K relative to
    /// the mean motion along periodic axes and the area A of the whole box.
    pub pressure: f64,
    /// Mean velocity of the grains along gravity, or along x without gravity (length/time).
    pub flow: f64,
    /// Deepest contact (fraction of the sum of the radii).
    pub deepest_penetration: f64,
    /// Number of contacts with at least one grain.
    pub contacts: u64,
}

/// Sums over the discs of a moment, computed once for all observables.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ObservationSums {
    /// Sums over the grains.
    pub grains: GrainSums,
    /// Sums over the contacts.
    pub contacts: ContactSums,
}

impl ObservationSums {
    /// Sums over particles, in parallel by tasks. `work` returns the work of gravity on a grain, by its number; it is called with gravity only.
    pub(crate) fn over_parts(
        particles: &Particles,
        scenery: &SceneProperties,
        work: impl Fn(usize, &Particle, [f64; 2]) -> f64 + Sync,
    ) -> ObservationSums {
        let discs = WrappedDiscs::new(particles, &scenery.domain);
        let parts = over_parts(0..particles.grain_count(), |grains| {
            ObservationSums::over(grains, &discs, particles, scenery, &work)
        });
        let mut sums = ObservationSums::default();
        for part in &parts {
            sums.grains.join(&part.grains);
            sums.contacts.join(&part.contacts);
        }
        sums
    }

    /// Sums over some grains, one after the other.
    fn over(
        grains: Range<usize>,
        discs: &WrappedDiscs<'_>,
        particles: &Particles,
        scenery: &SceneProperties,
        work: impl Fn(usize, &Particle, [f64; 2]) -> f64,
    ) -> ObservationSums {
        let mut sums = GrainSums::default();
        for number in grains.clone() {
            let grain = &particles.all()[number];
            sums.add(scenery, grain, grain.planar_velocity(), grain.omega, || discs.place(number));
            if scenery.gravity != [0.0; 2] {
                sums.gravity_work += work(number, grain, grain.planar_position());
            }
        }
        ObservationSums { grains: sums, contacts: ContactSums::over(grains, discs, &scenery.contact) }
    }
}

impl Observation {
    /// Observes particles sequentially.
    pub fn of(step: u64, time: f64, particles: &Particles, scenery: &SceneProperties) -> Observation {
        let (discs, grains) = (WrappedDiscs::new(particles, &scenery.domain), 0..particles.grain_count());
        Observation::new(
            step,
            time,
            &ObservationSums::over(grains, &discs, particles, scenery, |_, _, _| 0.0),
            scenery,
        )
    }

    /// Observation from sums.
    pub fn new(step: u64, time: f64, sums: &ObservationSums, scenery: &SceneProperties) -> Observation {
        let ObservationSums { grains, contacts } = sums;
        let [momentum_x, momentum_y] = grains.momentum;
        let mut seen = Observation {
            step,
            time,
            kinetic: grains.kinetic,
            rotational: grains.rotational,
            elastic: contacts.elastic,
            gravitational: grains.gravitational,
            momentum_x,
            momentum_y,
            deepest_penetration: contacts.deepest,
            contacts: contacts.count,
            ..Observation::default()
        };
        let (n, conserved) = (grains.count as f64, conserved_axes(&scenery.domain));
        let mut thermal = grains.kinetic;
        if grains.count > 0 {
            seen.temperature = temperature(grains.motion(), conserved, grains.mass, n);
            let [along_x, along_y] =
                [0, 1].map(|axis| if conserved[axis] { grains.momentum[axis].powi(2) } else { 0.0 });
            thermal -= (along_x + along_y) / (2.0 * grains.mass);
            let gravity = scenery.gravity;
            let strength = gravity[0].hypot(gravity[1]);
            let along = if strength > 0.0 { gravity.map(|g| g / strength) } else { [1.0, 0.0] };
            seen.flow = (grains.velocity[0] * along[0] + grains.velocity[1] * along[1]) / n;
        }
        seen.pressure = (thermal + 0.5 * contacts.virial) / scenery.domain.area();
        seen
    }

    /// Total energy.
    pub fn energy(&self) -> f64 {
        self.kinetic + self.rotational + self.elastic + self.gravitational
    }
}
