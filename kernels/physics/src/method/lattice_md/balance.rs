//! Energy balance along a run.

use super::GranularTotals;
use crate::domain::Domain;
use crate::io::checkpoint::CheckpointColumn;
use crate::method::Snapshot;
use crate::observe::{Observation, ObservationSums, SceneProperties};
use crate::particles::{Particle, Particles};

/// Terms that the energy of the grains is compared with: the start energy, the work of gravity and walls, and the dissipation in contacts.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct BalanceTerms {
    path: GravityPath,
    /// Kinetic, rotational and elastic energy at the start.
    start: f64,
    /// Work of gravity before the path, while gravity had other values.
    earlier: f64,
}

/// Work of gravity on grains along their displacement since the start, or since gravity was changed.
#[derive(Clone, Debug, PartialEq)]
pub struct GravityPath {
    domain: Domain,
    gravity: [f64; 2],
    /// Unwrapped positions of grains there (length); empty without gravity.
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

    /// Positions at the start of the path along an axis (length).
    fn start_along(&self, axis: usize) -> Vec<f64> {
        self.from.iter().map(|place| place[axis]).collect()
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
    /// Work of changes by the user.
    #[serde(skip_serializing_if = "is_zero")]
    pub(crate) work_of_changes: f64,
    /// Actual minus expected energy: the error of integration, steps and rounding.
    pub(crate) balance_error: f64,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
fn is_zero(work: &f64) -> bool {
    *work == 0.0
}

/// Names of the work of gravity before its last change, and of the path since then, in a checkpoint.
const EARLIER: &str = "steered.gravity_work";
const FROM: [&str; 2] = ["steered.from.x", "steered.from.y"];

impl BalanceTerms {
    /// Starts at the first observation.
    pub(super) fn begin(path: GravityPath, first: &Observation) -> BalanceTerms {
        BalanceTerms { path, start: internal_energy(first), earlier: 0.0 }
    }

    /// Begins another path after gravity has done `earlier` work (energy).
    pub(super) fn change_gravity(&mut self, path: GravityPath, earlier: f64) {
        (self.path, self.earlier) = (path, earlier);
    }

    /// Adds the path since a change of gravity to a snapshot.
    pub(super) fn keep_path(&self, kept: &mut Snapshot) {
        kept.add_sum(EARLIER, self.earlier);
        for (axis, name) in FROM.into_iter().enumerate() {
            kept.add_column(name, CheckpointColumn::F64(self.path.start_along(axis)));
        }
    }

    /// Restores the path since a change of gravity.
    ///
    /// # Errors
    /// Says what is missing.
    pub(super) fn restore_path(
        &mut self,
        scenery: &SceneProperties,
        grains: usize,
        kept: &Snapshot,
    ) -> Result<(), String> {
        let SceneProperties { domain, gravity, .. } = *scenery;
        let count = if gravity == [0.0; 2] { 0 } else { grains };
        let along = [kept.numbers(FROM[0], count)?, kept.numbers(FROM[1], count)?];
        let from = (0..count).map(|grain| along.map(|places| places[grain])).collect();
        self.change_gravity(GravityPath { domain, gravity, from }, kept.sum(EARLIER)?);
        Ok(())
    }

    /// Returns the path along which gravity does work.
    pub(super) fn gravity_path(&self) -> &GravityPath {
        &self.path
    }

    /// Scale of the balance: energy at the start plus the magnitudes of gravity work and wall work since.
    pub(super) fn energy_scale(&self, balance: &EnergyBalance) -> f64 {
        self.start + balance.gravity_work.abs() + balance.wall_work.abs() + balance.work_of_changes.abs()
    }

    /// Returns the balance of a moment.
    pub(super) fn balance(
        &self,
        now: &Observation,
        sums: &ObservationSums,
        totals: &GranularTotals,
        work_of_changes: f64,
    ) -> EnergyBalance {
        let GranularTotals { dissipated, wall_work, .. } = *totals;
        let gravity_work = self.earlier + sums.grains.gravity_work;
        let error = internal_energy(now) - self.start - gravity_work - wall_work + dissipated;
        let balance_error = error - work_of_changes;
        EnergyBalance { dissipated, gravity_work, wall_work, work_of_changes, balance_error }
    }
}

/// Kinetic, rotational and elastic energy.
pub(super) fn internal_energy(seen: &Observation) -> f64 {
    seen.kinetic + seen.rotational + seen.elastic
}
