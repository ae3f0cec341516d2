//! How far a simulation has come, and when something is due.

use std::fmt;

/// How far a simulation has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Clock {
    /// Steps done; 0 where a method takes none.
    pub steps: u64,
    /// Time since the start (time).
    pub time: f64,
    /// Events, such as collisions; 0 where a method has none.
    pub events: u64,
}

impl fmt::Display for Clock {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Clock { steps, time, events } = self;
        match (steps, events) {
            (0, 1..) => write!(f, "event {events}, time {time:?}"),
            _ => write!(f, "step {steps}"),
        }
    }
}

/// A moment that a simulation comes to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Until {
    /// After this many steps.
    Steps(u64),
    /// At this time (time).
    Time(f64),
    /// After this many events.
    Events(u64),
}

impl Until {
    /// Whether the moment has come.
    pub fn has_come(self, clock: &Clock) -> bool {
        match self {
            Until::Steps(steps) => clock.steps >= steps,
            Until::Time(time) => clock.time >= time,
            Until::Events(events) => clock.events >= events,
        }
    }

    /// Whether it lies behind.
    pub fn has_passed(self, clock: &Clock) -> bool {
        match self {
            Until::Steps(steps) => clock.steps > steps,
            Until::Time(time) => clock.time > time,
            Until::Events(events) => clock.events > events,
        }
    }

    /// The moment after that many of its units more than the clock shows.
    pub fn after(self, clock: &Clock) -> Until {
        match self {
            Until::Steps(steps) => Until::Steps(clock.steps + steps),
            Until::Time(time) => Until::Time(clock.time + time),
            Until::Events(events) => Until::Events(clock.events + events),
        }
    }

    /// How much of the way is done, and how long it is, in its unit; a time in parts of a million.
    pub fn progress(self, clock: &Clock) -> (u64, u64) {
        const PARTS: f64 = 1e6;
        match self {
            Until::Steps(steps) => (clock.steps, steps),
            Until::Time(time) if time > 0.0 => ((PARTS * clock.time / time) as u64, PARTS as u64),
            Until::Time(_) => (0, 0),
            Until::Events(events) => (clock.events, events),
        }
    }
}

impl fmt::Display for Until {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Until::Steps(steps) => write!(f, "run.steps={steps}"),
            Until::Time(time) => write!(f, "run.time={time:?}"),
            Until::Events(events) => write!(f, "run.events={events}"),
        }
    }
}

/// What comes again and again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Every {
    /// Nothing does.
    Never,
    /// After as many steps.
    Steps(u64),
    /// After as long a time (time).
    Time(f64),
}

impl Every {
    /// As many steps; never for 0.
    pub fn steps(steps: u64) -> Every {
        if steps == 0 { Every::Never } else { Every::Steps(steps) }
    }

    /// The next moment after the one that the clock shows.
    pub fn next(self, clock: &Clock) -> Option<Until> {
        match self {
            Every::Never => None,
            Every::Steps(steps) => Some(Until::Steps((clock.steps / steps + 1) * steps)),
            Every::Time(time) => {
                let whole = (clock.time / time).floor();
                // The quotient may be rounded down to the multiple that the clock shows.
                let next = (whole + 1.0) * time;
                Some(Until::Time(if next > clock.time { next } else { (whole + 2.0) * time }))
            }
        }
    }
}

/// How long a run takes, and how often something is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Schedule {
    /// The end.
    pub until: Until,
    /// Rows of observables.
    pub rows: Every,
    /// Snapshots.
    pub snapshots: Every,
    /// Checkpoints.
    pub checkpoints: Every,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_comes_again_comes_at_multiples() {
        let at = |steps, time| Clock { steps, time, events: 0 };
        assert_eq!(Every::steps(0).next(&at(3, 0.0)), None);
        assert_eq!(Every::steps(10).next(&at(0, 0.0)), Some(Until::Steps(10)));
        assert_eq!(Every::steps(10).next(&at(10, 0.0)), Some(Until::Steps(20)));
        assert_eq!(Every::Time(0.5).next(&at(0, 0.5)), Some(Until::Time(1.0)));
        // Every multiple is followed by a later one.
        let mut now = 0.0;
        for _ in 0..10_000 {
            let Some(Until::Time(next)) = Every::Time(0.05).next(&at(0, now)) else { panic!("there is one") };
            assert!(next > now && next < now + 0.11, "{now} {next}");
            now = next;
        }
        assert!(Until::Steps(5).has_come(&at(5, 0.0)) && !Until::Steps(5).has_passed(&at(5, 0.0)));
        assert_eq!(Until::Time(2.0).progress(&at(0, 0.5)), (250_000, 1_000_000));
    }
}
