//! Hard discs under way, observed.

use super::collapse::{Collapse, Watch};
use super::engine::{Engine, Happened, Partner, Stopped};
use super::event::{Disc, Law};
use super::prepared::Checked;
use crate::domain::Domain;
use crate::io::checkpoint::{Column, Counter};
use crate::method::{Clock, Culprit, Failure, FailureKind, RunWarning, Simulation, Snapshot, Until};
use crate::particles::{Particles, in_space};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use stripmine_kernels::mask::Mask;

/// Events, or fillings of the grid, between looks at whether a run is to be interrupted.
const UNHEARD: u64 = 4096;
/// After the grid was filled this often without an event nothing will ever happen: discs fly beside each other.
const IDLE: u64 = 200_000;

/// Discs under way.
pub(super) struct Running {
    engine: Engine,
    clock: Clock,
    totals: Totals,
    watch: Watch,
    /// Kinetic energy at the start.
    kinetic: f64,
    smallest_radius: f64,
    domain: Domain,
    law: Law,
    mask: Mask,
    /// How often the grid was filled up to the last event.
    filled: u64,
    /// The particles of the start, and the place among them of each disc.
    particles: Particles,
    places: Vec<usize>,
    seconds: f64,
}

/// What is counted and summed up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Totals {
    collisions: u64,
    made_elastic: u64,
    virial: f64,
}

impl Running {
    pub(super) fn new(checked: &Checked) -> Result<Running, Failure> {
        let (discs, places) = checked.discs();
        let kinetic = kinetic(&discs);
        let smallest_radius = discs.iter().map(|disc| disc.radius).fold(f64::INFINITY, f64::min);
        let (domain, law, mask) = (checked.domain, checked.scene.law, checked.mask.clone());
        let stopped = |why| failure(why, &discs, &checked.particles, &places, Clock::default());
        let engine = Engine::new(domain, law, discs.clone(), &mask, 0.0).map_err(stopped)?;
        Ok(Running {
            engine,
            clock: Clock::default(),
            totals: Totals::default(),
            watch: Watch::new(0.0),
            kinetic,
            smallest_radius,
            domain,
            law,
            mask,
            particles: checked.particles.clone(),
            places,
            filled: 0,
            seconds: 0.0,
        })
    }

    fn count(&mut self, happened: &Happened) {
        self.clock.events += 1;
        self.clock.time = happened.time;
        if let Some(impact) = happened.impact {
            self.totals.collisions += 1;
            self.totals.made_elastic += u64::from(impact.was_made_elastic);
            self.totals.virial += impact.virial;
        }
    }

    /// Whether nothing has happened for so long that nothing will.
    fn is_idle(&self) -> bool {
        self.engine.remaps() > self.filled + IDLE
    }

    fn failure(&self, why: Stopped) -> Failure {
        failure(why, self.engine.discs(), &self.particles, &self.places, self.clock)
    }

    fn collapsed(&self, happened: &Happened, Collapse { events, duration }: Collapse) -> Failure {
        let discs =
            [Some(happened.disc), if let Partner::Disc(other) = happened.with { Some(other) } else { None }];
        let culprits: Vec<Culprit> = discs.into_iter().flatten().map(|disc| self.culprit(disc)).collect();
        let named: Vec<String> = culprits.iter().map(ToString::to_string).collect();
        let message = format!(
            "inelastic collapse: {events} collisions within a time of {duration:.3e}, the last of {}",
            named.join(" and ")
        );
        let remedy = "set law.contact_duration to a small part of the mean free time: collisions that come sooner are then elastic; \
                      or raise law.restitution";
        let failure = Failure::new(FailureKind::InelasticCollapse, message, remedy).at(self.clock);
        let rate = events as f64 / duration.max(f64::MIN_POSITIVE);
        failure.of(culprits.len() as u64, culprits).with([
            ("events", events as f64),
            ("duration", duration),
            ("rate", rate),
        ])
    }

    fn culprit(&self, disc: u32) -> Culprit {
        culprit(disc, self.engine.discs(), &self.particles, &self.places)
    }
}

fn kinetic(discs: &[Disc]) -> f64 {
    discs.iter().map(|disc| 0.5 * disc.mass * disc.velocity.iter().map(|v| v * v).sum::<f64>()).sum()
}

fn culprit(disc: u32, discs: &[Disc], particles: &Particles, places: &[usize]) -> Culprit {
    let Disc { position, velocity, .. } = discs[disc as usize];
    Culprit { id: particles.all()[places[disc as usize]].id, position, velocity }
}

fn failure(why: Stopped, discs: &[Disc], particles: &Particles, places: &[usize], clock: Clock) -> Failure {
    let named = |disc: u32| culprit(disc, discs, particles, places);
    match why {
        Stopped::SharedCell(pair) => {
            let [a, b] = pair.map(named);
            let message =
                format!("{a} and {b} have their centres in one cell of the exclusive grid: they overlap");
            let remedy = "this must not happen between hard discs: report it with the scene";
            Failure::new(FailureKind::Conflict, message, remedy).at(clock).of(2, [a, b])
        }
        Stopped::BackInTime(disc, time, now) => {
            let who = named(disc);
            let message = format!("the next event of {who} is at {time:?}, before the last one at {now:?}");
            let remedy = "this must not happen: a mask missed a partner; report it with the scene";
            let failure = Failure::new(FailureKind::BackInTime, message, remedy).at(clock).of(1, [who]);
            failure.with([("time", time), ("now", now)])
        }
    }
}

impl Simulation for Running {
    fn advance(&mut self, until: &[Until], interrupted: &AtomicBool) -> Result<(), Failure> {
        let begun = Instant::now();
        let end = until.iter().filter_map(|moment| match moment {
            Until::Time(time) => Some(*time),
            Until::Steps(_) | Until::Events(_) => None,
        });
        let end = end.fold(f64::INFINITY, f64::min);
        let awaits_events = until.iter().any(|moment| matches!(moment, Until::Events(_)));
        while !until.iter().any(|moment| moment.has_come(&self.clock)) {
            if self.clock.events.is_multiple_of(UNHEARD) && interrupted.load(Ordering::Relaxed) {
                break;
            }
            let unheard = self.engine.remaps() + UNHEARD;
            match self.engine.next(end, unheard) {
                Err(why) => return Err(self.failure(why)),
                Ok(Some(happened)) => {
                    self.count(&happened);
                    self.filled = self.engine.remaps();
                    let (engine, radius) = (&self.engine, self.smallest_radius);
                    let crossing = || {
                        let squares: f64 = engine.discs().iter().map(|disc| disc.speed().powi(2)).sum();
                        radius / (squares / engine.discs().len() as f64).sqrt()
                    };
                    if let Some(collapse) = self.watch.see(happened.time, crossing) {
                        return Err(self.collapsed(&happened, collapse));
                    }
                }
                Ok(None) if self.engine.remaps() < unheard && end.is_finite() => self.clock.time = end,
                Ok(None) if self.engine.remaps() >= unheard && !(awaits_events && self.is_idle()) => {
                    if interrupted.load(Ordering::Relaxed) {
                        break;
                    }
                }
                Ok(None) => {
                    let message = format!(
                        "no disc meets another one or a side: nothing happened up to {:?}",
                        self.engine.time()
                    );
                    let remedy = "ask for a time instead of events, or give the discs other velocities";
                    return Err(Failure::new(FailureKind::Idle, message, remedy).at(self.clock));
                }
            }
        }
        self.seconds += begun.elapsed().as_secs_f64();
        Ok(())
    }

    fn clock(&self) -> Clock {
        self.clock
    }

    fn particles(&self) -> Particles {
        let mut particles = self.particles.clone();
        let all = particles.all_mut();
        for (disc, &place) in self.engine.discs().iter().zip(&self.places) {
            all[place].position = in_space(self.domain.wrapped(disc.at(self.clock.time)));
            all[place].velocity = in_space(disc.velocity);
        }
        particles
    }

    fn observe(&self) -> Vec<f64> {
        let discs = self.engine.discs();
        let count = discs.len() as f64;
        let sum = |of: &dyn Fn(&Disc) -> f64| discs.iter().map(of).sum::<f64>();
        let mass = sum(&|disc| disc.mass);
        let momentum = [0, 1].map(|axis| sum(&|disc| disc.mass * disc.velocity[axis]));
        let kinetic = kinetic(discs);
        let drift = momentum.iter().map(|p| p * p).sum::<f64>() / (2.0 * mass);
        let temperature = (kinetic - drift) / count;
        let Totals { collisions, virial, .. } = self.totals;
        let time = self.clock.time;
        let rate = if time > 0.0 { 2.0 * collisions as f64 / (count * time) } else { 0.0 };
        // Without collisions an ideal gas, even one at rest.
        let pressure = if collisions > 0 { 1.0 + virial / (2.0 * count * temperature * time) } else { 1.0 };
        vec![
            time,
            self.clock.events as f64,
            collisions as f64,
            kinetic,
            if self.kinetic > 0.0 { kinetic / self.kinetic - 1.0 } else { 0.0 },
            temperature,
            momentum[0],
            momentum[1],
            virial,
            pressure,
            rate,
        ]
    }

    fn snapshot(&self) -> Snapshot {
        let discs = self.engine.discs();
        let column = |name: &str, of: &dyn Fn(&Disc) -> f64| {
            (name.to_owned(), Column::F64(discs.iter().map(of).collect()))
        };
        let Totals { collisions, made_elastic, virial } = self.totals;
        let counters = [
            ("collisions", Counter::Count(collisions)),
            ("made_elastic", Counter::Count(made_elastic)),
            ("virial", Counter::Sum(virial)),
        ];
        Snapshot {
            counters: counters.map(|(name, counter)| (name.to_owned(), counter)).into_iter().collect(),
            columns: vec![
                column("x", &|disc| disc.position[0]),
                column("y", &|disc| disc.position[1]),
                column("vx", &|disc| disc.velocity[0]),
                column("vy", &|disc| disc.velocity[1]),
                column("local_time", &|disc| disc.time),
                column("met", &|disc| disc.met),
            ],
        }
    }

    fn restore(&mut self, clock: Clock, snapshot: Snapshot) -> Result<(), String> {
        let Snapshot { counters, columns } = snapshot;
        let mut discs = self.engine.discs().to_vec();
        for (name, of) in FIELDS {
            let column = columns.iter().find(|(there, _)| there == name);
            let Some((_, Column::F64(values))) = column.filter(|(_, values)| values.len() == discs.len())
            else {
                return Err(format!("the column {name} is missing"));
            };
            discs.iter_mut().zip(values).for_each(|(disc, &value)| *of(disc) = value);
        }
        let count = |name: &str| match counters.get(name) {
            Some(Counter::Count(count)) => Ok(*count),
            _ => Err(format!("the counter {name} is missing")),
        };
        let Some(Counter::Sum(virial)) = counters.get("virial") else {
            return Err("the counter virial is missing".to_owned());
        };
        self.totals = Totals {
            collisions: count("collisions")?,
            made_elastic: count("made_elastic")?,
            virial: *virial,
        };
        let engine = Engine::new(self.domain, self.law, discs, &self.mask, clock.time);
        self.engine = engine.map_err(|why| self.failure(why).what())?;
        self.clock = clock;
        self.filled = 0;
        self.watch = Watch::new(clock.time);
        Ok(())
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
        let Totals { collisions, made_elastic, virial } = self.totals;
        let entries = [
            ("discs", json!(self.places.len())),
            ("collisions", json!(collisions)),
            ("made_elastic", json!(made_elastic)),
            ("virial", json!(virial)),
            ("remaps", json!(self.engine.remaps())),
            ("occupancy", json!(self.engine.occupancy())),
        ];
        entries.map(|(name, value)| (name.to_owned(), value)).into_iter().collect()
    }

    fn warnings(&self) -> Vec<RunWarning> {
        let Totals { collisions, made_elastic, .. } = self.totals;
        let message = format!(
            "{made_elastic} of {collisions} collisions were made elastic, because another one of either disc was less than \
             law.contact_duration = {} ago",
            self.law.contact_duration
        );
        let warning = RunWarning { check: "made-elastic", value: made_elastic as f64, limit: 0.0, message };
        if made_elastic > 0 { vec![warning] } else { vec![] }
    }

    fn in_words(&self) -> String {
        let values = self.observe();
        format!(
            "{} discs, {} collisions of pairs; temperature {:.4e}, compressibility {:.4}, {:.4} collisions of a disc in a unit of time",
            self.places.len(),
            self.totals.collisions,
            values[5],
            values[9],
            values[10]
        )
    }
}

type Field = fn(&mut Disc) -> &mut f64;

/// What a checkpoint holds of a disc.
const FIELDS: [(&str, Field); 6] = [
    ("x", |disc| &mut disc.position[0]),
    ("y", |disc| &mut disc.position[1]),
    ("vx", |disc| &mut disc.velocity[0]),
    ("vy", |disc| &mut disc.velocity[1]),
    ("local_time", |disc| &mut disc.time),
    ("met", |disc| &mut disc.met),
];
