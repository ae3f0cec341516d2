//! What is looked at now and then in a run, because it costs too much to be looked at in every step: speeds, and with them how
//! many steps a contact takes and what rounding takes of a step.

use super::check::{Checked, FEWEST_STEPS, MUCH_LOST, rounding};
use super::theory::contact::HeadOn;
use super::theory::limits;
use crate::io::checkpoint::Counter;
use crate::method::RunWarning;
use crate::number::significant;
use crate::observe::GrainSums;
use std::collections::BTreeMap;

/// Steps from one look to the next: a look costs as much as a row.
const EVERY: u64 = 1024;
/// Names of the counters.
const COUNTERS: [&str; 2] = ["looked.fastest", "looked.slowest"];

/// What was seen of the speeds so far.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RunMonitor {
    contact: HeadOn,
    dt: f64,
    /// By how much a position is rounded (length), where that is in single precision.
    rounding: Option<f64>,
    has_walls: bool,
    /// The largest and the smallest typical speed of approach, √2 of the root mean square speed (length/time); the smallest of
    /// the looks at which anything moved, because discs at rest have no motion to lose.
    typical: [f64; 2],
}

impl RunMonitor {
    /// Of a scene, before the first look.
    pub(super) fn of(checked: &Checked) -> RunMonitor {
        RunMonitor {
            contact: limits::contact(checked, 1.0),
            dt: checked.scene.integrator.dt,
            rounding: rounding(&checked.scene, &checked.domain, &checked.geometry),
            has_walls: checked.particles.len() > checked.particles.grain_count(),
            typical: [0.0, f64::INFINITY],
        }
    }

    /// Whether it is time for a look.
    pub(super) fn is_due(step: u64) -> bool {
        step.is_multiple_of(EVERY)
    }

    /// Looks at the grains.
    pub(super) fn look(&mut self, grains: &GrainSums) {
        let count = grains.count.max(1) as f64;
        let square = grains.square / count;
        // What flies together does not meet; but it may meet walls.
        let drift =
            if self.has_walls { 0.0 } else { grains.velocity.map(|sum| (sum / count).powi(2)).iter().sum() };
        let [approach, moving] = [square - drift, square].map(|square: f64| (2.0 * square.max(0.0)).sqrt());
        let [most, least] = self.typical;
        self.typical = [most.max(approach), if moving > 0.0 { least.min(moving) } else { least }];
    }

    /// What was seen, for a checkpoint.
    pub(super) fn counters(&self) -> impl Iterator<Item = (String, Counter)> {
        COUNTERS.iter().zip(self.typical).map(|(name, speed)| ((*name).to_owned(), Counter::Sum(speed)))
    }

    /// Takes up what was seen before.
    ///
    /// # Errors
    /// A sentence, if it is not there.
    pub(super) fn restore(&mut self, counters: &BTreeMap<String, Counter>) -> Result<(), String> {
        for (name, speed) in COUNTERS.into_iter().zip(&mut self.typical) {
            match counters.get(name) {
                // Infinite is the slowest where nothing has moved.
                Some(Counter::Sum(value)) if *value >= 0.0 => *speed = *value,
                Some(Counter::Sum(value)) => return Err(format!("the sum {name} is {value}, no speed")),
                _ => return Err(format!("the sum {name} is missing")),
            }
        }
        Ok(())
    }

    /// What is to be said of it.
    pub(super) fn warnings(&self) -> Vec<RunWarning> {
        let [most, least] = self.typical;
        let contact = HeadOn { speed: most, ..self.contact };
        let steps = contact.duration() / self.dt;
        let mut warnings = vec![];
        if steps < FEWEST_STEPS {
            let message = format!(
                "discs typically met at up to {most}, where a contact lasts {}, {steps:.1} steps: a scene that begins \
                 so fast is refused below {FEWEST_STEPS}; a dt of {} gives as many",
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
                "positions in single precision are rounded by up to {rounding}, where discs typically moved as little as \
                 {step} in a step: \"mixed\" or \"f64\" loses no motion",
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
