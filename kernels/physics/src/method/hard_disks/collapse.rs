//! Collisions without end: found out, so that no run hangs.
//!
//! - Inelastic collapse: discs of e < 1 may collide without end in a finite time.
//! - Rest: a disc that has come to lie on a side, or on discs that do, bounces on for ever, as often as it takes the contact
//!   duration of the TC model to make bounces elastic. Hard discs have no contact that lasts.

use super::engine::{Occurred, Partner};
use crate::io::checkpoint::Column;
use crate::method::Snapshot;

/// Events of a window.
const WINDOW: u64 = 256;
/// Discs collapse where a window lasts less than this part of the time in which a typical disc flies through a radius.
const PART: f64 = 1e-12;
/// Discs rest that bounce, on average, more often than after this part of the time in which they fall through a radius: ten million
/// events for what would be one.
const AT_REST: f64 = 1e-7;
/// Windows in a row after which that is no chance.
const WINDOWS: u64 = 16;
/// Discs that rest on each other, of which one has come to rest first; where more have events nothing rests.
const FEW: usize = 16;
/// The column of those in a checkpoint.
const INVOLVED: &str = "watch.involved";

/// Looks at how time passes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Watch {
    events: u64,
    begun: f64,
    /// The time in which a typical disc flies through a radius, and the events until it is worked out once more: as many as there
    /// are discs, for each changes the motion of two.
    crossing: f64,
    renewed_after: u64,
    discs: u64,
    /// The time in which a disc falls through a radius; infinite where nothing falls.
    fall: f64,
    /// Discs of the events of this window, one more than a few at most.
    involved: Vec<u32>,
    /// Windows in a row, up to this one, in which a few discs had events thick and fast.
    thick: u64,
}

/// What was found: events, and how long they took (time).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Endless {
    /// Whether discs have come to rest; otherwise they collapse.
    pub(crate) rests: bool,
    pub events: u64,
    /// How long they took (time).
    pub duration: f64,
}

impl Watch {
    /// From the start on: `crossing` is the time in which a typical one of `discs` discs flies through a radius, `fall` that in which
    /// one falls through a radius, infinite where nothing falls.
    pub(super) fn new(crossing: f64, fall: f64, discs: usize) -> Watch {
        let discs = discs as u64;
        Watch {
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

    /// Takes up what a checkpoint kept.
    ///
    /// # Errors
    /// A sentence, if it was not kept.
    pub(super) fn restore(&mut self, kept: &Snapshot) -> Result<(), String> {
        self.events = kept.count("watch.events")?;
        self.begun = kept.time("watch.begun")?;
        self.crossing = kept.time("watch.crossing")?;
        self.renewed_after = kept.count("watch.renewed_after")?;
        self.thick = kept.count("watch.thick")?;
        self.involved = kept.codes(INVOLVED, kept.count("watch.involved_count")? as usize)?.to_vec();
        Ok(())
    }

    /// What a checkpoint keeps of it.
    pub(super) fn keep(&self, kept: &mut Snapshot) {
        kept.add_count("watch.events", self.events);
        kept.add_sum("watch.begun", self.begun);
        kept.add_sum("watch.crossing", self.crossing);
        kept.add_count("watch.renewed_after", self.renewed_after);
        kept.add_count("watch.thick", self.thick);
        kept.add_count("watch.involved_count", self.involved.len() as u64);
        kept.add_column(INVOLVED, Column::U32(self.involved.clone()));
    }

    /// An event; `crossing` says how long a typical disc flies through a radius now.
    #[inline]
    pub(crate) fn see(&mut self, happened: &Occurred, crossing: impl FnOnce() -> f64) -> Option<Endless> {
        self.events += 1;
        if self.fall.is_finite() && self.involved.len() <= FEW {
            self.involve(happened.disc);
            if let Partner::Disc(other) = happened.with {
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
        (collapses || rests).then_some(Endless { rests, events: WINDOW, duration })
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

    fn at(time: f64, disc: u32, with: Partner) -> Occurred {
        Occurred { time, disc, with, impact: None, thrust: 0.0, work: 0.0, action: 0.0, free: [0.0; 2] }
    }

    /// Events that are at most so far apart, of a group of discs in turn: after how many events that is found to be endless.
    fn found(fall: f64, apart: f64, discs: u32) -> Option<(u64, bool)> {
        let mut watch = Watch::new(1.0, fall, 100);
        (1..=20_000).find_map(|event| {
            let happened = at(event as f64 * apart, event as u32 % discs, Partner::Wall(1));
            watch.see(&happened, || 1.0).map(|endless| (event, endless.rests))
        })
    }

    #[test]
    fn rest_is_told_from_collapse_and_from_busy_discs() {
        assert_eq!(found(1.0, 1e-8, 1), Some((4096, true)));
        // Two in step: each bounces half as often.
        assert_eq!(found(1.0, 1e-8, 2), Some((4096, true)));
        assert_eq!(found(1.0, 1e-8, 11), None);
        assert_eq!(found(1.0, 2e-7, 1), None);
        assert_eq!(found(f64::INFINITY, 1e-8, 1), None);
        assert_eq!(found(1.0, 1e-16, 1), Some((256, false)));
    }
}
