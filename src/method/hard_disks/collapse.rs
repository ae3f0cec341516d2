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
    /// From a time on.
    pub fn new(time: f64) -> Watch {
        Watch { events: 0, begun: time }
    }

    /// An event at a time; `crossing` is the time in which a typical disc flies through a radius.
    pub fn see(&mut self, time: f64, crossing: impl FnOnce() -> f64) -> Option<Collapse> {
        self.events += 1;
        if self.events < WINDOW {
            return None;
        }
        let duration = time - self.begun;
        *self = Watch::new(time);
        (duration < PART * crossing()).then_some(Collapse { events: WINDOW, duration })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_that_stands_still_is_found_out() {
        let seen = |each: f64| {
            let mut watch = Watch::new(0.0);
            (1..=3 * WINDOW).find_map(|event| watch.see(event as f64 * each, || 1.0))
        };
        assert_eq!(seen(1e-14), None);
        assert_eq!(seen(1e-17).unwrap().events, WINDOW);
        assert!(seen(0.0).is_some());
    }
}
