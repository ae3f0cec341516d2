//! Monitor of a run: largest energy error, and nearest encounter of two bodies.

use super::conserved::ConservedQuantities;
use super::encounter::NearestPair;
use crate::io::checkpoint::CheckpointColumn;
use crate::method::RunWarning;
use crate::number::{of_limit, significant};
use crate::observe::relative_energy_error;
use serde_json::{Value, json};

/// Checkpoint columns: energy and step of the largest error; both bodies, distance, position and step of the nearest encounter.
const WORST: &str = "largest_error";
const NEAREST: &str = "nearest_encounter";

/// Largest energy error without a warning.
const MOST: f64 = 0.01;
/// Fraction of the kinetic and potential energy that may be rounding.
const ROUNDING: f64 = 1e-6;

/// State of the monitor.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct EnergyMonitor {
    /// Energy at the start, and the work of changes since then.
    pub(super) start: f64,
    /// Kinetic energy at the start, and its sum with the magnitude of the potential energy.
    kinetic: f64,
    size: f64,
    /// Energy farthest from that at the start, and its step.
    worst: (f64, u64),
    /// Nearest encounter, and its step.
    nearest: Option<(NearestPair, u64)>,
}

impl EnergyMonitor {
    /// Starts the monitor.
    pub(super) fn new(start: &ConservedQuantities) -> EnergyMonitor {
        let energy = start.energy();
        let (kinetic, size) = (start.kinetic, start.kinetic + start.potential.abs());
        EnergyMonitor { start: energy, kinetic, size, worst: (energy, 0), nearest: None }
    }

    /// Adds work that is no error (energy).
    pub(super) fn add_work(&mut self, work: f64) {
        self.start += work;
        self.worst.0 += work;
    }

    /// Records a state after some steps.
    pub(super) fn record_state(&mut self, energy: f64, encounter: Option<NearestPair>, steps: u64) {
        if (energy - self.start).abs() > (self.worst.0 - self.start).abs() {
            self.worst = (energy, steps);
        }
        let known = self.nearest.map_or(f64::INFINITY, |(known, _)| known.distance);
        self.nearest = encounter.filter(|it| it.distance < known).map(|it| (it, steps)).or(self.nearest);
    }

    /// Relative error of an energy. The reference does not vanish: bodies that attract each other have a kinetic or a total energy.
    pub(super) fn relative(&self, energy: f64) -> f64 {
        relative_energy_error(energy - self.start, self.start, self.kinetic, 0.0)
    }

    /// True if bodies that were bound have become unbound.
    pub(super) fn is_unbound(&self, energy: f64) -> bool {
        self.start < 0.0 && energy >= 0.0 && energy - self.start > ROUNDING * self.size
    }

    /// Describes the nearest encounter; `id` gives the ids of bodies.
    pub(super) fn nearest_in_words(&self, id: impl Fn(usize) -> u32) -> Option<String> {
        let (NearestPair { bodies, distance, .. }, steps) = self.nearest?;
        let [first, second] = bodies.map(id);
        let distance = significant(distance, 3);
        Some(format!("bodies {first} and {second} were the nearest, {distance} apart at step {steps}"))
    }

    /// Returns the warning at the end, with the energy and step `now`, and a remedy.
    pub(super) fn warning(
        &self,
        now: (f64, u64),
        dt: f64,
        remedy: &str,
        id: impl Fn(usize) -> u32,
    ) -> Option<RunWarning> {
        let (energy, steps) = self.worst_with(now);
        let is_small = self.start.abs() < self.kinetic;
        let of = if is_small { "of the kinetic energy at the start" } else { "of its value at the start" };
        let error = self.relative(energy).abs();
        if error <= MOST {
            return None;
        }
        let off = if error < 1.0 {
            format!("deviated by {} % {of}", significant(100.0 * error, 3))
        } else {
            format!("was {} at the start and {}", significant(self.start, 5), significant(energy, 5))
        };
        let nearest = self.nearest_in_words(id).map_or(String::new(), |words| format!("; {words}"));
        let message = format!(
            "the energy {off} at step {steps}, time {}, the largest error found, {} the limit {} %{nearest}: {remedy}",
            significant(steps as f64 * dt, 6),
            of_limit(error / MOST),
            100.0 * MOST
        );
        Some(RunWarning { check: "energy-balance", value: error, limit: MOST, message })
    }

    /// Entries of the monitor for `summary.json`.
    pub(super) fn entries(&self, now: (f64, u64), id: impl Fn(usize) -> u32) -> [(&'static str, Value); 3] {
        let (energy, steps) = self.worst_with(now);
        let nearest = self.nearest.map(|(NearestPair { bodies, distance, place }, steps)| {
            json!({ "bodies": bodies.map(&id), "distance": distance, "place": place, "step": steps })
        });
        [
            ("largest_energy_error", json!(self.relative(energy))),
            ("largest_energy_error_step", json!(steps)),
            ("nearest_encounter", json!(nearest)),
        ]
    }

    fn worst_with(&self, now: (f64, u64)) -> (f64, u64) {
        let farther = (now.0 - self.start).abs() > (self.worst.0 - self.start).abs();
        if farther { now } else { self.worst }
    }

    /// Columns for a checkpoint.
    pub(super) fn columns(&self) -> [(String, CheckpointColumn); 2] {
        let worst = vec![self.worst.0, self.worst.1 as f64];
        let nearest =
            self.nearest.map(|(NearestPair { bodies: [a, b], distance, place: [x, y, z] }, steps)| {
                vec![a as f64, b as f64, distance, x, y, z, steps as f64]
            });
        [
            (WORST.to_owned(), CheckpointColumn::F64(worst)),
            (NEAREST.to_owned(), CheckpointColumn::F64(nearest.unwrap_or_default())),
        ]
    }

    /// Restores the monitor from a checkpoint of `count` bodies.
    ///
    /// # Errors
    /// A message if the columns do not belong to a monitor.
    pub(super) fn take_up(
        &mut self,
        start: f64,
        columns: &[(String, CheckpointColumn)],
        count: usize,
    ) -> Result<(), String> {
        let find = |name: &str| match columns.iter().find(|(there, _)| there == name) {
            Some((_, CheckpointColumn::F64(values))) => Ok(values.as_slice()),
            _ => Err(format!("the column {name} is missing")),
        };
        let &[energy, steps] = find(WORST)? else {
            return Err(format!("the column {WORST} does not have two numbers"));
        };
        let nearest = match *find(NEAREST)? {
            [] => None,
            [a, b, distance, x, y, z, steps] if a.max(b) < count as f64 => {
                let bodies = [a as usize, b as usize];
                Some((NearestPair { bodies, distance, place: [x, y, z] }, steps as u64))
            }
            _ => return Err(format!("the column {NEAREST} does not describe two bodies")),
        };
        (self.start, self.worst, self.nearest) = (start, (energy, steps as u64), nearest);
        Ok(())
    }
}
