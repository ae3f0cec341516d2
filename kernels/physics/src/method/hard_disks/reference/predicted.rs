//! Predicted next collision of a disc, in sixteen bytes.

use stripmine_kernels::flight::FlyingDisc;

/// Code of a wall across the first axis; that of the second one follows. Smaller codes are numbers of discs.
pub(super) const WALL: u32 = u32::MAX - 1;

/// Predicted next collision of a disc with another one or a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PredictedEvent {
    /// Time of the event; infinite if none.
    pub(super) time: f64,
    /// Number of the other disc, or code of a wall.
    pub(super) with: u32,
    /// Events of the other disc before the prediction. It is invalid if there are more when it is due.
    pub(super) events: u32,
}

impl PredictedEvent {
    /// No event.
    pub(super) const NONE: PredictedEvent = PredictedEvent { time: f64::INFINITY, with: WALL, events: 0 };

    /// Collision with a disc.
    #[inline(always)]
    pub(super) fn with_disc(time: f64, number: u32, disc: &FlyingDisc) -> PredictedEvent {
        PredictedEvent { time, with: number, events: disc.events as u32 }
    }

    /// True if it precedes another event of the same disc; of two at one time, the one with the smaller partner comes first.
    #[inline(always)]
    pub(super) fn is_before(&self, other: &PredictedEvent) -> bool {
        self.time < other.time || self.time == other.time && self.with < other.with
    }
}
