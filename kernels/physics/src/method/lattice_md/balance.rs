//! The balance of energy along a run.

use super::Totals;
use crate::domain::Domain;
use crate::observe::{Observation, Scenery, Sums};
use crate::particles::{Particle, Particles};

/// What the energy of the grains is held against: what was there at the start, what gravity and walls have put in, and what
/// contacts have taken out.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Work {
    way: Way,
    /// Kinetic, rotational and elastic energy at the start.
    start: f64,
}

/// What gravity does to grains on their way from where they were at the start.
#[derive(Clone, Debug, PartialEq)]
pub struct Way {
    domain: Domain,
    gravity: [f64; 2],
    /// Grains at the start, as if there were no sides (length); none where nothing pulls.
    from: Vec<[f64; 2]>,
}

impl Way {
    /// From where grains stand, who have crossed so many periods; they are asked for only where something pulls.
    pub(super) fn begin(
        scenery: &Scenery,
        crossings: &[[f64; 2]],
        standing: impl FnOnce() -> Particles,
    ) -> Way {
        let Scenery { domain, gravity, .. } = *scenery;
        let mut way = Way { domain, gravity, from: vec![] };
        if gravity != [0.0; 2] {
            let standing = standing();
            let places = standing.grains().iter().map(Particle::place).enumerate();
            way.from = places.map(|(number, place)| way.unfolded(number, place, crossings)).collect();
        }
        way
    }

    /// A position (length), as the state has it, with the periods that the grain has crossed.
    fn unfolded(&self, number: usize, position: [f64; 2], crossings: &[[f64; 2]]) -> [f64; 2] {
        let periods = crossings.get(number).copied().unwrap_or_default();
        // Along an axis that is not periodic nothing is crossed.
        [0, 1].map(|axis| position[axis] + periods[axis] * self.domain.length(axis))
    }

    /// What gravity has done to a grain that is now at a position (energy).
    pub(super) fn work(
        &self,
        number: usize,
        grain: &Particle,
        position: [f64; 2],
        crossings: &[[f64; 2]],
    ) -> f64 {
        let (from, now) = (self.from[number], self.unfolded(number, position, crossings));
        // Where nothing pulls, nothing is followed, and the way may be an image's.
        let pulling = (0..2).filter(|&axis| self.gravity[axis] != 0.0);
        grain.mass * pulling.map(|axis| self.gravity[axis] * (now[axis] - from[axis])).sum::<f64>()
    }
}

/// Energies since the start (mass · length²/time²).
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Balance {
    /// What contacts have turned into heat: summed up contact by contact, step by step.
    pub dissipated: f64,
    /// What gravity has put in.
    pub(crate) gravity_work: f64,
    /// What moving walls have put in.
    pub wall_work: f64,
    /// The energy that there is, less what there should be: the error of the integration, of the steps and of rounding.
    pub(crate) balance_error: f64,
}

impl Work {
    /// From the first observation on.
    pub(super) fn begin(way: Way, first: &Observation) -> Work {
        Work { way, start: inner(first) }
    }

    /// The way of the grains.
    pub(super) fn way(&self) -> &Way {
        &self.way
    }

    /// The energy that there was at the start, and what gravity and walls have put in or taken out since.
    pub(super) fn passed(&self, balance: &Balance) -> f64 {
        self.start + balance.gravity_work.abs() + balance.wall_work.abs()
    }

    /// The balance of a moment.
    pub(super) fn balance(&self, now: &Observation, sums: &Sums, totals: &Totals) -> Balance {
        let Totals { dissipated, wall_work, .. } = *totals;
        let gravity_work = sums.grains.gravity_work;
        let balance_error = inner(now) - self.start - gravity_work - wall_work + dissipated;
        Balance { dissipated, gravity_work, wall_work, balance_error }
    }
}

fn inner(seen: &Observation) -> f64 {
    seen.kinetic + seen.rotational + seen.elastic
}
