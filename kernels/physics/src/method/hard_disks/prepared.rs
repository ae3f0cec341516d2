//! Prepared scene of hard discs: facts, memory forecast, settings and the start of a simulation.

use super::checked::{CheckedHardDisks, StartingDiscs};
use super::collision_log::COLUMNS;
use super::configuration::EngineConfiguration;
use super::forecast::{enskog_collision_rate, nanoseconds_per_collision, thermal_speed};
use super::reference::grid::ExclusiveGridSize;
use super::reference::linked_cells::CellCounts;
use super::simulation::{HardDiskSimulation, RecordOptions};
use crate::memory::{MemoryForecast, PROGRAM, RankMemory, available};
use crate::method::entry::left_out;
use crate::method::reject_several_ranks;
use crate::method::{Fact, PhysicsFailure, Prepared, Simulation, StartPurpose, Startable};
use crate::number::significant;
use crate::particles::{ParticleKind, Particles};
use crate::units::with_symbol;
use crate::words::Words;
use serde_json::{Map, Value, json};
use std::path::Path;
use std::sync::Arc;
use stripmine_kernels::flight::FlyingDisc;
use stripmine_kernels::isa::aligned_column::column_memory;

impl CheckedHardDisks {
    /// Turns the checked scene into the interface common to all methods.
    pub(super) fn prepared(self) -> Prepared {
        let scene = &self.scene;
        Prepared {
            units: scene.units.clone(),
            scene: scene.to_toml(),
            schedule: scene.run.schedule(),
            target: scene.run.target.clone(),
            output: scene.output.clone(),
            domain: self.domain,
            seed: scene.start.seed(),
            start_file: scene.start.file().map(Path::to_owned),
            law_file: None,
            facts: self.facts(),
            warnings: self.warnings.clone(),
            choices: self.choices.clone(),
            left_out: left_out(&[
                (true, "time steps and the deformation of discs: they are hard"),
                (scene.law.restitution == 1.0, "dissipation of collisions: law.restitution is 1"),
                (scene.law.contact_duration == 0.0, "the duration of contacts: law.contact_duration is 0"),
                (self.domain.periodic() == [true; 2], "walls: both sides are periodic"),
            ]),
            step_limits: vec![],
            expected_error: None,
            memory: self.memory(),
            settings: self.settings(),
            event_columns: scene.collision_log.then_some(COLUMNS),
            model: Box::new(self),
        }
    }

    fn start_with(
        &self,
        discs: StartingDiscs,
        purpose: StartPurpose,
    ) -> Result<Box<dyn Simulation>, PhysicsFailure> {
        reject_several_ranks("the events of hard discs are executed in sequence, wherever they occur")?;
        let is_run = purpose == StartPurpose::Run;
        let observed = RecordOptions {
            logs: is_run && self.scene.collision_log,
            follows: is_run && self.scene.output.follows_motion(),
        };
        let arena = self.scene.arena(self.domain);
        Ok(Box::new(HardDiskSimulation::new(arena, self.engine.clone(), discs, observed)?))
    }

    fn facts(&self) -> Vec<Fact> {
        let [x, y] = self.domain.lengths();
        let [low, high] = self.particles.radii().unwrap_or([0.0; 2]);
        let discs = self.particles.len();
        let in_units = |lengths: String| with_symbol(&lengths, &self.scene.units, "length");
        let mut facts = vec![
            Fact::new("units", self.scene.units.as_str(), "units", self.scene.units.as_str()),
            Fact::new("grains", discs, "discs", discs.to_string()),
            Fact::new(
                "radii",
                json!([low, high]),
                "radii",
                in_units(format!("{} to {}", significant(low, 7), significant(high, 7))),
            ),
            Fact::new(
                "sides",
                json!([x, y]),
                "box",
                in_units(format!("{} × {}", significant(x, 7), significant(y, 7))),
            ),
            Fact::data("periodic", json!(self.domain.periodic())),
            Fact::new("packing_fraction", self.packing_fraction(), "packing fraction", {
                significant(self.packing_fraction(), 4)
            }),
            Fact::new("engine", self.scene.engine.word(), "engine", self.scene.engine.word()),
            Fact::words("end", self.scene.run.until.to_string()),
        ];
        if self.scene.law.thermal.is_some() {
            let seed = self.scene.noise_seed.or(self.scene.start.seed()).unwrap_or(1);
            let state = if self.scene.start.seed().is_none() { ", with the state at the start" } else { "" };
            facts.push(Fact::new("noise_seed", seed, "seed of the thermal side", format!("{seed}{state}")));
        }
        let counts = match &self.engine {
            EngineConfiguration::Fast(_) => None,
            EngineConfiguration::Reference(_) => Some(ExclusiveGridSize::new(&self.domain, low).cells),
            EngineConfiguration::CellCrossing(CellCounts(counts)) => Some(*counts),
        };
        if let Some([columns, rows]) = counts {
            let cells = format!("{columns} × {rows} = {}", columns * rows);
            facts.push(Fact::new("cells", columns * rows, "cells", cells));
        }
        if let EngineConfiguration::Reference(mask) = &self.engine {
            let places = format!("{}, {} offsets", self.scene.mask, mask.offsets().len());
            facts.push(Fact::new("mask", self.scene.mask.as_str(), "mask", places));
        }
        facts
    }

    fn memory(&self) -> MemoryForecast {
        let discs = self.particles.len() as f64;
        let of_engine = match &self.engine {
            // Disc, event, node, chain, cell and crossing.
            EngineConfiguration::CellCrossing(CellCounts([columns, rows])) => {
                4.0 * (columns * rows) as f64 + (64.0 + 16.0 + 8.0 + 4.0 + 8.0 + 16.0) * discs
            }
            EngineConfiguration::Reference(mask) => {
                let sizes =
                    ExclusiveGridSize::new(&self.domain, self.particles.radii().map_or(1.0, |[low, _]| low));
                let margin = 2 * mask.half_width() as usize;
                let cells: f64 = sizes.cells.iter().map(|&cells| (cells + margin) as f64).product();
                // Disc, event, node and cell.
                4.0 * cells + (64.0 + 16.0 + 8.0 + 4.0) * discs
            }
            EngineConfiguration::Fast(_) => {
                // Disc, list, position, time, partner and number; both coordinates and the disc of 2.1 slots of cells.
                let columns = [64.0, 64.0, 16.0, 8.5, 8.0, 4.0, 8.4, 8.4, 8.4];
                let places = size_of::<u32>() as f64 * discs;
                places + columns.into_iter().map(|bytes| column_memory(bytes * discs)).sum::<f64>()
            }
        };
        // Each disc in the state after its last event, and two counts.
        let followed = match self.scene.output.follows_motion() {
            true => (size_of::<FlyingDisc>() + 2 * size_of::<f64>()) as f64,
            false => 0.0,
        };
        // A resumed run takes most: a copy of the disc, the checkpoint as bytes and as columns, and the search for overlaps (measured). The
        // particles at the start are released before.
        let resumption = 236.0;
        let disc = resumption + followed;
        MemoryForecast {
            needed: (PROGRAM + disc * discs + of_engine) as u64,
            available: available(),
            what: format!("{} hard discs", self.particles.len()),
            remedy: "use fewer discs",
            ranks: RankMemory::default(),
        }
    }

    fn settings(&self) -> Map<String, Value> {
        let is_reference = matches!(self.engine, EngineConfiguration::Reference(_));
        let settings = [
            ("packing_fraction", json!(self.packing_fraction())),
            ("precision", json!("f64")),
            ("engine", json!(self.scene.engine.word())),
            ("mask", json!(is_reference.then_some(&self.scene.mask))),
            ("instruction_set", json!(self.scene.instructions().name())),
            ("restitution", json!(self.scene.law.restitution)),
        ];
        settings.map(|(name, value)| (name.to_owned(), value)).into_iter().collect()
    }
}

impl Startable for CheckedHardDisks {
    fn particles(&self) -> &Particles {
        &self.particles
    }

    fn work(&self) -> f64 {
        nanoseconds_per_collision(self) * enskog_collision_rate(self, thermal_speed(self))
    }

    fn has_open_top(&self) -> bool {
        self.scene.open_top
    }

    fn follows_crossings(&self) -> bool {
        true
    }

    fn start(&self, purpose: StartPurpose) -> Result<Box<dyn Simulation>, PhysicsFailure> {
        self.start_with(self.discs(), purpose)
    }

    fn start_last(&mut self, purpose: StartPurpose) -> Result<Box<dyn Simulation>, PhysicsFailure> {
        // Before the engine takes its memory.
        let discs = self.released_discs();
        self.start_with(discs, purpose)
    }

    fn started_from(&self, particles: Particles) -> Prepared {
        debug_assert!(particles.all().iter().all(|disc| disc.kind == ParticleKind::Grain));
        CheckedHardDisks { particles: Arc::new(particles), ..self.clone() }.prepared()
    }

    fn period(&self) -> Option<f64> {
        self.scene.law.floor.map(|floor| 1.0 / floor.frequency)
    }
}
