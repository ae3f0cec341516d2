//! What a scene of this method says, as plain data.

use super::event::Law;
use super::keys::*;
use crate::method::{Every, Schedule, Until};
use crate::scene::{Binding, Domain, Output, Start, WallMotion, Write, bind_heading};

/// What is simulated. Units are the scene's own; `units` names them.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// The unit system: a label.
    pub units: String,
    /// The box.
    pub domain: Domain,
    /// The discs at the start.
    pub start: Start,
    /// What collisions do.
    pub law: Law,
    /// The mask by its name.
    pub mask: String,
    /// How long, and how often something is written.
    pub run: Run,
    /// Which files are written.
    pub output: Output,
}

/// How long a run takes, and how often something is written (time; 0 is never).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// The end.
    pub until: Until,
    /// Time between rows of observables.
    pub thermo_every: f64,
    /// Time between snapshots.
    pub snapshot_every: f64,
    /// Time between checkpoints.
    pub checkpoint_every: f64,
}

impl Default for Scene {
    fn default() -> Self {
        Scene {
            units: String::new(),
            domain: Domain::default(),
            start: Start::default(),
            law: Law { restitution: 1.0, wall_restitution: 1.0, contact_duration: 0.0 },
            mask: String::new(),
            run: Run {
                until: Until::Events(0),
                thermo_every: 0.0,
                snapshot_every: 0.0,
                checkpoint_every: 0.0,
            },
            output: Output::default(),
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
        binding.number(&THERMO_EVERY, &mut self.thermo_every);
        binding.number(&SNAPSHOT_EVERY, &mut self.snapshot_every);
        binding.number(&CHECKPOINT_EVERY, &mut self.checkpoint_every);
    }

    /// As every method states it.
    pub fn schedule(&self) -> Schedule {
        let every = |time: f64| if time > 0.0 { Every::Time(time) } else { Every::Never };
        Schedule {
            until: self.until,
            rows: every(self.thermo_every),
            snapshots: every(self.snapshot_every),
            checkpoints: every(self.checkpoint_every),
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
        binding.word(&MASK, &mut self.mask);
        self.run.bind(binding);
        self.output.bind(binding);
    }

    /// The whole scene as TOML, defaults written out. Parsing it gives an equal scene.
    pub fn to_toml(&self) -> String {
        let mut write = Write::default();
        self.clone().bind(&mut write);
        write.to_toml(&VOCABULARY.keys)
    }
}
