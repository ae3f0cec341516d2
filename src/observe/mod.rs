//! What is measured of particles, whatever method moves them.

pub mod waves;

use crate::domain::Domain;
use crate::near::Near;
use crate::particles::{Kind, Particle, Particles};
use serde::Serialize;
use stripmine_kernels::law::granular::{Contact, Disc, Granular};
use stripmine_kernels::sweep::pair::{Body, Pair};

/// The scene as observers see it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scenery {
    /// The box.
    pub domain: Domain,
    /// The contact law.
    pub contact: Contact,
    /// Acceleration of gravity (length/time²).
    pub gravity: [f64; 2],
    /// Moment of inertia of a disc of mass and radius 1; 0 without rotation.
    pub inertia_factor: f64,
}

/// One observation. Energies in mass · length²/time².
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Observation {
    /// The step.
    pub step: u64,
    /// The time.
    pub time: f64,
    /// Kinetic energy of the grains' translation.
    pub kinetic: f64,
    /// Kinetic energy of their rotation.
    pub rotational: f64,
    /// Energy of the Hertz contacts, ⅖ k_N ξ^{5/2} each.
    pub elastic: f64,
    /// Potential energy in gravity, from the box's corner; jumps where a grain crosses a periodic side along gravity.
    pub gravitational: f64,
    /// Momentum of the grains along x (mass · length/time).
    pub momentum_x: f64,
    /// Momentum of the grains along y.
    pub momentum_y: f64,
    /// Kinetic energy a grain and dimension, about the mean motion.
    pub temperature: f64,
    /// Pressure of the grains (force/length): (N T + ½ Σ F_N |r_i − r_j|)/A over the contacts between grains, with the
    /// temperature T and the area A of the whole box.
    pub pressure: f64,
    /// Mean velocity of the grains along gravity, or along x without gravity (length/time).
    pub flow: f64,
    /// The deepest contact (fraction of the sum of the radii).
    pub deepest_penetration: f64,
    /// Contacts with at least one grain.
    pub contacts: u64,
}

impl Observation {
    /// Observes particles.
    pub fn of(step: u64, time: f64, particles: &Particles, scenery: &Scenery) -> Observation {
        let Scenery { domain, contact, gravity, inertia_factor } = *scenery;
        let mut seen = Observation { step, time, ..Observation::default() };
        let grains = particles.grains();
        let mut mass = 0.0;
        let mut sum_velocity = [0.0; 2];
        for grain in grains {
            let [vx, vy] = grain.planar_velocity();
            seen.kinetic += 0.5 * grain.mass * (vx * vx + vy * vy);
            let inertia = inertia_factor * grain.mass * grain.radius * grain.radius;
            seen.rotational += 0.5 * inertia * grain.omega * grain.omega;
            for axis in 0..2 {
                let height = grain.position[axis] - domain.origin[axis];
                seen.gravitational -= grain.mass * gravity[axis] * height;
                sum_velocity[axis] += grain.velocity[axis];
            }
            seen.momentum_x += grain.mass * vx;
            seen.momentum_y += grain.mass * vy;
            mass += grain.mass;
        }
        if !grains.is_empty() {
            let n = grains.len() as f64;
            let drift =
                (seen.momentum_x * seen.momentum_x + seen.momentum_y * seen.momentum_y) / (2.0 * mass);
            seen.temperature = (seen.kinetic - drift) / n;
            let strength = gravity[0].hypot(gravity[1]);
            let along = if strength > 0.0 { gravity.map(|g| g / strength) } else { [1.0, 0.0] };
            seen.flow = (sum_velocity[0] * along[0] + sum_velocity[1] * along[1]) / n;
        }
        let all = particles.all();
        let mut virial = 0.0;
        for (i, j, penetration, reach) in contacts(particles, &domain) {
            let depth = penetration * reach;
            seen.contacts += 1;
            seen.elastic += contact.energy(|number| number, depth);
            seen.deepest_penetration = seen.deepest_penetration.max(penetration);
            if all[j].kind == Kind::Grain {
                virial += virial_of(&contact, &domain, &all[i], &all[j]);
            }
        }
        let area = domain.length(0) * domain.length(1);
        seen.pressure = (grains.len() as f64 * seen.temperature + 0.5 * virial) / area;
        seen
    }

    /// All energy there is.
    pub fn energy(&self) -> f64 {
        self.kinetic + self.rotational + self.elastic + self.gravitational
    }
}

/// (r_i − r_j)·F_i of two grains in contact (energy), damping included. Friction acts across the way between the centres
/// and has no part in it.
fn virial_of(contact: &Contact, domain: &Domain, grain: &Particle, partner: &Particle) -> f64 {
    let body = |particle: &Particle, [x, y]: [f64; 2]| Body {
        velocity: particle.planar_velocity(),
        radius: particle.radius,
        inverse_mass: 1.0 / particle.mass,
        ..Body::at(x, y)
    };
    // The law reads each disc's own radius and mass.
    let alike = Disc { radius: grain.radius, inverse_mass: 1.0 / grain.mass };
    let law = Granular::<false, false> { contact: *contact, disc: alike };
    let apart = domain.displacement(grain.place(), partner.place());
    Pair { bodies: [body(grain, apart), body(partner, [0.0; 2])] }.energy_and_virial(&law)[1]
}

/// Pairs in contact with at least one grain: the two, the penetration (fraction of the sum of the radii) and that sum
/// (length). In order of the first disc, then of the second.
pub fn contacts(particles: &Particles, domain: &Domain) -> Vec<(usize, usize, f64, f64)> {
    let all = particles.all();
    let Some([_, largest]) = particles.radii() else { return vec![] };
    let near = Near::among(*domain, all.iter().map(Particle::place), 2.0 * largest);
    let mut found = Vec::new();
    let mut partners = Vec::new();
    for (i, disc) in particles.grains().iter().enumerate() {
        partners.clear();
        partners.extend(near.of(disc.place()).map(|(number, _)| number as usize));
        partners.sort_unstable();
        for &j in &partners {
            let once = j > i || all[j].kind == Kind::Wall;
            if once && j != i {
                let [dx, dy] = domain.displacement(disc.place(), all[j].place());
                let reach = disc.radius + all[j].radius;
                let penetration = 1.0 - dx.hypot(dy) / reach;
                if penetration > 0.0 {
                    found.push((i, j, penetration, reach));
                }
            }
        }
    }
    found
}
