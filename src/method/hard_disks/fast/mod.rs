//! The fast engine: the same events as the source's, found by lists of each disc's own, predictions a register of partners at a
//! time, and a tree of groups of eight times.
//!
//! - A disc has one event: the first of its collisions, its wall, or the moment when its list has to be renewed.
//! - What a disc expected of another one that has changed its motion is not looked for at once. When its time comes, the pair's
//!   time is worked out from both states once more: being canonical, it is the same to the bit if it still holds.
//! - Discs lie in memory in the order of their places, and are put so once more now and then.

mod lists;
mod minima;

use crate::method::hard_disks::engine::{Engine, Happened, Stopped};
use crate::method::hard_disks::event::Arena;
use lists::Lists;
use minima::Minima;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend::{Registers, Task, dispatch};
use stripmine_kernels::flight::{Disc, Earliest, MOST_PARTNERS, earliest, meeting};

/// Discs that a list holds on average.
const LISTED: f64 = 9.0;
/// Discs are sorted by their places after this many events of each.
const SORTED_AFTER: u64 = 200;

/// What a disc expects beside other discs, which are known by their places in memory.
const WALL: [u32; 2] = [u32::MAX - 2, u32::MAX - 1];
/// Its list has to be renewed.
const RENEWAL: u32 = u32::MAX;

/// Discs under way.
pub struct Fast {
    arena: Arena,
    set: InstructionSet,
    /// By places in memory.
    discs: Vec<Disc>,
    /// The number of each, and where each number is.
    numbers: Vec<u32>,
    places: Vec<u32>,
    lists: Lists,
    leash: f64,
    largest: f64,
    /// When each disc has its next event (time), and with what.
    times: Minima,
    partners: Vec<u32>,
    /// When a disc meets each of its list (time), while it is predicted.
    met: Box<[f64; MOST_PARTNERS]>,
    /// The time of the last event.
    time: f64,
    renewals: u64,
    events: u64,
    /// Events after which discs are sorted.
    sorted_until: u64,
}

impl Fast {
    /// Begins at a time.
    ///
    /// # Errors
    /// [`Stopped`] if a disc has more others around it than can be listed.
    pub fn new(arena: Arena, discs: Vec<Disc>, set: InstructionSet, time: f64) -> Result<Fast, Stopped> {
        let count = discs.len();
        let largest = discs.iter().map(|disc| disc.radius).fold(0.0, f64::max);
        let leash = leash(&arena, discs.iter().map(|disc| disc.radius)).unwrap_or(0.1 * largest);
        let mut engine = Fast {
            lists: Lists::new(arena.domain, 0, leash, largest, LISTED, 0),
            arena,
            set,
            discs,
            numbers: (0..count as u32).collect(),
            places: vec![0; count],
            leash,
            largest,
            times: Minima::new(count),
            partners: vec![RENEWAL; count],
            met: Box::new([f64::INFINITY; MOST_PARTNERS]),
            time,
            renewals: 0,
            events: 0,
            sorted_until: 0,
        };
        engine.begin(time)?;
        Ok(engine)
    }

    /// Sorts the discs by their places at a time, registers all, and finds what each meets next.
    fn begin(&mut self, time: f64) -> Result<(), Stopped> {
        self.sort(time);
        let count = self.discs.len();
        let mut stride = self.lists.stride();
        let places: Vec<[f64; 2]> = self.discs.iter().map(|disc| self.arena.place(disc, time)).collect();
        loop {
            let (domain, discs) = (self.arena.domain, &self.discs);
            self.lists = Lists::new(domain, count, self.leash, self.largest, LISTED, stride);
            let Err(full) = self.lists.begin(&places, |disc| discs[disc as usize].radius) else { break };
            stride = self.lists.stride() + 16;
            if stride > MOST_PARTNERS + 1 {
                if self.leash < 0.02 * self.largest {
                    return Err(Stopped::Crowded(self.numbers[full as usize], MOST_PARTNERS));
                }
                (self.leash, stride) = (0.7 * self.leash, 0);
            }
        }
        self.times = Minima::new(count);
        self.partners = vec![RENEWAL; count];
        self.renewals += count as u64;
        self.sorted_until = self.events + SORTED_AFTER * count as u64;
        let found = dispatch(self.set, All { engine: self, time });
        found.map_err(|_| Stopped::NoInstructions(self.set))
    }

    /// Puts discs that are near each other near each other in memory: by the digits of their coordinates in turn (Morton).
    fn sort(&mut self, time: f64) {
        let edge = 2.0 * (self.largest + self.leash);
        let key = |disc: &Disc| {
            let at = self.arena.place(disc, time);
            let [x, y] =
                [0, 1].map(|axis| spread(((at[axis] - self.arena.domain.origin[axis]) / edge) as u32));
            x | y << 1
        };
        let mut order: Vec<(u64, u32)> =
            self.discs.iter().zip(&self.numbers).map(|(disc, &number)| (key(disc), number)).collect();
        order.sort_unstable();
        let mut by_number = self.discs.clone();
        for (disc, &number) in self.discs.iter().zip(&self.numbers) {
            by_number[number as usize] = *disc;
        }
        for (place, (_, number)) in order.into_iter().enumerate() {
            self.discs[place] = by_number[number as usize];
            self.numbers[place] = number;
            self.places[number as usize] = place as u32;
        }
    }

    /// Finds the next event of a disc at a time, and tells those who meet it sooner than what they expected.
    #[inline(always)]
    fn predict<R: Registers<Lane = f64>>(&mut self, registers: R, disc: u32, now: f64) {
        let Fast { arena, discs, numbers, lists, times, partners, met, .. } = self;
        let row = lists.of(disc);
        let found = earliest(registers, &arena.space, discs, times.numbers(), (disc, row), now, met);
        let Earliest { time, partners: first, mut surprised } = found;
        let own = &discs[disc as usize];
        let (mut next, mut with) = (time, RENEWAL);
        if time < f64::INFINITY {
            with = row[first.trailing_zeros() as usize];
            let mut others = first & (first - 1);
            // Of two at one time, the one with the smaller number.
            while others != 0 {
                let other = row[others.trailing_zeros() as usize];
                if numbers[other as usize] < numbers[with as usize] {
                    with = other;
                }
                others &= others - 1;
            }
        }
        let (at_wall, axis) = arena.wall(own);
        if at_wall < next {
            (next, with) = (at_wall, WALL[axis]);
        }
        let leaves = leaving(arena, own, lists.place(disc), lists.leash(), now);
        if leaves < next {
            (next, with) = (leaves, RENEWAL);
        }
        while surprised != 0 {
            let lane = surprised.trailing_zeros() as usize;
            let (other, time) = (row[lane], met[lane]);
            let expected = partners[other as usize];
            let is_before = time < times.numbers()[other as usize]
                || expected >= WALL[0]
                || expected != disc && numbers[disc as usize] < numbers[expected as usize];
            if is_before {
                partners[other as usize] = disc;
                times.set(other as usize, time);
            }
            surprised &= surprised - 1;
        }
        partners[disc as usize] = with;
        times.set(disc as usize, next);
    }

    /// The list of a disc is renewed at a time; whether there was room for that. If not, all have begun with longer ones.
    fn renew(&mut self, disc: u32, time: f64) -> Result<bool, Stopped> {
        let place = self.arena.place(&self.discs[disc as usize], time);
        self.renewals += 1;
        let discs = &self.discs;
        match self.lists.renew(disc, place, |disc| discs[disc as usize].radius) {
            Ok(()) => Ok(true),
            Err(_) => self.begin(time).map(|()| false),
        }
    }

    /// As [`Engine::next`].
    #[inline(always)]
    fn next_on<R: Registers<Lane = f64>>(
        &mut self,
        registers: R,
        until: f64,
        most: u64,
    ) -> Result<Option<Happened>, Stopped> {
        let most = most.saturating_mul(self.discs.len() as u64);
        loop {
            let time = self.times.smallest();
            if time > until || time == f64::INFINITY {
                return Ok(None);
            }
            let first = self.first(time);
            if time < self.time {
                return Err(Stopped::BackInTime(self.numbers[first as usize], time, self.time));
            }
            // Whose motion or list has changed, twice the same where it is one.
            let (changed, happened) = match self.partners[first as usize] {
                RENEWAL => {
                    if self.renewals >= most {
                        return Ok(None);
                    }
                    if !self.renew(first, time)? {
                        continue;
                    }
                    ([first; 2], None)
                }
                wall if wall >= WALL[0] => {
                    let number = self.numbers[first as usize];
                    let disc = &mut self.discs[first as usize];
                    let axis = (wall - WALL[0]) as u8;
                    ([first; 2], Some(Happened::at_wall(&self.arena, (number, disc), axis, time)))
                }
                other => {
                    let (low, high) = (first.min(other), first.max(other));
                    let (left, right) = self.discs.split_at_mut(high as usize);
                    let (a, b) = (&mut left[low as usize], &mut right[0]);
                    if meeting(&self.arena.space, a, b, time, f64::INFINITY) == time {
                        let [p, q] = [low, high].map(|disc| self.numbers[disc as usize]);
                        let happened = Happened::collision(&self.arena, (p, a), (q, b), time);
                        ([first, other], Some(happened))
                    } else {
                        // The other one has changed its motion since.
                        ([first; 2], None)
                    }
                }
            };
            let is_one = changed[0] == changed[1];
            for disc in changed.into_iter().take(if is_one { 1 } else { 2 }) {
                self.predict(registers, disc, time);
            }
            if happened.is_some() {
                self.time = time;
                self.events += 1;
                if self.events > self.sorted_until {
                    self.begin(time)?;
                }
                return Ok(happened);
            }
        }
    }

    /// The disc whose event comes first: of several at that time, that with the smallest number.
    #[inline(always)]
    fn first(&self, time: f64) -> u32 {
        let (place, more) = self.times.first(time);
        if more { self.first_by_number(time) } else { place as u32 }
    }

    fn first_by_number(&self, time: f64) -> u32 {
        let mut first = (u32::MAX, u32::MAX);
        self.times.places(time, |place| first = first.min((self.numbers[place], place as u32)));
        first.1
    }
}

impl Engine for Fast {
    fn count(&self) -> usize {
        self.discs.len()
    }

    fn disc(&self, number: u32) -> &Disc {
        &self.discs[self.places[number as usize] as usize]
    }

    fn next(&mut self, until: f64, most: u64) -> Result<Option<Happened>, Stopped> {
        let set = self.set;
        let mut found = Ok(None);
        let missing = |_| Stopped::NoInstructions(set);
        dispatch(set, Next { engine: self, until, most, found: &mut found }).map_err(missing)?;
        found
    }

    fn time(&self) -> f64 {
        self.time
    }

    fn fillings(&self) -> u64 {
        self.renewals / self.discs.len().max(1) as u64
    }

    fn figures(&self) -> Vec<(&'static str, f64)> {
        let count = self.discs.len().max(1);
        let listed: usize = (0..self.discs.len() as u32).map(|disc| self.lists.of(disc).len()).sum();
        vec![
            ("renewals_a_disc", self.renewals as f64 / count as f64),
            ("listed", listed as f64 / count as f64),
            ("leash", self.leash),
        ]
    }
}

/// How far discs may go from where they were registered (length); none in a box too small for lists.
pub fn leash(arena: &Arena, radii: impl Iterator<Item = f64> + Clone) -> Option<f64> {
    lists::leash(&arena.domain, radii, LISTED)
}

/// The next event, compiled for an instruction set.
struct Next<'e> {
    engine: &'e mut Fast,
    until: f64,
    most: u64,
    found: &'e mut Result<Option<Happened>, Stopped>,
}

impl Task<f64> for Next<'_> {
    #[inline(always)]
    fn on<R: Registers<Lane = f64>>(self, registers: R) {
        *self.found = self.engine.next_on(registers, self.until, self.most);
    }
}

/// What every disc meets next, from a time on.
struct All<'e> {
    engine: &'e mut Fast,
    time: f64,
}

impl Task<f64> for All<'_> {
    #[inline(always)]
    fn on<R: Registers<Lane = f64>>(self, registers: R) {
        for disc in 0..self.engine.discs.len() as u32 {
            self.engine.predict(registers, disc, self.time);
        }
    }
}

/// When a disc that is where it should be at `now` may be farther than `leash` from where it was registered (time).
#[inline]
fn leaving(arena: &Arena, disc: &Disc, registered: [f64; 2], leash: f64, now: f64) -> f64 {
    let [dx, dy] = arena.domain.displacement(registered, disc.at(&arena.space, now));
    let [u, v] = disc.velocity_at(&arena.space, now);
    let square = u * u + v * v;
    let left = leash * leash - (dx * dx + dy * dy);
    match arena.space.gravity() {
        None if square == 0.0 => f64::INFINITY,
        None => {
            let outwards = dx * u + dy * v;
            let root = (outwards * outwards + square * left.max(0.0)).sqrt();
            now + if outwards > 0.0 { left.max(0.0) / (outwards + root) } else { (root - outwards) / square }
        }
        // No farther than as if it flew and fell straight away from there.
        Some([gx, gy]) => {
            let way = (leash - (dx * dx + dy * dy).sqrt()).max(0.0);
            let root = (square + 2.0 * (gx * gx + gy * gy).sqrt() * way).sqrt();
            now + 2.0 * way / (square.sqrt() + root)
        }
    }
}

/// The bits of a number with a place free after each.
fn spread(number: u32) -> u64 {
    let mut bits = u64::from(number);
    for (shift, mask) in [
        (16, 0x0000_FFFF_0000_FFFF_u64),
        (8, 0x00FF_00FF_00FF_00FF),
        (4, 0x0F0F_0F0F_0F0F_0F0F),
        (2, 0x3333_3333_3333_3333),
        (1, 0x5555_5555_5555_5555),
    ] {
        bits = (bits | bits << shift) & mask;
    }
    bits
}
