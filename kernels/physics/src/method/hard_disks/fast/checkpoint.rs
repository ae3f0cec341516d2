//! State of the fast engine in a checkpoint, and resumption from it.

use super::leaving::leaving_time;
use super::{ExpectedEvent, Fast, WALL, rank};
use crate::io::checkpoint::CheckpointColumn;
use crate::method::Snapshot;
use stripmine_kernels::backend::Scalar;
use stripmine_kernels::flight::{FlyingDisc, MOST_PARTNERS, ROW_UNIT};

/// Checkpoint columns of the registered positions.
const REGISTERED: [&str; 2] = ["registered.x", "registered.y"];

/// Smallest displacement limit accepted from a checkpoint, relative to the largest radius.
const NARROWEST: f64 = 1e-6;

/// Minimum time for a disc to leave its list, in spacings of the clock's numbers.
const RESOLVED: f64 = 1e3;

impl Fast {
    /// Returns the state for a checkpoint, in the order of the discs' numbers.
    pub(super) fn engine_snapshot(&self) -> Snapshot {
        let mut kept = Snapshot::default();
        let by_number = |of: &dyn Fn(u32) -> f64| {
            CheckpointColumn::F64(self.places.iter().map(|&place| of(place)).collect())
        };
        for (axis, name) in REGISTERED.into_iter().enumerate() {
            kept.add_column(name, by_number(&|place| self.lists.registered_position(place)[axis]));
        }
        kept.add_column("expected.time", by_number(&|place| self.queue.times()[place as usize]));
        let expected = || self.places.iter().map(|&place| self.partners[place as usize]);
        let number = |with: u32| if with >= WALL[0] { with } else { self.numbers[with as usize] };
        kept.add_column(
            "expected.with",
            CheckpointColumn::U32(expected().map(|it| number(it.with)).collect()),
        );
        kept.add_column("expected.events", CheckpointColumn::U32(expected().map(|it| it.events).collect()));
        kept.add_sum("engine.time", self.time);
        kept.add_sum("engine.displacement_limit", self.displacement_limit);
        kept.add_count("engine.stride", self.lists.stride() as u64);
        kept.add_count("engine.renewals", self.renewals);
        kept.add_count("engine.events", self.events);
        kept.add_count("engine.sorted_until", self.sorted_until);
        kept
    }

    /// Resumes with discs from the state of [`engine_snapshot`](Self::engine_snapshot). Returns a message if it does not fit them.
    pub(super) fn take_up(&mut self, discs: Vec<FlyingDisc>, kept: &Snapshot) -> Result<(), String> {
        let count = discs.len();
        let registered = [kept.numbers(REGISTERED[0], count)?, kept.numbers(REGISTERED[1], count)?];
        let origin = self.arena.domain.origin;
        if (0..2).any(|axis| registered[axis].iter().any(|&at| at < origin[axis])) {
            return Err("the registered position of a disc is below the origin of the box".to_owned());
        }
        let times = kept.times("expected.time", count)?;
        let [with, events] = [kept.codes("expected.with", count)?, kept.codes("expected.events", count)?];
        let none =
            |(own, &with): (usize, &u32)| with < WALL[0] && (with as usize >= count || with as usize == own);
        if with.iter().enumerate().any(none) {
            return Err("a disc expects to meet itself or a disc that does not exist".to_owned());
        }
        let (stride, displacement_limit) =
            (kept.count("engine.stride")?, kept.sum("engine.displacement_limit")?);
        // Narrower lists would be renewed endlessly.
        let narrowest = NARROWEST * self.largest;
        let is_whole = stride <= MOST_PARTNERS as u64 && stride.is_multiple_of(ROW_UNIT as u64);
        // In a narrower box a disc would list others across two of its sides.
        let widest = 0.25 * self.arena.domain.shortest_period() - self.largest;
        if !is_whole || !(narrowest..widest).contains(&displacement_limit) {
            return Err(format!(
                "lists have {stride} entries and the displacement limit {displacement_limit}"
            ));
        }
        let time = kept.sum("engine.time")?;
        if times.iter().any(|&expected| expected < time) {
            return Err(format!("a disc expects an event before the engine's time {time:?}"));
        }
        self.displacement_limit = displacement_limit;
        self.time = time;
        self.renewals = kept.count("engine.renewals")?;
        self.events = kept.count("engine.events")?;
        self.sorted_until = kept.count("engine.sorted_until")?;
        // The old lists are released before there are new ones.
        self.lists = self.lists_of(0, 0);
        self.discs.copy_from_slice(&discs);
        drop(discs);
        self.numbers.iter_mut().zip(0..).for_each(|(number, disc)| *number = disc);
        self.sort(self.time);
        let place_of = |number: u32| {
            let number = number as usize;
            [registered[0][number], registered[1][number]]
        };
        let mut lists = self.lists_of(count, stride as usize);
        let positions = self.numbers.iter().map(|&number| place_of(number));
        let full = lists.begin(Scalar::default(), positions, self.radii());
        self.lists = lists;
        full.map_err(|disc| format!("the list of disc number {} is full", self.numbers[disc as usize]))?;
        self.check_expectations(times)?;
        self.queue.clear();
        for (place, &number) in self.numbers.iter().enumerate() {
            let expects = with[number as usize];
            let with = if expects >= WALL[0] { expects } else { self.places[expects as usize] };
            self.partners[place] = ExpectedEvent { with, events: events[number as usize] };
            let (numbers, partners) = (&self.numbers, &self.partners);
            self.queue.set(place as u32, times[number as usize], |disc| rank(numbers, partners, disc));
        }
        Ok(())
    }

    /// Checks that each disc expects an event (time, by numbers) before it may leave its list.
    ///
    /// Lists are also renewed after the last event, up to the first expected event: at that moment every disc is still within the range of
    /// its list. Under gravity a list is renewed at the latest when a disc from rest would have left it.
    ///
    /// # Errors
    /// A message that names the first disc that does not.
    fn check_expectations(&self, times: &[f64]) -> Result<(), String> {
        let first = times.iter().copied().fold(f64::INFINITY, f64::min);
        // If all discs are at rest, no event is expected.
        let now = if first.is_finite() { first } else { self.time };
        let limit = self.displacement_limit * (1.0 + 1e-6);
        for (place, &number) in self.numbers.iter().enumerate() {
            let within = match self.arena.space.gravity() {
                Some([gx, gy]) => (2.0 * limit / gx.hypot(gy)).sqrt(),
                None => {
                    let listed_at = self.lists.registered_position(place as u32);
                    leaving_time(&self.arena, &self.discs[place], listed_at, limit, (now, f64::INFINITY))
                        - now
                }
            };
            if times[number as usize] - now > within + 1e-9 * now.abs() {
                return Err(format!("disc number {number} expects no event before it leaves its list"));
            }
            // Otherwise the list would be renewed endlessly without advancing the clock.
            let [u, v] = self.discs[place].velocity_at(&self.arena.space, now);
            let unresolved = RESOLVED * f64::EPSILON * now.abs() * u.hypot(v);
            if limit.is_nan() || unresolved.is_nan() || limit < unresolved {
                return Err(format!(
                    "disc number {number} moves too fast for the resolution of times near {now}"
                ));
            }
        }
        Ok(())
    }
}
