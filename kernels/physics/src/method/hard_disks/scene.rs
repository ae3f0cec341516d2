//! What a scene of this method says, as plain data.

use super::event::{Arena, Law, Thermal};
use super::floor::Floor;
use super::keys::*;
use super::options::EngineChoice;
use crate::domain::Side;
use crate::method::{Every, Schedule, Until};
use crate::scene::{
    Binding, Domain, Output, Start, TARGET, Target, WallMotion, Write, bind_heading, bind_instructions,
};
use stripmine_kernels::InstructionSet;

/// What is simulated. Units are the scene's own; `units` names them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Scene {
    /// The unit system: a label.
    pub units: String,
    /// The box.
    pub domain: Domain,
    /// The discs at the start.
    pub start: Start,
    /// What collisions do.
    pub law: Law,
    /// Seed of the thermal side, where it is not that of the start.
    pub(crate) noise_seed: Option<u64>,
    /// Whether there is no ceiling.
    pub(crate) open_top: bool,
    /// How events are found.
    pub engine: EngineChoice,
    /// The instructions; the widest set that there is if none.
    pub instruction_set: Option<InstructionSet>,
    /// The mask by its name.
    pub mask: String,
    /// How long, and how often something is written.
    pub run: Run,
    /// Which files are written.
    pub output: Output,
    /// Whether every collision is written.
    pub(crate) collision_log: bool,
}

/// How long a run takes, and how often something is written (time; 0 is never).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Run {
    /// The end.
    pub until: Until,
    /// The mean that ends the run before.
    pub target: Option<Target>,
    /// Time between rows of observables.
    pub(crate) thermo_every: f64,
    /// Time between snapshots.
    pub(crate) snapshot_every: f64,
    /// Time between checkpoints; by the wall clock if none.
    pub(crate) checkpoint_every: Option<f64>,
}

impl Default for Scene {
    fn default() -> Self {
        Scene {
            units: String::new(),
            domain: Domain::default(),
            start: Start::default(),
            law: Law::ELASTIC,
            noise_seed: None,
            open_top: false,
            engine: EngineChoice::default(),
            instruction_set: None,
            mask: String::new(),
            run: Run {
                until: Until::Events(0),
                target: None,
                thermo_every: 0.0,
                snapshot_every: 0.0,
                checkpoint_every: None,
            },
            output: Output::default(),
            collision_log: false,
        }
    }
}

impl Run {
    fn bind(&mut self, binding: &mut dyn Binding) {
        let mut time = match self.until {
            Until::Time(time) => Some(time),
            Until::Events(_) | Until::Steps(_) => None,
        };
        binding.number_if_any(&TIME, &mut time);
        match time {
            Some(time) => self.until = Until::Time(time),
            None => {
                let mut events = if let Until::Events(events) = self.until { events } else { 0 };
                binding.whole(&EVENTS, &mut events);
                self.until = Until::Events(events);
            }
        }
        binding.target_if_any(&TARGET, &mut self.target);
        binding.number(&THERMO_EVERY, &mut self.thermo_every);
        binding.number(&SNAPSHOT_EVERY, &mut self.snapshot_every);
        binding.number_if_any(&CHECKPOINT_EVERY, &mut self.checkpoint_every);
    }

    /// As every method states it.
    pub(super) fn schedule(&self) -> Schedule {
        Schedule {
            until: self.until,
            rows: Every::time(self.thermo_every),
            snapshots: Every::time(self.snapshot_every),
            checkpoints: Every::checkpoints(self.checkpoint_every.map(Every::time)),
        }
    }
}

impl Scene {
    /// Meets every key of the method.
    pub(super) fn bind(&mut self, binding: &mut dyn Binding) {
        bind_heading(binding, &mut self.units, VOCABULARY.keys.method);
        self.domain.bind(binding);
        self.start.bind(binding);
        WallMotion::Fixed.bind(binding, &self.start);
        binding.number(&RESTITUTION, &mut self.law.restitution);
        binding.number(&WALL_RESTITUTION, &mut self.law.wall_restitution);
        binding.number(&CONTACT_DURATION, &mut self.law.contact_duration);
        self.bind_thermal(binding);
        self.bind_floor(binding);
        binding.switch(&OPEN_TOP, &mut self.open_top);
        binding.choice(&ENGINE, &mut self.engine);
        bind_instructions(binding, &mut self.instruction_set);
        binding.word(&MASK, &mut self.mask);
        self.run.bind(binding);
        self.output.bind(binding);
        binding.switch(&COLLISION_LOG, &mut self.collision_log);
    }

    /// What its discs fly in, in a box.
    pub(super) fn arena(&self, domain: crate::domain::Domain) -> Arena {
        let mut arena = Arena::new(domain, self.domain.gravity, self.law);
        if self.open_top {
            arena.domain.sides[1] = Side::Open;
        }
        arena
    }

    /// The instructions of a run.
    pub(super) fn instructions(&self) -> InstructionSet {
        self.instruction_set.unwrap_or_else(InstructionSet::best)
    }

    fn bind_thermal(&mut self, binding: &mut dyn Binding) {
        let known = self.law.thermal;
        let name = THERMAL_SIDES.iter().find(|name| known.is_some() && side(name) == known.map(|it| it.side));
        let mut name = (*name.unwrap_or(&THERMAL_SIDES[0])).to_owned();
        let mut temperature = known.map_or(1.0, |thermal| thermal.temperature);
        binding.word(&THERMAL_SIDE, &mut name);
        // Without a side that is hot it means nothing.
        if side(&name).is_some() {
            binding.number(&WALL_TEMPERATURE, &mut temperature);
            binding.whole_if_any(&NOISE_SEED, &mut self.noise_seed);
        }
        let seed = self.noise_seed.or(self.start.seed()).unwrap_or(1);
        self.law.thermal = side(&name).map(|side| Thermal { side, temperature, seed });
    }

    fn bind_floor(&mut self, binding: &mut dyn Binding) {
        let mut amplitude = self.law.floor.map_or(0.0, |floor| floor.amplitude);
        let mut frequency = self.law.floor.map_or(1.0, |floor| floor.frequency);
        binding.number(&FLOOR_AMPLITUDE, &mut amplitude);
        binding.number(&FLOOR_FREQUENCY, &mut frequency);
        self.law.floor = (amplitude > 0.0).then_some(Floor { amplitude, frequency });
    }

    /// The whole scene as TOML, defaults written out. Parsing it gives an equal scene.
    pub(super) fn to_toml(&self) -> String {
        let mut write = Write::default();
        self.clone().bind(&mut write);
        write.to_toml(&VOCABULARY.keys)
    }
}
