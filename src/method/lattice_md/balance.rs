//! The balance of energy along a run.

use super::{Engine, Totals};
use crate::domain::Domain;
use crate::observe::Observation;
use crate::particles::{Particle, Particles};

/// What the energy of the grains is held against: what was there at the start, what gravity and walls have put in, and what
/// contacts have taken out.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Work {
    domain: Domain,
    gravity: [f64; 2],
    /// Kinetic, rotational and elastic energy at the start.
    start: f64,
    /// Grains at the start.
    from: Vec<[f64; 2]>,
}

/// Energies since the start (mass · length²/time²).
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Balance {
    /// What contacts have turned into heat: summed up contact by contact, step by step.
    pub dissipated: f64,
    /// What gravity has put in.
    pub gravity_work: f64,
    /// What moving walls have put in.
    pub wall_work: f64,
    /// The energy that there is, less what there should be: the error of the integration, of the steps and of rounding.
    pub balance_error: f64,
}

impl Work {
    /// From the first observation on.
    pub(super) fn begin(
        seen: &Observation,
        particles: &Particles,
        domain: Domain,
        gravity: [f64; 2],
    ) -> Work {
        let from = particles.grains().iter().map(Particle::place).collect();
        Work { domain, gravity, start: inner(seen), from }
    }

    /// The energy that there was at the start, and what gravity and walls have put in or taken out since.
    pub(super) fn passed(&self, balance: &Balance) -> f64 {
        self.start + balance.gravity_work.abs() + balance.wall_work.abs()
    }

    /// The balance of a moment, with the particles as the state has them: consistent with the crossings counted.
    pub(super) fn balance(&self, seen: &Observation, particles: &Particles, engine: &dyn Engine) -> Balance {
        let crossings = engine.crossings();
        let mut gravity_work = 0.0;
        for (number, (grain, from)) in particles.grains().iter().zip(&self.from).enumerate() {
            let periods = crossings.get(number).copied().unwrap_or_default();
            let along = |axis: usize| {
                let way = (grain.position[axis] - from[axis]) + periods[axis] * self.domain.length(axis);
                self.gravity[axis] * way
            };
            // Where nothing pulls, nothing is followed, and the way may be an image's.
            gravity_work +=
                grain.mass * (0..2).filter(|&axis| self.gravity[axis] != 0.0).map(along).sum::<f64>();
        }
        let Totals { dissipated, wall_work, .. } = engine.totals();
        let balance_error = inner(seen) - self.start - gravity_work - wall_work + dissipated;
        Balance { dissipated, gravity_work, wall_work, balance_error }
    }
}

fn inner(seen: &Observation) -> f64 {
    seen.kinetic + seen.rotational + seen.elastic
}
