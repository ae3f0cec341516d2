//! Clock of a simulation, and the schedule of what a run writes.

use crate::scene::RunKeys;
use std::fmt;

/// Progress of a simulation: steps, time and events.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Clock {
    /// Steps done; 0 where a method takes none.
    pub steps: u64,
    /// Time since the start (time).
    pub time: f64,
    /// Events, such as collisions; 0 where a method has none.
    pub events: u64,
}

impl Clock {
    /// Number of rows and frames: steps, or events where a method takes no steps. Moments between which nothing happens share a number; their times
    /// differ.
    pub fn number(&self) -> u64 {
        if self.steps > 0 { self.steps } else { self.events }
    }

    /// Progress in words.
    pub fn done(&self) -> String {
        if self.takes_steps() { format!("{} steps", self.steps) } else { format!("{} events", self.events) }
    }

    /// True if steps have been done, or nothing at all.
    fn takes_steps(&self) -> bool {
        self.steps > 0 || self.events == 0 && self.time == 0.0
    }
}

impl fmt::Display for Clock {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Clock { steps, time, events } = self;
        match (self.takes_steps(), steps) {
            (true, 0) => f.write_str("the start"),
            (true, _) => write!(f, "step {steps}"),
            (false, _) => write!(f, "event {events}, time {time:?}"),
        }
    }
}

/// Moment that a run advances to.
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
    /// True once the moment is reached.
    pub fn has_been_reached(self, clock: &Clock) -> bool {
        match self {
            Until::Steps(steps) => clock.steps >= steps,
            Until::Time(time) => clock.time >= time,
            Until::Events(events) => clock.events >= events,
        }
    }

    /// True once the moment is exceeded.
    pub(crate) fn is_exceeded(self, clock: &Clock) -> bool {
        match self {
            Until::Steps(steps) => clock.steps > steps,
            Until::Time(time) => clock.time > time,
            Until::Events(events) => clock.events > events,
        }
    }

    /// Moment as many units after the clock's.
    pub fn after(self, clock: &Clock) -> Until {
        match self {
            Until::Steps(steps) => Until::Steps(clock.steps + steps),
            Until::Time(time) => Until::Time(clock.time + time),
            Until::Events(events) => Until::Events(clock.events + events),
        }
    }

    /// Moment at twice the count or time.
    pub fn doubled(self) -> Until {
        match self {
            Until::Steps(steps) => Until::Steps(steps.saturating_mul(2)),
            Until::Time(time) => Until::Time(2.0 * time),
            Until::Events(events) => Until::Events(events.saturating_mul(2)),
        }
    }

    /// Progress towards the moment and its total, in its unit; times in millionths.
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

/// Number of steps of length `dt` that cover a time. A time that is a whole number of steps up to rounding takes no extra step.
pub fn steps_over(time: f64, dt: f64) -> u64 {
    /// Rounding of times that were summed or divided (relative).
    const ROUNDING: f64 = 1e-12;
    let steps = time / dt;
    let whole = steps.round();
    let is_whole = (steps - whole).abs() <= ROUNDING * whole.max(1.0);
    (if is_whole { whole } else { steps.ceil() }) as u64
}

/// Interval between repeated outputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Every {
    /// No output.
    Never,
    /// Number of steps.
    Steps(u64),
    /// Duration (time).
    Time(f64),
    /// Seconds of wall time. The simulation knows no such moment in advance.
    Seconds(f64),
}

/// Wall time between checkpoints (s) if the scene sets none: long compared with writing one.
const BETWEEN_CHECKPOINTS: f64 = 10.0;

impl Every {
    /// Interval of this many steps; never for 0.
    pub fn steps(steps: u64) -> Every {
        if steps == 0 { Every::Never } else { Every::Steps(steps) }
    }

    /// Interval of this duration (time); never for 0.
    pub fn time(time: f64) -> Every {
        if time > 0.0 { Every::Time(time) } else { Every::Never }
    }

    /// Interval of checkpoints: the scene's, or one of wall time, because no result depends on them.
    pub fn checkpoints(given: Option<Every>) -> Every {
        given.unwrap_or(Every::Seconds(BETWEEN_CHECKPOINTS))
    }

    /// Number of repetitions up to an end, and true if the last falls on the end; none if the end has other units.
    fn times(self, until: Until) -> Option<(u64, bool)> {
        match (self, until) {
            (Every::Never, _) => Some((0, false)),
            (Every::Steps(every), Until::Steps(steps)) => Some((steps / every, steps % every == 0)),
            (Every::Time(every), Until::Time(time)) => {
                let mut times = (time / every).floor();
                // The quotient may be rounded to the next whole number.
                times += f64::from((times + 1.0) * every <= time) - f64::from(times * every > time);
                Some((times as u64, times * every == time))
            }
            _ => None,
        }
    }

    /// Next moment after the clock's.
    pub fn next(self, clock: &Clock) -> Option<Until> {
        match self {
            Every::Never | Every::Seconds(_) => None,
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

/// Length of a run and intervals of its output.
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

impl Schedule {
    /// Schedule of a scene that counts steps.
    pub fn of_steps(run: &RunKeys) -> Schedule {
        Schedule {
            until: Until::Steps(run.steps),
            rows: Every::steps(run.thermo_every),
            snapshots: Every::steps(run.snapshot_every),
            checkpoints: Every::checkpoints(run.checkpoint_every.map(Every::steps)),
        }
    }

    /// Number of rows of observables in the whole run, including the start; none if it is not known in advance.
    pub fn row_count(&self) -> Option<u64> {
        self.rows.times(self.until).map(|(times, _)| times.saturating_add(1))
    }

    /// Number of snapshots in the whole run: the start, those that are due, and the end.
    pub fn snapshot_count(&self) -> Option<u64> {
        let (times, ends) = self.snapshots.times(self.until)?;
        let is_over = self.until.has_been_reached(&Clock::default());
        Some(times.saturating_add(1 + u64::from(!ends && !is_over)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn periodic_events_fall_on_multiples() {
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
        assert!(Until::Steps(5).has_been_reached(&at(5, 0.0)) && !Until::Steps(5).is_exceeded(&at(5, 0.0)));
        assert_eq!(Until::Time(2.0).progress(&at(0, 0.5)), (250_000, 1_000_000));
    }

    #[test]
    fn rounding_adds_no_step() {
        for (time, dt, steps) in [
            (0.0, 0.1, 0),
            (0.30000000000000004, 0.1, 3),
            (0.7999999999999999, 0.1, 8),
            (0.3, 0.005, 60),
            (0.004, 0.005, 1),
            (0.0075, 0.005, 2),
            (1e6 + 0.0025, 0.005, 200_000_001),
        ] {
            assert_eq!(steps_over(time, dt), steps, "{time} in steps of {dt}");
        }
    }

    #[test]
    fn row_and_snapshot_counts_are_predicted() {
        let schedule =
            |until, every| Schedule { until, rows: every, snapshots: every, checkpoints: Every::Never };
        let counts = |until, every| {
            let schedule = schedule(until, every);
            (schedule.row_count(), schedule.snapshot_count())
        };
        assert_eq!(counts(Until::Steps(70), Every::Steps(30)), (Some(3), Some(4)));
        assert_eq!(counts(Until::Steps(60), Every::Steps(30)), (Some(3), Some(3)));
        assert_eq!(counts(Until::Steps(60), Every::Never), (Some(1), Some(2)));
        assert_eq!(counts(Until::Steps(0), Every::Never), (Some(1), Some(1)));
        assert_eq!(counts(Until::Events(9), Every::Time(1.0)), (None, None));
        // Compared with counting moment by moment.
        for (until, every) in
            [(0.3, 0.1), (0.7, 0.1), (20.0, 1.0), (4.95, 0.05), (1.0, 0.3), (0.1, 0.3), (5e6, 0.7)]
        {
            let (mut clock, mut moments) = (Clock::default(), 0);
            while let Some(Until::Time(next)) =
                Every::Time(every).next(&clock).filter(|next| !matches!(next, Until::Time(it) if *it > until))
            {
                clock.time = next;
                moments += 1;
            }
            let last = u64::from(clock.time != until);
            assert_eq!(
                counts(Until::Time(until), Every::Time(every)),
                (Some(moments + 1), Some(moments + 1 + last))
            );
        }
    }

    /// Messages never name steps where a method takes none.
    #[test]
    fn moments_name_steps_or_events() {
        let at = |steps, time, events| Clock { steps, time, events };
        let named = |clock: Clock| (clock.to_string(), clock.done(), clock.number());
        let words = |moment: &str, done: &str, number| (moment.to_owned(), done.to_owned(), number);
        assert_eq!(named(at(0, 0.0, 0)), words("the start", "0 steps", 0));
        assert_eq!(named(at(7, 0.5, 0)), words("step 7", "7 steps", 7));
        assert_eq!(named(at(0, 0.5, 9)), words("event 9, time 0.5", "9 events", 9));
        assert_eq!(named(at(0, 0.5, 0)), words("event 0, time 0.5", "0 events", 0));
    }
}
