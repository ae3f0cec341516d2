//! Periodic check of a run that would be too expensive in every step: typical speeds, and with them the steps a contact takes and the part of a step
//! lost to rounding.

use super::check::{CheckedGranularScene, FEWEST_STEPS, MUCH_LOST, rounding};
use super::theory::contact::HeadOn;
use super::theory::limits;
use crate::io::checkpoint::CheckpointCounter;
use crate::method::RunWarning;
use crate::number::significant;
use crate::observe::GrainSums;
use std::collections::BTreeMap;

/// Steps between samples: a sample costs as much as a row.
const EVERY: u64 = 1024;
/// Names of the counters in checkpoints.
const COUNTERS: [&str; 2] = ["looked.fastest", "looked.slowest"];

/// Extremes of the typical speeds so far.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RunMonitor {
    contact: HeadOn,
    dt: f64,
    /// Rounding of a position (length), if it is in single precision.
    rounding: Option<f64>,
    has_walls: bool,
    /// Largest and smallest typical speed of approach, √2 of the root mean square speed (length/time). The smallest ignores samples without motion,
    /// because discs at rest have no motion to lose.
    typical: [f64; 2],
}

impl RunMonitor {
    /// Monitor of a scene, before the first sample.
    pub(super) fn of(checked: &CheckedGranularScene) -> RunMonitor {
        RunMonitor {
            contact: limits::contact(checked, 1.0),
            dt: checked.scene.integrator.dt,
            rounding: rounding(&checked.scene, &checked.domain, &checked.geometry),
            has_walls: checked.particles.len() > checked.particles.grain_count(),
            typical: [0.0, f64::INFINITY],
        }
    }

    /// True if a sample is due.
    pub(super) fn is_due(step: u64) -> bool {
        step.is_multiple_of(EVERY)
    }

    /// Samples the grains.
    pub(super) fn sample_speeds(&mut self, grains: &GrainSums) {
        let count = grains.count.max(1) as f64;
        let square = grains.square / count;
        // Discs in a common drift do not collide with each other, but they may collide with walls.
        let drift =
            if self.has_walls { 0.0 } else { grains.velocity.map(|sum| (sum / count).powi(2)).iter().sum() };
        let [approach, moving] = [square - drift, square].map(|square: f64| (2.0 * square.max(0.0)).sqrt());
        let [most, least] = self.typical;
        self.typical = [most.max(approach), if moving > 0.0 { least.min(moving) } else { least }];
    }

    /// Returns the extremes for a checkpoint.
    pub(super) fn counters(&self) -> impl Iterator<Item = (String, CheckpointCounter)> {
        COUNTERS
            .iter()
            .zip(self.typical)
            .map(|(name, speed)| ((*name).to_owned(), CheckpointCounter::Sum(speed)))
    }

    /// Restores the extremes.
    ///
    /// # Errors
    /// Says which one is missing or invalid.
    pub(super) fn restore(&mut self, counters: &BTreeMap<String, CheckpointCounter>) -> Result<(), String> {
        for (name, speed) in COUNTERS.into_iter().zip(&mut self.typical) {
            match counters.get(name) {
                // The slowest speed is infinite if nothing has moved.
                Some(CheckpointCounter::Sum(value)) if *value >= 0.0 => *speed = *value,
                Some(CheckpointCounter::Sum(value)) => {
                    return Err(format!("the sum {name} is {value}, not a speed"));
                }
                _ => return Err(format!("the sum {name} is missing")),
            }
        }
        Ok(())
    }

    /// Returns warnings about speeds.
    pub(super) fn warnings(&self) -> Vec<RunWarning> {
        let [most, least] = self.typical;
        let contact = HeadOn { speed: most, ..self.contact };
        let steps = contact.duration() / self.dt;
        let mut warnings = vec![];
        if steps < FEWEST_STEPS {
            let message = format!(
                "discs typically collided at up to {most}, where a contact lasts {}, {steps:.1} steps: a scene that starts \
                 so fast is rejected below {FEWEST_STEPS} steps; use dt <= {}",
                significant(contact.duration(), 4),
                significant(contact.duration() / FEWEST_STEPS, 4),
                most = significant(most, 4)
            );
            warnings.push(RunWarning {
                check: "steps-per-contact",
                value: steps,
                limit: FEWEST_STEPS,
                message,
            });
        }
        let step = least / std::f64::consts::SQRT_2 * self.dt;
        if let Some(rounding) = self.rounding
            && rounding > MUCH_LOST * step
        {
            let message = format!(
                "positions in single precision are rounded by up to {rounding}, but discs typically moved as little as \
                 {step} in a step: use \"mixed\" or \"f64\"",
                rounding = significant(rounding, 2),
                step = significant(step, 2)
            );
            warnings.push(RunWarning {
                check: "rounding",
                value: rounding / step,
                limit: MUCH_LOST,
                message,
            });
        }
        warnings
    }
}
