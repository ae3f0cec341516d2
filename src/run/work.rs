//! The balance of energy along a run.

use crate::domain::Domain;
use crate::observe::Observation;
use crate::particles::Particles;

/// What gravity has put in since the start, so that what contacts took out is known also where grains fall through a
/// periodic side again and again.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Work {
    /// Kinetic, rotational and elastic energy at the start.
    pub(super) start: f64,
    /// Work of gravity since the start.
    pub(super) gravity: f64,
    /// Grains when last looked at.
    pub(super) seen: Vec<[f64; 2]>,
}

impl Work {
    /// From the first observation on.
    pub(super) fn begin(seen: &Observation, particles: &Particles) -> Work {
        Work { start: inner(seen), gravity: 0.0, seen: positions(particles) }
    }

    /// Looks again, before any grain has crossed half a periodic side: energy dissipated since the start, less what
    /// moving walls put in.
    pub(super) fn dissipated(
        &mut self,
        seen: &Observation,
        particles: &Particles,
        domain: &Domain,
        gravity: [f64; 2],
    ) -> f64 {
        for (grain, &before) in particles.grains().iter().zip(&self.seen) {
            let [dx, dy] = domain.way(before, grain.position);
            self.gravity += grain.mass * (gravity[0] * dx + gravity[1] * dy);
        }
        self.seen = positions(particles);
        self.start + self.gravity - inner(seen)
    }
}

fn inner(seen: &Observation) -> f64 {
    seen.kinetic + seen.rotational + seen.elastic
}

fn positions(particles: &Particles) -> Vec<[f64; 2]> {
    particles.grains().iter().map(|grain| grain.position).collect()
}
