//! Inelastic collapse: without end in a finite time, discs of e < 1 may collide. Found out, so that no run hangs.

/// Events of a window.
const WINDOW: u64 = 256;
/// Discs collapse where a window lasts less than this part of the time in which a typical disc flies through a radius.
const PART: f64 = 1e-12;

/// Looks at how time passes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Watch {
    events: u64,
    begun: f64,
    /// The time in which a typical disc flies through a radius, and the events until it is worked out once more: as many as there
    /// are discs, for each changes the motion of two.
    crossing: f64,
    renewed_after: u64,
    discs: u64,
}

/// What was found: events, and how long they took (time).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collapse {
    /// Events.
    pub events: u64,
    /// How long they took (time).
    pub duration: f64,
}

impl Watch {
    /// From a time on; `crossing` is the time in which a typical one of `discs` discs flies through a radius.
    pub fn new(time: f64, crossing: f64, discs: usize) -> Watch {
        let discs = discs as u64;
        Watch { events: 0, begun: time, crossing, renewed_after: discs, discs }
    }

    /// An event at a time; `crossing` says how long a typical disc flies through a radius now.
    #[inline]
    pub fn see(&mut self, time: f64, crossing: impl FnOnce() -> f64) -> Option<Collapse> {
        self.events += 1;
        if self.events < WINDOW {
            return None;
        }
        let duration = time - self.begun;
        (self.events, self.begun) = (0, time);
        self.renewed_after = self.renewed_after.saturating_sub(WINDOW);
        if self.renewed_after == 0 {
            (self.crossing, self.renewed_after) = (crossing(), self.discs);
        }
        (duration < PART * self.crossing).then_some(Collapse { events: WINDOW, duration })
    }
}
