//! Energy balance along a run.

use super::GranularTotals;
use crate::domain::Domain;
use crate::observe::{Observation, ObservationSums, SceneProperties};
use crate::particles::{Particle, Particles};

/// Terms that the energy of the grains is compared with: the start energy, the work of gravity and walls, and the dissipation in contacts.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct BalanceTerms {
    path: GravityPath,
    /// Kinetic, rotational and elastic energy at the start.
    start: f64,
}

/// Work of gravity on grains along their displacement since the start.
#[derive(Clone, Debug, PartialEq)]
pub struct GravityPath {
    domain: Domain,
    gravity: [f64; 2],
    /// Unwrapped positions of grains at the start (length); empty without gravity.
    from: Vec<[f64; 2]>,
}

impl GravityPath {
    /// Starts from the grains' positions and crossed periods; the positions are computed only with gravity.
    pub(super) fn begin(
        scenery: &SceneProperties,
        crossings: &[[f64; 2]],
        standing: impl FnOnce() -> Particles,
    ) -> GravityPath {
        let SceneProperties { domain, gravity, .. } = *scenery;
        let mut path = GravityPath { domain, gravity, from: vec![] };
        if gravity != [0.0; 2] {
            let standing = standing();
            let places = standing.grains().iter().map(Particle::planar_position).enumerate();
            path.from = places.map(|(number, place)| path.unfolded(number, place, crossings)).collect();
        }
        path
    }

    /// Unwraps a position (length) with the periods that the grain has crossed.
    fn unfolded(&self, number: usize, position: [f64; 2], crossings: &[[f64; 2]]) -> [f64; 2] {
        let periods = crossings.get(number).copied().unwrap_or_default();
        // Crossings are zero along an axis that is not periodic.
        [0, 1].map(|axis| position[axis] + periods[axis] * self.domain.length(axis))
    }

    /// Work of gravity on a grain since the start (energy).
    pub(super) fn work(
        &self,
        number: usize,
        grain: &Particle,
        position: [f64; 2],
        crossings: &[[f64; 2]],
    ) -> f64 {
        let (from, now) = (self.from[number], self.unfolded(number, position, crossings));
        // Without gravity along an axis its crossings are not tracked, and the displacement may be that of an image.
        let pulling = (0..2).filter(|&axis| self.gravity[axis] != 0.0);
        grain.mass * pulling.map(|axis| self.gravity[axis] * (now[axis] - from[axis])).sum::<f64>()
    }
}

/// Energies since the start (mass · length²/time²).
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct EnergyBalance {
    /// Energy dissipated in contacts: summed contact by contact, step by step.
    pub dissipated: f64,
    /// Work of gravity.
    pub(crate) gravity_work: f64,
    /// Work of moving walls.
    pub wall_work: f64,
    /// Actual minus expected energy: the error of integration, steps and rounding.
    pub(crate) balance_error: f64,
}

impl BalanceTerms {
    /// Starts at the first observation.
    pub(super) fn begin(path: GravityPath, first: &Observation) -> BalanceTerms {
        BalanceTerms { path, start: internal_energy(first) }
    }

    /// Returns the path along which gravity does work.
    pub(super) fn gravity_path(&self) -> &GravityPath {
        &self.path
    }

    /// Scale of the balance: energy at the start plus the magnitudes of gravity work and wall work since.
    pub(super) fn energy_scale(&self, balance: &EnergyBalance) -> f64 {
        self.start + balance.gravity_work.abs() + balance.wall_work.abs()
    }

    /// Returns the balance of a moment.
    pub(super) fn balance(
        &self,
        now: &Observation,
        sums: &ObservationSums,
        totals: &GranularTotals,
    ) -> EnergyBalance {
        let GranularTotals { dissipated, wall_work, .. } = *totals;
        let gravity_work = sums.grains.gravity_work;
        let balance_error = internal_energy(now) - self.start - gravity_work - wall_work + dissipated;
        EnergyBalance { dissipated, gravity_work, wall_work, balance_error }
    }
}

fn internal_energy(seen: &Observation) -> f64 {
    seen.kinetic + seen.rotational + seen.elastic
}
