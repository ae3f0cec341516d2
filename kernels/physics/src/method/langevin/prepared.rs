//! What a checked scene of particles in a bath offers.

use super::checked::Checked;
use super::dynamics::InBath;
use super::found::Found;
use super::losses;
use super::options::{By, PairLaw};
use super::programs::programs;
use super::simulation::Running;
use crate::memory::{Foreseen, OfRanks, PROGRAM, available};
use crate::method::entry::left_out;
use crate::method::pairwise::{Dynamics, ToReach};
use crate::method::{Fact, Failure, Prepared, Purpose, Schedule, Simulation, Startable, VectorProgram};
use crate::number::significant;
use crate::particles::{Particle, Particles};
use crate::structure::PairForces;
use crate::words::Words;
use serde_json::{Map, Value, json};
use std::f64::consts::PI;
use std::path::Path;
use std::sync::Arc;
use stripmine_kernels::isa::aligned_column::taken as row;
use stripmine_kernels::sweep::fast::lattice::SPARSE;

impl Checked {
    /// What is offered.
    pub(super) fn prepared(self) -> Prepared {
        let scene = &self.scene;
        Prepared {
            scene: scene.to_toml(),
            schedule: Schedule::of_steps(&scene.run),
            target: scene.run.target.clone(),
            output: scene.output.clone(),
            domain: self.domain,
            seed: scene.start.seed(),
            start_file: scene.start.file().map(Path::to_owned),
            facts: self.facts(),
            warnings: self.warnings.clone(),
            choices: self.choices.clone(),
            left_out: left_out(&[
                (scene.law == PairLaw::None, "pairs, and the search for them: law.kind is none"),
                (scene.law == PairLaw::Wca, "attraction: law.kind is wca"),
                (scene.bath.friction == 0.0, "friction and noise: law.drag is 0"),
            ]),
            step_limits: self.limits(),
            expected_error: None,
            memory: self.memory(),
            settings: self.settings(),
            event_columns: self.lists_losses().then_some(losses::COLUMNS),
            model: Box::new(self),
        }
    }

    /// Whether `events.csv` has a row for each loss.
    pub(super) fn lists_losses(&self) -> bool {
        self.scene.losses && self.scene.most_lost > 0
    }

    fn facts(&self) -> Vec<Fact> {
        let Checked { scene, domain, particles, diameter, reach, .. } = self;
        let ([x, y], count) = (domain.lengths(), particles.len());
        let density = count as f64 * diameter * diameter / domain.area();
        let by = match &self.found {
            Found::Lattice(shape, _) => format!("lattice of {} × {} cells", shape.columns(), shape.rows()),
            Found::Sectors(grid) => format!("{} × {} sectors", grid.counts[0], grid.counts[1]),
            Found::Lists(_, skin) => {
                format!("neighbour lists to {} beyond the cut-off", significant(*skin, 5))
            }
        };
        let mut facts = vec![
            Fact::new("units", scene.units.as_str(), "units", scene.units.as_str()),
            Fact::new("grains", count, "particles", count.to_string()),
            Fact::new(
                "sides",
                json!([x, y]),
                "box",
                format!("{} × {}", significant(x, 7), significant(y, 7)),
            ),
            Fact::data("periodic", json!(domain.periodic())),
            Fact::new("density", density, "density N σ²/A", significant(density, 5)),
            Fact::new("law", scene.law.word(), "pairs", scene.law.word()),
        ];
        if scene.law != PairLaw::None {
            facts.push(Fact::new("cutoff", *reach, "cut-off", significant(*reach, 7)));
        }
        facts.push(Fact::new("search", scene.by.word(), "search", by));
        let mut noise = self.seed.to_string();
        if self.noise_seed != self.seed {
            noise += ", with the state at the start";
        }
        facts.push(Fact::new("noise_seed", self.seed, "seed of the noise", noise));
        facts.push(Fact::words("steps", format!("{} of dt = {:?}", scene.run.steps, scene.dt)));
        facts
    }

    fn memory(&self) -> Foreseen {
        let count = self.particles.len() as f64;
        // Rows of the state and the sums, one more of each to put them in order, and of the places at which lists were made.
        let rows = if matches!(self.found, Found::Lists(..)) { 11.0 } else { 9.0 };
        // Ids and numbers; lists.
        let (engine, cells) = match &self.found {
            Found::Sectors(grid) => (99.0 * count, 8.0 * grid.counts.iter().product::<usize>() as f64),
            Found::Lists(grid, _) => (128.0 * count, 8.0 * grid.counts.iter().product::<usize>() as f64),
            Found::Lattice(shape, _) => {
                // A number and a bit a cell; copies of the places where the lattice is not sparse.
                let copies = if count < SPARSE * shape.cells() as f64 { 0.0 } else { 2.0 };
                let cells = shape.padded() as f64;
                (139.0 * count, (1.0 + copies) * row(4.0 * cells) + 0.125 * cells)
            }
        };
        // The scene's particles in three places, once more while they are observed, and the frame that is being written; what puts them in order.
        let particles = (6.0 * size_of::<Particle>() as f64 + 2.0 * 16.0 + 4.0) * count;
        Foreseen {
            needed: (PROGRAM + rows * row(8.0 * count) + engine + cells + particles) as u64,
            available: available(),
            what: format!("{count} particles"),
            remedy: "take fewer particles",
            ranks: OfRanks::in_bands(count, cells, [rows, 8.0 * count]),
        }
    }

    fn settings(&self) -> Map<String, Value> {
        let Checked { scene, particles, domain, diameter, .. } = self;
        let density = particles.len() as f64 * diameter * diameter / domain.area();
        let settings = [
            ("density", json!(density)),
            ("precision", json!(scene.precision.word())),
            ("integrator", json!(scene.scheme.word())),
            ("law", json!(scene.law.word())),
            ("search", json!(scene.by.word())),
            ("skin", json!(scene.skin)),
            ("instruction_set", json!(scene.instructions().name())),
        ];
        settings.map(|(name, value)| (name.to_owned(), value)).into_iter().collect()
    }
}

impl Startable for Checked {
    fn particles(&self) -> &Particles {
        &self.particles
    }

    fn programs(&self) -> Vec<VectorProgram> {
        programs(self)
    }

    fn programs_note(&self) -> Option<String> {
        let by = self.scene.by;
        (self.has_pairs() && by != By::Lattice).then(|| {
            format!(
                "the programs are those of search.by = \"lattice\"; a run of the scene finds pairs by {}",
                by.word()
            )
        })
    }

    fn work(&self) -> f64 {
        // Noise and motion, and the pairs within reach.
        let density = self.particles.len() as f64 / self.domain.area();
        let pairs = if self.has_pairs() { 0.5 * PI * self.reach * self.reach * density } else { 0.0 };
        30.0 + 8.0 * pairs
    }

    fn pair_forces(&self) -> Option<PairForces> {
        let particles = InBath::of(self);
        Some(if self.has_pairs() {
            particles.with_law(ToReach(self.reach))
        } else {
            PairForces { reach: 0.0, of: Arc::new(|_| [0.0; 2]) }
        })
    }

    fn follows_crossings(&self) -> bool {
        true
    }

    fn start(&self, purpose: Purpose) -> Result<Box<dyn Simulation>, Failure> {
        Ok(Box::new(Running::new(self, purpose)?))
    }

    fn started_from(&self, particles: Particles) -> Prepared {
        Checked { particles, ..self.clone() }.prepared()
    }
}
