//! Detection of infinitely many collisions, so that no run hangs.
//!
//! - Inelastic collapse: discs of e < 1 may collide infinitely often in a finite time.
//! - Rest: a disc that lies on a side, or on resting discs, bounces for ever, at the rate at which the contact duration of the
//!   TC model makes bounces elastic. Hard discs have no lasting contacts.

use super::engine::{EventPartner, ExecutedEvent};
use crate::io::checkpoint::CheckpointColumn;
use crate::method::Snapshot;

/// Events per window.
const WINDOW: u64 = 256;
/// A window shorter than this fraction of the time in which a typical disc flies through a radius is a collapse.
const PART: f64 = 1e-12;
/// Discs are at rest if they bounce, on average, more often than once in this fraction of the time to fall through a radius: ten
/// million events instead of one.
const AT_REST: f64 = 1e-7;
/// Consecutive windows after which rest is no coincidence.
const WINDOWS: u64 = 16;
/// Largest group of discs that can count as resting; if more discs have events, nothing rests.
const FEW: usize = 16;
/// Column of the involved discs in a checkpoint.
const INVOLVED: &str = "watch.involved";

/// Monitor of the event rate.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CollapseMonitor {
    events: u64,
    begun: f64,
    /// Time in which a typical disc flies through a radius, and the events until it is recalculated. These are as many as there are
    /// discs, because each event changes the motion of at most two.
    crossing: f64,
    renewed_after: u64,
    discs: u64,
    /// Time in which a disc falls through a radius; infinite without gravity.
    fall: f64,
    /// Discs with events in this window, at most `FEW` + 1.
    involved: Vec<u32>,
    /// Consecutive windows, up to this one, in which few discs had many events.
    thick: u64,
}

/// Finding of the monitor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EndlessCollisions {
    /// True if discs have come to rest; false for a collapse.
    pub(crate) rests: bool,
    pub events: u64,
    /// Duration of the events (time).
    pub duration: f64,
}

impl CollapseMonitor {
    /// Starts the monitor. `crossing` is the time in which a typical disc flies through a radius, `fall` the time to fall through a
    /// radius, infinite without gravity.
    pub(super) fn new(crossing: f64, fall: f64, discs: usize) -> CollapseMonitor {
        let discs = discs as u64;
        CollapseMonitor {
            events: 0,
            begun: 0.0,
            crossing,
            renewed_after: discs,
            discs,
            fall,
            involved: vec![],
            thick: 0,
        }
    }

    /// Restores the state of a checkpoint.
    ///
    /// # Errors
    /// A message if it is missing.
    pub(super) fn restore(&mut self, kept: &Snapshot) -> Result<(), String> {
        self.events = kept.count("watch.events")?;
        self.begun = kept.time("watch.begun")?;
        self.crossing = kept.time("watch.crossing")?;
        self.renewed_after = kept.count("watch.renewed_after")?;
        self.thick = kept.count("watch.thick")?;
        self.involved = kept.codes(INVOLVED, kept.count("watch.involved_count")? as usize)?.to_vec();
        Ok(())
    }

    /// Adds the state to a checkpoint.
    pub(super) fn keep(&self, kept: &mut Snapshot) {
        kept.add_count("watch.events", self.events);
        kept.add_sum("watch.begun", self.begun);
        kept.add_sum("watch.crossing", self.crossing);
        kept.add_count("watch.renewed_after", self.renewed_after);
        kept.add_count("watch.thick", self.thick);
        kept.add_count("watch.involved_count", self.involved.len() as u64);
        kept.add_column(INVOLVED, CheckpointColumn::U32(self.involved.clone()));
    }

    /// Registers an event. `crossing` returns the current time in which a typical disc flies through a radius.
    #[inline]
    pub(crate) fn register_event(
        &mut self,
        happened: &ExecutedEvent,
        crossing: impl FnOnce() -> f64,
    ) -> Option<EndlessCollisions> {
        self.events += 1;
        if self.fall.is_finite() && self.involved.len() <= FEW {
            self.involve(happened.disc);
            if let EventPartner::Disc(other) = happened.with {
                self.involve(other);
            }
        }
        if self.events < WINDOW {
            return None;
        }
        let duration = happened.time - self.begun;
        (self.events, self.begun) = (0, happened.time);
        self.renewed_after = self.renewed_after.saturating_sub(WINDOW);
        if self.renewed_after == 0 {
            (self.crossing, self.renewed_after) = (crossing(), self.discs);
        }
        let free = duration * self.involved.len() as f64 / WINDOW as f64;
        let is_thick = self.involved.len() <= FEW && free < AT_REST * self.fall;
        self.thick = if is_thick && self.fall.is_finite() { self.thick + 1 } else { 0 };
        self.involved.clear();
        let collapses = duration < PART * self.crossing;
        let rests = !collapses && self.thick >= WINDOWS;
        (collapses || rests).then_some(EndlessCollisions { rests, events: WINDOW, duration })
    }

    fn involve(&mut self, disc: u32) {
        if !self.involved.contains(&disc) {
            self.involved.push(disc);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(time: f64, disc: u32, with: EventPartner) -> ExecutedEvent {
        ExecutedEvent { time, disc, with, impact: None, thrust: 0.0, work: 0.0, action: 0.0, free: [0.0; 2] }
    }

    /// Feeds events `apart` in time, of `discs` discs in turn. Returns the number of events until detection, and the finding.
    fn events_until_detection(fall: f64, apart: f64, discs: u32) -> Option<(u64, bool)> {
        let mut watch = CollapseMonitor::new(1.0, fall, 100);
        (1..=20_000).find_map(|event| {
            let happened = at(event as f64 * apart, event as u32 % discs, EventPartner::Wall(1));
            watch.register_event(&happened, || 1.0).map(|endless| (event, endless.rests))
        })
    }

    #[test]
    fn rest_differs_from_collapse_and_activity() {
        assert_eq!(events_until_detection(1.0, 1e-8, 1), Some((4096, true)));
        // Two discs in step: each bounces half as often.
        assert_eq!(events_until_detection(1.0, 1e-8, 2), Some((4096, true)));
        assert_eq!(events_until_detection(1.0, 1e-8, 11), None);
        assert_eq!(events_until_detection(1.0, 2e-7, 1), None);
        assert_eq!(events_until_detection(f64::INFINITY, 1e-8, 1), None);
        assert_eq!(events_until_detection(1.0, 1e-16, 1), Some((256, false)));
    }
}
