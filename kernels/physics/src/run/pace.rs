//! Distance of the snapshots of a run, for a file of evenly spaced frames.

use crate::io::dcd::Spacing;
use crate::method::{Clock, Every, Simulation};

/// The distance of snapshots, in steps or in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Pace {
    /// In steps of a length (time).
    Steps(Spacing),
    /// In time, where a method takes no steps (time).
    Time(f64),
}

/// Length of steps that have none, and distance of a snapshot at the start alone: any number serves.
const NO_MATTER: f64 = 1.0;

impl Pace {
    /// Distance of the snapshots of a simulation.
    pub(super) fn of(snapshots: Every, simulation: &dyn Simulation) -> Pace {
        match (snapshots, simulation.time_step()) {
            (Every::Time(time), None) => Pace::Time(time),
            (Every::Steps(steps), dt) => Pace::Steps(Spacing { steps, dt: dt.unwrap_or(NO_MATTER) }),
            // Nothing is evenly apart from the start.
            (_, Some(dt)) => Pace::Steps(Spacing { steps: u64::MAX, dt }),
            (_, None) => Pace::Time(f64::INFINITY),
        }
    }

    /// Spacing for the heading of a file.
    pub(super) fn spacing(self) -> Spacing {
        match self {
            Pace::Steps(spacing) => spacing,
            Pace::Time(time) => Spacing { steps: 1, dt: if time.is_finite() { time } else { NO_MATTER } },
        }
    }

    /// The step of a moment, or the number of its frame; none where it is not evenly apart from the start.
    pub(super) fn number(self, clock: Clock) -> Option<u64> {
        /// Rounding of multiples (parts of the distance, and of the multiple).
        const ROUNDING: [f64; 2] = [1e-9, 4.0 * f64::EPSILON];
        match self {
            Pace::Steps(_) => Some(clock.steps),
            Pace::Time(time) => {
                let whole = (clock.time / time).round();
                let is_whole = (clock.time / time - whole).abs() <= ROUNDING[0].max(ROUNDING[1] * whole);
                is_whole.then_some(whole as u64).filter(|_| clock.time == 0.0 || whole > 0.0)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_between_frames_have_no_number() {
        let at = |time| Clock { steps: 0, time, events: 7 };
        for (pace, time, number) in [
            (0.1, 0.0, Some(0)),
            (0.1, 3.0 * 0.1, Some(3)),
            (0.1, 0.35, None),
            (0.1, 1e6 + 0.1, Some(10_000_001)),
            (f64::INFINITY, 0.0, Some(0)),
            (f64::INFINITY, 5.0, None),
        ] {
            assert_eq!(Pace::Time(pace).number(at(time)), number, "{time} by {pace}");
        }
    }
}
