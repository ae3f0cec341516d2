//! Sums over the grains.

use super::{AxisMotion, SceneProperties};
use crate::particles::Particle;

/// Sums over the grains at one moment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GrainSums {
    /// Number of grains.
    pub count: u64,
    /// Total mass.
    pub mass: f64,
    /// Kinetic energy of translation.
    pub kinetic: f64,
    /// Σ m v² along x and y (energy).
    pub(crate) twice_kinetic: [f64; 2],
    /// Kinetic energy of rotation.
    pub rotational: f64,
    /// Potential energy in gravity, relative to the box's corner.
    pub gravitational: f64,
    /// Total momentum (mass · length/time).
    pub momentum: [f64; 2],
    /// Sum of the velocities (length/time).
    pub velocity: [f64; 2],
    /// Sum of the squared velocities (length²/time²).
    pub square: f64,
    /// Work of gravity since the start (energy).
    pub(crate) gravity_work: f64,
}

impl GrainSums {
    /// Adds a grain of the mass and radius of `grain` with a velocity (length/time) and a spin (1/time). `place` returns its position inside the
    /// box (length); it is called with gravity only.
    #[inline]
    pub fn add(
        &mut self,
        scenery: &SceneProperties,
        grain: &Particle,
        velocity: [f64; 2],
        omega: f64,
        place: impl FnOnce() -> [f64; 2],
    ) {
        let SceneProperties { domain, gravity, inertia_factor, .. } = scenery;
        let Particle { mass, radius, .. } = *grain;
        let square = velocity[0] * velocity[0] + velocity[1] * velocity[1];
        self.count += 1;
        self.mass += mass;
        self.kinetic += 0.5 * mass * square;
        let inertia = inertia_factor * mass * radius * radius;
        self.rotational += 0.5 * inertia * omega * omega;
        self.square += square;
        for (axis, along) in velocity.into_iter().enumerate() {
            self.momentum[axis] += mass * along;
            self.twice_kinetic[axis] += mass * along * along;
            self.velocity[axis] += along;
        }
        if *gravity != [0.0; 2] {
            let place = place();
            for axis in 0..2 {
                self.gravitational -= mass * gravity[axis] * (place[axis] - domain.origin[axis]);
            }
        }
    }

    /// Motion along x and y.
    pub fn motion(&self) -> [AxisMotion; 2] {
        [0, 1]
            .map(|axis| AxisMotion { twice_kinetic: self.twice_kinetic[axis], momentum: self.momentum[axis] })
    }

    /// Adds the sums of grains that follow.
    pub fn join(&mut self, more: &GrainSums) {
        self.count += more.count;
        self.mass += more.mass;
        self.kinetic += more.kinetic;
        self.rotational += more.rotational;
        self.gravitational += more.gravitational;
        self.square += more.square;
        self.gravity_work += more.gravity_work;
        for axis in 0..2 {
            self.momentum[axis] += more.momentum[axis];
            self.twice_kinetic[axis] += more.twice_kinetic[axis];
            self.velocity[axis] += more.velocity[axis];
        }
    }
}
