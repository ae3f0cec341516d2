//! The source's engine: local minima over masks of the exclusive grid, a complete binary tree, local times, and no events for
//! leaving a cell. ISO99.

use super::event::{Disc, Impact, Law, collide, meeting, rebound, wall};
use super::grid::{Grid, Sizes};
use super::tournament::Tournament;
use crate::domain::Domain;
use stripmine_kernels::mask::Mask;

/// What a disc will meet next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// When (time); infinite if nothing.
    pub time: f64,
    /// What.
    pub with: Partner,
}

/// What a disc meets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Partner {
    /// A disc, by its number.
    Disc(u32),
    /// A closed side across an axis.
    Wall(u8),
}

impl Event {
    /// Nothing.
    const NONE: Event = Event { time: f64::INFINITY, with: Partner::Wall(0) };

    /// Whether it comes before another one of the same disc; of two at one time, that with the smaller number.
    #[inline(always)]
    fn is_before(&self, other: &Event) -> bool {
        self.time < other.time || self.time == other.time && self.with < other.with
    }
}

/// What has happened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Happened {
    /// When (time).
    pub time: f64,
    /// To which disc, the one with the smaller number of two.
    pub disc: u32,
    /// With what.
    pub with: Partner,
    /// Of two discs: how.
    pub impact: Option<Impact>,
}

/// Why the discs stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stopped {
    /// Two discs have their centres in one cell: they overlap.
    SharedCell([u32; 2]),
    /// An event lies before one that has happened (time, time).
    BackInTime(u32, f64, f64),
}

/// Discs under way.
#[derive(Clone, Debug)]
pub struct Engine {
    domain: Domain,
    law: Law,
    discs: Vec<Disc>,
    grid: Grid,
    events: Vec<Event>,
    tree: Tournament,
    /// The time of the last event, or up to which it is known that there is none.
    time: f64,
    /// What two discs may approach each other by until the masks miss one (length), at the time `since`.
    slack: f64,
    since: f64,
    /// No disc is faster (length/time).
    fastest: f64,
    /// r_NL − 2 σ_max (length): the slack of a new grid.
    whole_slack: f64,
    /// How often the grid was filled.
    remaps: u64,
    /// Discs that have lost their partner, while an event is dealt with.
    lost: Vec<u32>,
    /// The discs' speeds when the grid was filled (length/time).
    speeds: Vec<f64>,
}

/// Distances that may not be exceeded are taken this much larger.
const ROUNDED_UP: f64 = 1.0 + 1e-9;

impl Engine {
    /// Begins at a time.
    ///
    /// # Errors
    /// [`Stopped`] if discs overlap so much that they share a cell.
    pub fn new(
        domain: Domain,
        law: Law,
        discs: Vec<Disc>,
        mask: &Mask,
        time: f64,
    ) -> Result<Engine, Stopped> {
        let radii = || discs.iter().map(|disc| disc.radius);
        let sizes = Sizes::new(&domain, radii().fold(f64::INFINITY, f64::min));
        let whole_slack = sizes.reach(mask) - 2.0 * radii().fold(0.0, f64::max);
        let mut engine = Engine {
            grid: Grid::new(domain, sizes, mask),
            events: vec![Event::NONE; discs.len()],
            tree: Tournament::new(discs.len(), |_| f64::INFINITY),
            domain,
            law,
            discs,
            time,
            slack: 0.0,
            since: time,
            fastest: 0.0,
            whole_slack,
            remaps: 0,
            lost: vec![],
            speeds: vec![],
        };
        engine.remap(time)?;
        Ok(engine)
    }

    /// The discs, each as it was after its last event.
    pub fn discs(&self) -> &[Disc] {
        &self.discs
    }

    /// How often the grid was filled.
    pub fn remaps(&self) -> u64 {
        self.remaps
    }

    /// Discs for each cell.
    pub fn occupancy(&self) -> f64 {
        self.grid.occupancy()
    }

    /// The time of the last event, or up to which it is known that there is none.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// The next event, if it comes no later than `until` (time) and before the grid has been filled `most` times in all.
    ///
    /// # Errors
    /// [`Stopped`]: what must not be.
    pub fn next(&mut self, until: f64, most: u64) -> Result<Option<Happened>, Stopped> {
        loop {
            let first = self.tree.first();
            let event = self.events[first as usize];
            // ISO99 (6), with the largest speed kept up to date.
            let horizon = self.horizon();
            if event.time > until.min(horizon) {
                if until <= horizon || self.remaps >= most {
                    return Ok(None);
                }
                // Rounding may put the horizon just before the last event.
                self.remap(horizon.max(self.time))?;
                continue;
            }
            if event.time < self.time {
                return Err(Stopped::BackInTime(first, event.time, self.time));
            }
            self.time = event.time;
            return Ok(Some(self.happen(first, event)));
        }
    }

    /// Up to when the masks show every partner (time). Nothing later is predicted.
    fn horizon(&self) -> f64 {
        self.since + self.slack / (2.0 * self.fastest)
    }

    fn happen(&mut self, first: u32, event: Event) -> Happened {
        let Event { time, with } = event;
        match with {
            Partner::Wall(axis) => {
                rebound(&self.domain, &self.law, &mut self.discs[first as usize], axis.into(), time);
                self.heed(first);
                self.repair([first, first]);
                Happened { time, disc: first, with, impact: None }
            }
            Partner::Disc(other) => {
                let [a, b] = [first.min(other), first.max(other)];
                let (left, right) = self.discs.split_at_mut(b as usize);
                let impact = collide(&self.domain, &self.law, &mut left[a as usize], &mut right[0], time);
                self.heed(a);
                self.heed(b);
                self.repair([a, b]);
                Happened { time, disc: a, with: Partner::Disc(b), impact: Some(impact) }
            }
        }
    }

    /// The dynamic upper cut-off: a disc that is faster than all shortens the time for which masks are whole.
    fn heed(&mut self, disc: u32) {
        let speed = self.discs[disc as usize].speed();
        if speed > self.fastest {
            self.slack -= 2.0 * self.fastest * (self.time - self.since);
            self.since = self.time;
            self.fastest = speed;
        }
    }

    /// Finds the next events of discs whose motion has changed, and of those that expected to meet them.
    fn repair(&mut self, changed: [u32; 2]) {
        let [a, b] = changed;
        let mut lost = std::mem::take(&mut self.lost);
        let (now, horizon) = (self.time, self.horizon());
        for &disc in if a == b { &changed[..1] } else { &changed[..] } {
            let mut own = self.at_wall(disc);
            let Engine { grid, discs, events, tree, domain, .. } = self;
            for other in grid.around(disc) {
                let time = pair(domain, discs, [disc, other], now, horizon);
                let theirs = Event { time, with: Partner::Disc(other) };
                if theirs.is_before(&own) {
                    own = theirs;
                }
                if other == a || other == b {
                    continue;
                }
                let known = events[other as usize];
                let ours = Event { time, with: Partner::Disc(disc) };
                if known.with == Partner::Disc(disc) {
                    lost.push(other);
                } else if ours.is_before(&known) {
                    events[other as usize] = ours;
                    tree.update(other, events.len(), |disc| events[disc as usize].time);
                }
            }
            self.renew(disc, own);
        }
        for disc in lost.drain(..) {
            self.renew(disc, self.predicted(disc));
        }
        self.lost = lost;
    }

    /// The next event of a disc is another.
    fn renew(&mut self, disc: u32, event: Event) {
        let Engine { events, tree, .. } = self;
        events[disc as usize] = event;
        tree.update(disc, events.len(), |disc| events[disc as usize].time);
    }

    fn at_wall(&self, disc: u32) -> Event {
        let (time, axis) = wall(&self.domain, &self.discs[disc as usize]);
        Event { time, with: Partner::Wall(axis as u8) }
    }

    /// What a disc meets next, of all that its mask shows.
    fn predicted(&self, disc: u32) -> Event {
        let horizon = self.horizon();
        self.grid.around(disc).fold(self.at_wall(disc), |next, other| {
            let time = pair(&self.domain, &self.discs, [disc, other], self.time, horizon);
            let event = Event { time, with: Partner::Disc(other) };
            if event.is_before(&next) { event } else { next }
        })
    }

    /// Fills the grid with the discs as they are at a time, and finds what each meets next.
    fn remap(&mut self, time: f64) -> Result<(), Stopped> {
        self.grid.fill(&self.discs, time).map_err(Stopped::SharedCell)?;
        self.time = time;
        self.since = time;
        self.slack = self.whole_slack;
        self.fastest = self.discs.iter().map(Disc::speed).fold(0.0, f64::max);
        self.remaps += 1;
        for disc in 0..self.discs.len() as u32 {
            self.events[disc as usize] = self.at_wall(disc);
        }
        let (now, horizon, ahead) = (time, self.horizon(), self.slack / (2.0 * self.fastest));
        let Engine { grid, discs, events, domain, speeds, .. } = self;
        speeds.clear();
        speeds.extend(discs.iter().map(Disc::speed));
        // Each pair once, if it may meet so soon at all.
        for disc in 0..discs.len() as u32 {
            let (own, speed, here) = (&discs[disc as usize], speeds[disc as usize], grid.place(disc));
            for other in grid.around(disc).filter(|&other| other > disc) {
                let [dx, dy] = domain.displacement(here, grid.place(other));
                let reach = own.radius + discs[other as usize].radius;
                let near = (reach + (speed + speeds[other as usize]) * ahead) * ROUNDED_UP;
                if dx * dx + dy * dy > near * near {
                    continue;
                }
                let time = pair(domain, discs, [disc, other], now, horizon);
                for (one, with) in [(disc, other), (other, disc)] {
                    let event = Event { time, with: Partner::Disc(with) };
                    if event.is_before(&events[one as usize]) {
                        events[one as usize] = event;
                    }
                }
            }
        }
        let events = &self.events;
        self.tree.renew(events.len(), |disc| events[disc as usize].time);
        Ok(())
    }
}

/// When two discs meet, by their numbers.
#[inline(always)]
fn pair(domain: &Domain, discs: &[Disc], [disc, other]: [u32; 2], now: f64, horizon: f64) -> f64 {
    let [a, b] = [disc.min(other), disc.max(other)];
    meeting(domain, &discs[a as usize], &discs[b as usize], now, horizon)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::RngExt;
    use stripmine_kernels::noise::{Purpose, Stream};

    /// Every pair and every wall, again and again.
    fn naive(domain: &Domain, law: &Law, discs: &mut [Disc], now: f64) -> Happened {
        let count = discs.len() as u32;
        let mut next = (f64::INFINITY, 0, Partner::Wall(0));
        for a in 0..count {
            let (time, axis) = wall(domain, &discs[a as usize]);
            let meetings = (0..count).filter(|&b| b != a).map(|b| {
                let [first, second] = [a.min(b), a.max(b)];
                (
                    meeting(domain, &discs[first as usize], &discs[second as usize], now, f64::INFINITY),
                    Partner::Disc(b),
                )
            });
            let all = meetings.chain([(time, Partner::Wall(axis as u8))]);
            for (time, with) in all {
                if (time, a, with) < next {
                    next = (time, a, with);
                }
            }
        }
        let (time, first, with) = next;
        match with {
            Partner::Wall(axis) => {
                rebound(domain, law, &mut discs[first as usize], axis.into(), time);
                Happened { time, disc: first, with, impact: None }
            }
            Partner::Disc(other) => {
                let [a, b] = [first.min(other), first.max(other)];
                let (left, right) = discs.split_at_mut(b as usize);
                let impact = collide(domain, law, &mut left[a as usize], &mut right[0], time);
                Happened { time, disc: a, with: Partner::Disc(b), impact: Some(impact) }
            }
        }
    }

    /// Discs at random places with random velocities; radii and masses differ by up to `spread`.
    fn random(domain: &Domain, count: usize, spread: f64, seed: u64) -> Vec<Disc> {
        let mut stream = Stream::new(seed, Purpose::Test, 1);
        let mut discs: Vec<Disc> = vec![];
        while discs.len() < count {
            let radius = 0.5 * (1.0 + spread * stream.random_range(0.0..1.0));
            let position = [0, 1].map(|axis| {
                domain.origin[axis]
                    + radius
                    + stream.random_range(0.0..1.0) * (domain.length(axis) - 2.0 * radius)
            });
            if discs.iter().all(|it| domain.distance(it.position, position) > radius + it.radius) {
                let velocity = [0, 1].map(|_| stream.random_range(-1.0..1.0));
                let mass = 4.0 * radius * radius;
                discs.push(Disc { position, velocity, time: 0.0, radius, mass, met: f64::NEG_INFINITY });
            }
        }
        discs
    }

    /// The same events at the same times, to the bit, whatever the mask, the sides, the sizes and the restitution.
    #[test]
    fn events_are_those_of_all_pairs() {
        let masks = [Mask::square(2), Mask::round(3), Mask::round(4)];
        let mut cases = 0;
        for (seed, periodic) in [[true, true], [true, false], [false, false]].into_iter().enumerate() {
            for (spread, restitution) in [(0.0, 1.0), (0.1, 0.9)] {
                let domain = Domain::planar([-2.0, 1.0], [9.0, 8.0], periodic);
                let law = Law { restitution, wall_restitution: 1.0, contact_duration: 0.0 };
                let discs = random(&domain, 30, spread, seed as u64);
                let mut oracle = discs.clone();
                let mut now = 0.0;
                let mut next = || {
                    let event = naive(&domain, &law, &mut oracle, now);
                    now = event.time;
                    event
                };
                let events: Vec<Happened> = (0..600).map(|_| next()).collect();
                for mask in &masks {
                    let mut engine = Engine::new(domain, law, discs.clone(), mask, 0.0).unwrap();
                    for (number, event) in events.iter().enumerate() {
                        let found = engine.next(f64::INFINITY, u64::MAX).unwrap().unwrap();
                        assert_eq!(found, *event, "event {number}, {} places", mask.offsets().len());
                        cases += 1;
                    }
                    assert_eq!(engine.discs(), oracle);
                    assert!(engine.remaps() > 3);
                }
            }
        }
        assert_eq!(cases, 3 * 2 * 3 * 600);
    }

    /// 10⁵ collisions of 80 discs: energy stays to rounding, momentum too, and nothing overlaps.
    #[test]
    fn energy_and_momentum_stay() {
        let domain = Domain::planar([0.0; 2], [13.0, 12.0], [true; 2]);
        let law = Law { restitution: 1.0, wall_restitution: 1.0, contact_duration: 0.0 };
        let discs = random(&domain, 80, 0.1, 5);
        let energy =
            |discs: &[Disc]| -> f64 { discs.iter().map(|it| 0.5 * it.mass * it.speed().powi(2)).sum() };
        let momentum = |discs: &[Disc]| -> f64 { discs.iter().map(|it| it.mass * it.velocity[0]).sum() };
        let before = [energy(&discs), momentum(&discs)];
        let mut engine = Engine::new(domain, law, discs, &Mask::round(3), 0.0).unwrap();
        let mut time = 0.0;
        for _ in 0..100_000 {
            time = engine.next(f64::INFINITY, u64::MAX).unwrap().unwrap().time;
        }
        let after = engine.discs();
        assert!(
            (energy(after) / before[0] - 1.0).abs() < 1e-12 && (momentum(after) - before[1]).abs() < 1e-11
        );
        for (number, a) in after.iter().enumerate() {
            for b in &after[number + 1..] {
                let apart = domain.distance(domain.wrapped(a.at(time)), domain.wrapped(b.at(time)));
                assert!(apart > (a.radius + b.radius) * (1.0 - 1e-12), "{apart}");
            }
        }
    }
}
