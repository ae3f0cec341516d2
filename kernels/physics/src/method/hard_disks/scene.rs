//! Scene of hard discs as plain data.

use super::event::{Arena, CollisionLaw, ThermalWall};
use super::floor::Floor;
use super::keys::*;
use super::options::EngineChoice;
use crate::domain::BoxSide;
use crate::method::{Every, Schedule, Until};
use crate::scene::{
    Binding, DiscStart, MeanTarget, Output, SceneDomain, TARGET, WallMotion, Write, bind_heading,
    bind_instructions,
};
use stripmine_kernels::InstructionSet;

/// Scene of the method, in its own units; `units` names them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct HardDiskScene {
    /// Label of the unit system.
    pub units: String,
    /// The box.
    pub domain: SceneDomain,
    /// Discs at the start.
    pub start: DiscStart,
    /// Collision law.
    pub law: CollisionLaw,
    /// Seed of the thermal side, if it differs from that of the start.
    pub(crate) noise_seed: Option<u64>,
    /// True without a ceiling.
    pub(crate) open_top: bool,
    /// Engine that finds the events.
    pub engine: EngineChoice,
    /// Instruction set; the widest available if none.
    pub instruction_set: Option<InstructionSet>,
    /// Name of the mask.
    pub mask: String,
    /// Mean number of discs in a linked cell.
    pub(super) discs_in_cell: f64,
    /// Duration and output intervals.
    pub run: HardDiskRun,
    /// Output files.
    pub output: Output,
    /// True if every collision is written.
    pub(crate) collision_log: bool,
}

/// Duration and output intervals of a run (time; 0 is never).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct HardDiskRun {
    /// End of the run.
    pub until: Until,
    /// Target error of a mean, which ends the run early.
    pub target: Option<MeanTarget>,
    /// Time between rows of observables.
    pub(crate) thermo_every: f64,
    /// Time between snapshots.
    pub(crate) snapshot_every: f64,
    /// Time between checkpoints; by the wall clock if none.
    pub(crate) checkpoint_every: Option<f64>,
}

impl Default for HardDiskScene {
    fn default() -> Self {
        HardDiskScene {
            units: String::new(),
            domain: SceneDomain::default(),
            start: DiscStart::default(),
            law: CollisionLaw::ELASTIC,
            noise_seed: None,
            open_top: false,
            engine: EngineChoice::default(),
            instruction_set: None,
            mask: String::new(),
            discs_in_cell: 1.0,
            run: HardDiskRun {
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

impl HardDiskRun {
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

    /// Schedule common to all methods.
    pub(super) fn schedule(&self) -> Schedule {
        Schedule {
            until: self.until,
            rows: Every::time(self.thermo_every),
            snapshots: Every::time(self.snapshot_every),
            checkpoints: Every::checkpoints(self.checkpoint_every.map(Every::time)),
        }
    }
}

impl HardDiskScene {
    /// Binds every key of the method.
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
        if self.engine == EngineChoice::CellCrossing {
            binding.number(&DISCS_IN_CELL, &mut self.discs_in_cell);
        }
        self.run.bind(binding);
        self.output.bind(binding);
        binding.switch(&COLLISION_LOG, &mut self.collision_log);
    }

    /// Arena of the discs in a box.
    pub(super) fn arena(&self, domain: crate::domain::Domain) -> Arena {
        let mut arena = Arena::new(domain, self.domain.gravity, self.law);
        if self.open_top {
            arena.domain.sides[1] = BoxSide::Open;
        }
        arena
    }

    /// Instruction set of a run.
    pub(super) fn instructions(&self) -> InstructionSet {
        self.instruction_set.unwrap_or_else(InstructionSet::best)
    }

    fn bind_thermal(&mut self, binding: &mut dyn Binding) {
        let known = self.law.thermal;
        let name = THERMAL_SIDES.iter().find(|name| known.is_some() && side(name) == known.map(|it| it.side));
        let mut name = (*name.unwrap_or(&THERMAL_SIDES[0])).to_owned();
        let mut temperature = known.map_or(1.0, |thermal| thermal.temperature);
        binding.word(&THERMAL_SIDE, &mut name);
        // These keys have no effect without a thermal side.
        if side(&name).is_some() {
            binding.number(&WALL_TEMPERATURE, &mut temperature);
            binding.whole_if_any(&NOISE_SEED, &mut self.noise_seed);
        }
        let seed = self.noise_seed.or(self.start.seed()).unwrap_or(1);
        self.law.thermal = side(&name).map(|side| ThermalWall { side, temperature, seed });
    }

    fn bind_floor(&mut self, binding: &mut dyn Binding) {
        let mut amplitude = self.law.floor.map_or(0.0, |floor| floor.amplitude);
        let mut frequency = self.law.floor.map_or(1.0, |floor| floor.frequency);
        binding.number(&FLOOR_AMPLITUDE, &mut amplitude);
        binding.number(&FLOOR_FREQUENCY, &mut frequency);
        self.law.floor = (amplitude > 0.0).then_some(Floor { amplitude, frequency });
    }

    /// Writes the whole scene as TOML, including defaults. Parsing it gives an equal scene.
    pub(super) fn to_toml(&self) -> String {
        let mut write = Write::default();
        self.clone().bind(&mut write);
        write.to_toml(&VOCABULARY.keys)
    }
}
