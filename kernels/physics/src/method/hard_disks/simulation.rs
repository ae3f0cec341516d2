//! Simulation of hard discs: advances the engine event by event and observes the discs.

mod changes;

use super::checked::StartingDiscs;
use super::collapse::{CollapseMonitor, EndlessCollisions};
use super::collision_log::Log;
use super::configuration::EngineConfiguration;
use super::engine::{EngineError, EventEngine, EventPartner, ExecutedEvent};
use super::event::Arena;
use super::failures::{culprit, failure};
use super::followed::CrossingCounter;
use super::identities::DiscIdentities;
use super::idle::is_idle_forever;
use super::quantities::{HardDiskObservation, OBSERVABLES};
use super::restored::check_restored_discs;
use super::sums::{CollisionTotals, IntervalMark, IntervalMeans, TotalMotion};
use crate::io::checkpoint::CheckpointColumn;
use crate::method::observed::values;
use crate::method::{
    Change, Clock, Culprit, PerParticle, PhysicsFailure, RunWarning, Simulation, Snapshot, Steering,
    SteeringError, Until, WORK_OF_CHANGES,
};
use crate::number::{count_with_noun, significant};
use crate::observe::relative_energy_error;
use crate::particles::{GrainStates, Particle, Particles};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use stripmine_kernels::flight::FlyingDisc;

/// Events, or rebuilds of the grid, between checks for an interruption.
const INTERRUPT_CHECK_INTERVAL: u64 = 4096;

/// Running simulation of hard discs.
pub(super) struct HardDiskSimulation {
    engine: Box<dyn EventEngine>,
    configuration: EngineConfiguration,
    arena: Arena,
    clock: Clock,
    totals: CollisionTotals,
    watch: CollapseMonitor,
    /// Sums at the previous row or change.
    row: IntervalMark,
    /// Sums at the last change, or at the start.
    since: IntervalMark,
    /// Changes so far.
    steering: Steering,
    /// Kinetic and potential energy at the start.
    start: [f64; 2],
    /// True if the idleness check has run since the last event and proved nothing.
    may_meet: bool,
    identities: DiscIdentities,
    /// Energy available to the discs at the start or at the last change, for the check of a checkpoint.
    available_energy: f64,
    /// Rows of collisions, if requested.
    log: Option<Log>,
    /// Crossings of periodic sides, if displacements are requested.
    followed: Option<CrossingCounter>,
    seconds: f64,
}

/// Optional records of a run.
#[derive(Clone, Copy, Debug)]
pub(super) struct RecordOptions {
    /// Logs every collision.
    pub(super) logs: bool,
    /// Counts crossings of periodic sides.
    pub(super) follows: bool,
}

impl HardDiskSimulation {
    /// Starts the simulation from the discs of a checked scene.
    pub(super) fn new(
        arena: Arena,
        configuration: EngineConfiguration,
        StartingDiscs { discs, identities, energy: available_energy }: StartingDiscs,
        observed: RecordOptions,
    ) -> Result<HardDiskSimulation, PhysicsFailure> {
        let kinetic = TotalMotion::of(discs.iter(), &arena, 0.0).kinetic();
        let start = [kinetic, potential(discs.iter(), &arena, 0.0)];
        let watch = CollapseMonitor::new(crossing(discs.iter()), falling(&discs, &arena), discs.len());
        let followed = observed.follows.then(|| CrossingCounter::new(&arena, discs.clone()));
        let mut simulation = HardDiskSimulation {
            engine: configuration.engine(arena, discs, 0.0),
            configuration,
            arena,
            clock: Clock::default(),
            totals: CollisionTotals::default(),
            watch,
            row: IntervalMark::default(),
            since: IntervalMark::default(),
            steering: Steering::default(),
            start,
            identities,
            available_energy,
            may_meet: false,
            log: observed.logs.then(Log::default),
            followed,
            seconds: 0.0,
        };
        match simulation.engine.begin() {
            Ok(()) => Ok(simulation),
            Err(why) => Err(simulation.failure(why)),
        }
    }

    /// Disc with a number as it is now.
    fn particle(&self, number: u32) -> Particle {
        let (disc, time) = (self.engine.disc(number), self.clock.time);
        let position = self.arena.position_at(disc, time);
        self.identities.particle(number, disc, position, disc.velocity_at(&self.arena.space, time))
    }

    /// Iterates over the discs in the order of their numbers.
    fn discs(&self) -> impl Iterator<Item = &FlyingDisc> {
        (0..self.engine.count() as u32).map(|number| self.engine.disc(number))
    }

    /// Runs the engine up to a time, for at most as many partner searches, and until a moment is reached or an interruption is due.
    /// Returns true if events are left, and the event that completes endless collisions.
    fn run_engine(
        &mut self,
        end: f64,
        most: u64,
        until: &[Until],
    ) -> Result<(bool, Option<(ExecutedEvent, EndlessCollisions)>), EngineError> {
        let HardDiskSimulation {
            engine,
            arena,
            clock,
            totals,
            watch,
            may_meet,
            identities,
            log,
            followed,
            ..
        } = self;
        let mut endless = None;
        let left = engine.run(end, most, &mut |happened, discs| {
            clock.events += 1;
            clock.time = happened.time;
            *may_meet = false;
            totals.add(happened);
            if let Some(followed) = followed {
                let mut see = |disc: u32| followed.register_crossings(arena, disc, discs.disc(disc));
                see(happened.disc);
                if let EventPartner::Disc(other) = happened.with {
                    see(other);
                }
            }
            if let Some(log) = log {
                let id = |disc: u32| identities.id(disc);
                log.add(clock.events, happened, arena, &|disc| discs.disc(disc), &id);
            }
            let crossing = || crossing((0..discs.count() as u32).map(|number| discs.disc(number)));
            endless = watch.register_event(happened, crossing).map(|endless| (*happened, endless));
            endless.is_none()
                && !clock.events.is_multiple_of(INTERRUPT_CHECK_INTERVAL)
                && !until.iter().any(|moment| moment.has_been_reached(clock))
        })?;
        Ok((left, endless))
    }

    /// True if no event can ever happen. The proof runs at most once between two events.
    fn is_idle(&mut self) -> bool {
        if !self.may_meet {
            let discs: Vec<FlyingDisc> = self.discs().copied().collect();
            self.may_meet = !is_idle_forever(&self.arena, &discs);
        }
        !self.may_meet
    }

    fn idle(&self) -> PhysicsFailure {
        let message = "no disc will ever meet another disc or a side";
        let remedy = "set run.time instead of run.events, or give the discs other velocities";
        PhysicsFailure::new(super::IDLE, message, remedy).at(self.clock)
    }

    fn failure(&self, why: EngineError) -> PhysicsFailure {
        failure(why, self.engine.as_ref(), &self.identities, self.clock)
    }

    fn endless(
        &self,
        happened: &ExecutedEvent,
        EndlessCollisions { rests, events, duration }: EndlessCollisions,
    ) -> PhysicsFailure {
        let discs = [
            Some(happened.disc),
            if let EventPartner::Disc(other) = happened.with { Some(other) } else { None },
        ];
        let culprits: Vec<Culprit> = discs.into_iter().flatten().map(|disc| self.culprit(disc)).collect();
        let named: Vec<String> = culprits.iter().map(ToString::to_string).collect();
        let (named, took) = (named.join(" and "), significant(duration, 4));
        let (kind, message, remedy) = if rests {
            let message = format!(
                "{named} has come to rest: it and the discs below it had {events} events within a time of {took}, but hard \
                 discs have no lasting contacts"
            );
            let least = significant(1e-4 * falling(self.discs(), &self.arena), 1);
            let remedy = format!(
                "raise law.contact_duration to {least} or more, so that discs at rest bounce less often; raise law.wall_restitution; or \
                 use soft discs, method.kind = \"lattice-md\""
            );
            (super::RESTING, message, remedy)
        } else {
            let message = format!(
                "inelastic collapse: {events} collisions within a time of {took}, the last of {named}"
            );
            let remedy = "set law.contact_duration to a small fraction of the mean free time, so that more frequent collisions are \
                          elastic; or raise law.restitution";
            (super::INELASTIC_COLLAPSE, message, remedy.to_owned())
        };
        let failure = PhysicsFailure::new(kind, message, remedy).at(self.clock);
        let rate = events as f64 / duration.max(f64::MIN_POSITIVE);
        failure.of(culprits.len() as u64, culprits).with([
            ("events", events as f64),
            ("duration", duration),
            ("rate", rate),
        ])
    }

    fn culprit(&self, disc: u32) -> Culprit {
        culprit(disc, self.engine.as_ref(), &self.identities)
    }
}

/// Total potential energy of the discs at a time.
fn potential<'d>(discs: impl Iterator<Item = &'d FlyingDisc>, arena: &Arena, time: f64) -> f64 {
    discs.map(|disc| arena.potential(disc, time)).sum()
}

/// Time in which a disc of typical speed flies through the smallest radius.
fn crossing<'d>(discs: impl Iterator<Item = &'d FlyingDisc>) -> f64 {
    let (mut count, mut squares, mut smallest) = (0.0, 0.0, f64::INFINITY);
    for disc in discs {
        count += 1.0;
        squares += disc.speed().powi(2);
        smallest = disc.radius.min(smallest);
    }
    smallest / (squares / count).sqrt()
}

/// Time in which a disc falls through the smallest radius; infinite without gravity.
fn falling<'d>(discs: impl IntoIterator<Item = &'d FlyingDisc>, arena: &Arena) -> f64 {
    let [gx, gy] = arena.space.gravity().unwrap_or_default();
    let smallest = discs.into_iter().map(|disc| disc.radius).fold(f64::INFINITY, f64::min);
    (2.0 * smallest / gx.hypot(gy)).sqrt()
}

impl HardDiskSimulation {
    /// Current motion of all discs.
    fn motion(&self) -> TotalMotion {
        TotalMotion::of(self.discs(), &self.arena, self.clock.time)
    }

    /// Current observation, and the sums from which its means are calculated.
    fn observation_and_mark(&self) -> (HardDiskObservation, IntervalMark) {
        let (time, motion) = (self.clock.time, self.motion());
        let mark = self.totals.mark(&self.arena, self.discs(), &motion, time);
        let IntervalMeans { compressibility, collision_rate } = mark.since(&self.row, &motion);
        let (kinetic, gravitational) = (motion.kinetic(), potential(self.discs(), &self.arena, time));
        let [kinetic_at_start, potential_at_start] = self.start;
        let CollisionTotals { collisions, virial, work, .. } = self.totals;
        let given = self.steering.work;
        let change = (kinetic - kinetic_at_start) + (gravitational - potential_at_start) - work - given;
        let start = kinetic_at_start + potential_at_start + given;
        let seen = HardDiskObservation {
            clock: self.clock,
            collisions,
            kinetic,
            gravitational,
            work,
            energy_error: relative_energy_error(change, start, kinetic_at_start, kinetic),
            temperature: motion.temperature(),
            momentum: motion.axes.map(|axis| axis.momentum),
            virial,
            compressibility,
            collision_rate,
        };
        (seen, mark)
    }
}

impl PerParticle for HardDiskSimulation {
    fn particles(&self) -> Particles {
        Particles::of_grains(self.identities.in_scene_order(|number| self.particle(number)))
    }

    fn checksum(&self) -> String {
        Particles::checksum_in_order((0..self.engine.count() as u32).map(|number| self.particle(number)))
    }

    fn states(&self, states: &mut GrainStates) {
        let time = self.clock.time;
        for (disc, number) in self.discs().zip(0..) {
            states.store_state(
                self.identities.place(number),
                self.arena.position_at(disc, time),
                disc.velocity_at(&self.arena.space, time),
            );
        }
    }

    fn images(&self) -> Vec<[i32; 2]> {
        let Some(followed) = self.followed.as_ref().filter(|it| it.is_following_all_sides(&self.arena))
        else {
            return vec![];
        };
        let image = |number| followed.image(&self.arena, number as usize, self.clock.time);
        self.identities.in_scene_order(image)
    }
}

impl Simulation for HardDiskSimulation {
    fn advance(&mut self, until: &[Until], interrupted: &AtomicBool) -> Result<(), PhysicsFailure> {
        let begun = Instant::now();
        let end = until.iter().filter_map(|moment| match moment {
            Until::Time(time) => Some(*time),
            Until::Steps(_) | Until::Events(_) => None,
        });
        let end = end.fold(f64::INFINITY, f64::min);
        while !until.iter().any(|moment| moment.has_been_reached(&self.clock)) {
            if self.clock.events.is_multiple_of(INTERRUPT_CHECK_INTERVAL)
                && interrupted.load(Ordering::Relaxed)
            {
                break;
            }
            let since_check = self.engine.rebuilds() + INTERRUPT_CHECK_INTERVAL;
            match self.run_engine(end, since_check, until) {
                Err(why) => return Err(self.failure(why)),
                Ok((_, Some((happened, endless)))) => return Err(self.endless(&happened, endless)),
                Ok((true, None)) => {}
                // No event is left, or none up to the end, or none within the checked number of rebuilds.
                Ok(_) if self.engine.rebuilds() < since_check && end.is_finite() => self.clock.time = end,
                Ok(_) if self.engine.rebuilds() < since_check || self.is_idle() => {
                    if end.is_infinite() {
                        return Err(self.idle());
                    }
                    self.clock.time = end;
                }
                Ok(_) if interrupted.load(Ordering::Relaxed) => break,
                Ok(_) => {}
            }
        }
        self.seconds += begun.elapsed().as_secs_f64();
        Ok(())
    }

    fn clock(&self) -> Clock {
        self.clock
    }

    fn per_particle(&self) -> &dyn PerParticle {
        self
    }

    fn observe(&self) -> Vec<f64> {
        values(&OBSERVABLES, &self.observation_and_mark().0)
    }

    fn row(&mut self) -> Vec<f64> {
        let (seen, mark) = self.observation_and_mark();
        self.row = mark;
        values(&OBSERVABLES, &seen)
    }

    fn snapshot(&self) -> Snapshot {
        let column = |(name, of): (&str, DiscField)| {
            (name.to_owned(), CheckpointColumn::F64(self.discs().map(|disc| *of(&mut { *disc })).collect()))
        };
        let mut kept = self.engine.snapshot();
        kept.columns.extend(FIELDS.map(column));
        kept.add_column("events", CheckpointColumn::U64(self.discs().map(|disc| disc.events).collect()));
        self.totals.keep(&mut kept);
        self.row.keep("row", &mut kept);
        self.keep_changes(&mut kept);
        self.watch.keep(&mut kept);
        kept.columns.extend(self.followed.iter().flat_map(CrossingCounter::columns));
        kept
    }

    fn restore(&mut self, clock: Clock, snapshot: Snapshot) -> Result<(), String> {
        clock.check_event_clock()?;
        self.take_changes(&snapshot)?;
        let mut discs: Vec<FlyingDisc> = self.discs().copied().collect();
        for (name, of) in FIELDS {
            let values = snapshot.numbers(name, discs.len())?;
            discs.iter_mut().zip(values).for_each(|(disc, &value)| *of(disc) = value);
        }
        let events = snapshot.counts_at_most("events", discs.len(), clock.events)?;
        discs.iter_mut().zip(events).for_each(|(disc, &count)| disc.events = count);
        check_restored_discs(&self.arena, self.available_energy, &discs, &clock, &snapshot)?;
        if self.steering.gravity.is_some() {
            let rebuilt = self.rebuild_engine(discs.clone(), clock.time);
            rebuilt.map_err(|failure| failure.what_and_when())?;
        }
        self.totals = CollisionTotals::totals_from_snapshot(&snapshot, clock.events)?;
        self.row = IntervalMark::mark_from_snapshot("row", &snapshot, &self.totals)?;
        self.since = self.mark_of_changes(&snapshot)?;
        self.watch.restore(&snapshot)?;
        if let Some(followed) = &mut self.followed {
            followed.take_up(&discs, &snapshot.columns)?;
        }
        self.engine.restore(discs, &snapshot)?;
        (self.clock, self.may_meet) = (clock, false);
        Ok(())
    }

    fn steer(&mut self, change: &Change) -> Result<(), SteeringError> {
        self.make_change(change)
    }

    fn phases(&self) -> BTreeMap<&'static str, f64> {
        BTreeMap::from([("events", self.seconds)])
    }

    fn reset_phases(&mut self) {
        self.seconds = 0.0;
    }

    fn work(&self) -> f64 {
        self.clock.events as f64
    }

    fn summary(&self) -> Map<String, Value> {
        let CollisionTotals { collisions, made_elastic, virial, .. } = self.totals;
        let entries = [
            ("discs", json!(self.identities.count())),
            ("collisions", json!(collisions)),
            ("made_elastic", json!(made_elastic)),
            ("virial", json!(virial)),
        ];
        let work = self.is_changed().then(|| (WORK_OF_CHANGES, json!(self.steering.work)));
        let entries = entries.into_iter().chain(work);
        let figures = self.engine.figures().into_iter().map(|(name, value)| (name, json!(value)));
        entries.chain(figures).map(|(name, value)| (name.to_owned(), value)).collect()
    }

    fn event_operations(&self) -> Vec<(&'static str, u64)> {
        self.engine.operations().named()
    }

    fn take_events(&mut self) -> String {
        self.log.as_mut().map(Log::take).unwrap_or_default()
    }

    fn warnings(&self) -> Vec<RunWarning> {
        let CollisionTotals { collisions, made_elastic, .. } = self.totals;
        let message = format!(
            "{made_elastic} of {collisions} collisions were made elastic, because either disc had collided less than \
             law.contact_duration = {} before",
            self.arena.law.contact_duration
        );
        let warning = RunWarning { check: "made-elastic", value: made_elastic as f64, limit: 0.0, message };
        if made_elastic > 0 { vec![warning] } else { vec![] }
    }

    fn in_words(&self) -> String {
        let (HardDiskObservation { temperature, .. }, mark) = self.observation_and_mark();
        let IntervalMeans { compressibility, collision_rate } = mark.since(&self.since, &self.motion());
        let temperature = match temperature.is_nan() {
            true => "none (no degree of freedom)".to_owned(),
            false => significant(temperature, 5),
        };
        format!(
            "{}, {} collisions of pairs; temperature {temperature}; since the {}: compressibility {}, {} collisions per disc and \
             unit of time",
            count_with_noun(self.identities.count(), "disc", "discs"),
            self.totals.collisions,
            if self.is_changed() { "last change" } else { "start" },
            significant(compressibility, 5),
            significant(collision_rate, 5)
        )
    }
}

type DiscField = fn(&mut FlyingDisc) -> &mut f64;

/// Fields of a disc that a checkpoint stores.
const FIELDS: [(&str, DiscField); 5] = [
    ("x", |disc| &mut disc.position[0]),
    ("y", |disc| &mut disc.position[1]),
    ("vx", |disc| &mut disc.velocity[0]),
    ("vy", |disc| &mut disc.velocity[1]),
    ("local_time", |disc| &mut disc.time),
];
