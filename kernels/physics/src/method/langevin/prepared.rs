//! Prepared scene of Langevin dynamics: facts, memory forecast, settings and the start of a simulation.

use super::checked::CheckedLangevin;
use super::chosen_search::ChosenSearch;
use super::dynamics::BathDynamics;
use super::laws::PairLaw;
use super::losses;
use super::options::PairSearchKind;
use super::programs::{programs, with_bound_programs};
use super::scene::LangevinScene;
use super::simulation;
use crate::memory::{MemoryForecast, PROGRAM, RankMemory, available};
use crate::method::entry::left_out;
use crate::method::pairwise::{Dynamics, PairForcesTask, StateSize};
use crate::method::{
    BoundPrograms, Fact, PhysicsFailure, Prepared, Schedule, Simulation, StartPurpose, Startable,
    VectorProgram,
};
use crate::number::significant;
use crate::particles::{Particle, Particles};
use crate::structure::PairForces;
use crate::units::with_symbol;
use crate::words::Words;
use serde_json::{Map, Value, json};
use std::f64::consts::PI;
use std::path::Path;
use std::sync::Arc;
use stripmine_kernels::isa::aligned_column::column_memory as row;
use stripmine_kernels::noise::NoiseSource;
use stripmine_kernels::sweep::fast::lattice::SPARSE;

impl CheckedLangevin {
    /// Turns the checked scene into the interface common to all methods.
    pub(super) fn prepared(self) -> Prepared {
        let (scene, word) = (&self.scene, self.scene.law.word());
        let only_repels = self.has_pairs() && !scene.law_at(self.diameter).is_attractive();
        Prepared {
            units: scene.units.clone(),
            scene: scene.to_toml(),
            schedule: Schedule::of_steps(&scene.run),
            target: scene.run.target.clone(),
            output: scene.output.clone(),
            domain: self.domain,
            seed: scene.start.seed(),
            start_file: scene.start.file().map(Path::to_owned),
            law_file: (scene.law == PairLaw::Table).then(|| scene.parameters.table.origin()),
            facts: self.facts(),
            warnings: self.warnings.clone(),
            choices: self.choices.clone(),
            left_out: left_out(&[
                (!self.has_pairs(), format!("pairs, and the search for them: law.kind is {word}").as_str()),
                (only_repels, format!("attraction: law.kind is {word}").as_str()),
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

    /// True if `events.csv` has a row for each loss.
    pub(super) fn lists_losses(&self) -> bool {
        self.scene.losses && self.scene.most_lost > 0
    }

    fn facts(&self) -> Vec<Fact> {
        let CheckedLangevin { scene, domain, particles, diameter, reach, .. } = self;
        let ([x, y], count) = (domain.lengths(), particles.len());
        let density = count as f64 * diameter * diameter / domain.area();
        let in_units = |number: String, dimension| with_symbol(&number, &scene.units, dimension);
        let by = match &self.found {
            ChosenSearch::Lattice(shape, _) => {
                format!("lattice of {} × {} cells", shape.columns(), shape.rows())
            }
            ChosenSearch::Sectors(grid) => format!("{} × {} sectors", grid.counts[0], grid.counts[1]),
            ChosenSearch::Lists(_, skin) => {
                format!("neighbour lists with a skin of {}", in_units(significant(*skin, 5), "length"))
            }
        };
        let mut facts = vec![
            Fact::new("units", scene.units.as_str(), "units", scene.units.as_str()),
            Fact::new("grains", count, "particles", count.to_string()),
            Fact::new(
                "sides",
                json!([x, y]),
                "box",
                in_units(format!("{} × {}", significant(x, 7), significant(y, 7)), "length"),
            ),
            Fact::data("periodic", json!(domain.periodic())),
            Fact::new("density", density, "density N σ²/A", significant(density, 5)),
            Fact::new("law", scene.law.word(), "pairs", scene.law.word()),
        ];
        if self.has_pairs() {
            facts.push(Fact::new("cutoff", *reach, "cut-off", in_units(significant(*reach, 7), "length")));
        }
        facts.push(Fact::new("search", scene.by.word(), "search", by));
        let mut noise = self.seed.to_string();
        if self.noise.seed != self.seed {
            noise += ", with the state at the start";
        }
        facts.push(Fact::new("noise_seed", self.seed, "seed of the noise", noise));
        facts.push(Fact::words("steps", {
            format!("{} of dt = {}", scene.run.steps, in_units(format!("{:?}", scene.dt), "time"))
        }));
        facts
    }

    fn memory(&self) -> MemoryForecast {
        let count = self.particles.len() as f64;
        let size = StateSize { discs: count, freedoms: 2.0, vary: false, carried: 2.0, number: [8.0, 8.0] };
        let [mut rows, bytes] = size.rows();
        let mut state = size.bytes();
        if let ChosenSearch::Lists(..) = self.found {
            // The positions of the last list build.
            state += 2.0 * row(8.0 * count);
            rows += 1.0;
        }
        // Ids and numbers; neighbour lists.
        let (engine, cells) = match &self.found {
            ChosenSearch::Sectors(grid) => (99.0 * count, 8.0 * grid.counts.iter().product::<usize>() as f64),
            ChosenSearch::Lists(grid, _) => {
                (128.0 * count, 8.0 * grid.counts.iter().product::<usize>() as f64)
            }
            ChosenSearch::Lattice(shape, _) => {
                // A number and a bit per cell; copies of the positions if the lattice is not sparse.
                let copies = if count < SPARSE * shape.cells() as f64 { 0.0 } else { 1.0 };
                let cells = shape.padded() as f64;
                (139.0 * count, (1.0 + copies) * row(4.0 * cells) + 0.125 * cells)
            }
        };
        // Three copies of the scene's particles, another while they are observed, the frame being written, and the sorting order.
        let particles = (6.0 * size_of::<Particle>() as f64 + 2.0 * 16.0 + 4.0) * count;
        MemoryForecast {
            needed: (PROGRAM + state + engine + cells + particles) as u64,
            available: available(),
            what: format!("{count} particles"),
            remedy: "use fewer particles",
            ranks: RankMemory::in_bands(count, cells, [rows, bytes]),
        }
    }

    fn settings(&self) -> Map<String, Value> {
        let CheckedLangevin { scene, particles, domain, diameter, .. } = self;
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

impl Startable for CheckedLangevin {
    fn particles(&self) -> &Particles {
        &self.particles
    }

    fn programs(&self) -> Vec<VectorProgram> {
        programs(self)
    }

    fn with_bound_programs(&self, task: &mut BoundPrograms<'_>) -> bool {
        with_bound_programs(self, task)
    }

    fn programs_note(&self) -> Option<String> {
        let by = self.scene.by;
        (self.has_pairs() && by != PairSearchKind::Lattice).then(|| {
            format!(
                "the programs are those of search.by = \"lattice\"; a run of the scene finds pairs by {}",
                by.word()
            )
        })
    }

    fn work(&self) -> f64 {
        // Noise and motion, plus the pairs within reach.
        let density = self.particles.len() as f64 / self.domain.area();
        let pairs = if self.has_pairs() { 0.5 * PI * self.reach * self.reach * density } else { 0.0 };
        30.0 + 8.0 * pairs
    }

    fn pair_forces(&self) -> Option<PairForces> {
        let particles = BathDynamics::of(self);
        Some(if self.has_pairs() {
            particles.with_law(PairForcesTask(self.reach))
        } else {
            PairForces { reach: 0.0, of: Arc::new(|_| [0.0; 2]) }
        })
    }

    fn follows_crossings(&self) -> bool {
        true
    }

    fn start(&self, purpose: StartPurpose) -> Result<Box<dyn Simulation>, PhysicsFailure> {
        Ok(Box::new(simulation::begin(self, purpose)?))
    }

    fn started_from(&self, particles: Particles) -> Prepared {
        CheckedLangevin { particles, ..self.clone() }.prepared()
    }

    fn with_noise(&self, seed: u64, parts: u32) -> Option<Prepared> {
        let scene = LangevinScene { noise_seed: Some(seed), ..self.scene.clone() };
        let has_noise = scene.bath.friction * scene.bath.temperature > 0.0 && parts > 0;
        let noise = NoiseSource { seed, parts };
        has_noise.then(|| CheckedLangevin { scene, seed, noise, ..self.clone() }.prepared())
    }
}

#[cfg(test)]
mod tests {
    use crate::method::{METHODS, Prepared, StartPurpose, Until, load};
    use crate::particles::{Particle, Particles};
    use std::sync::atomic::AtomicBool;

    fn prepared(preset: &str, overrides: &[&str], dt: f64) -> Prepared {
        let overrides = overrides.iter().map(|&text| text.to_owned());
        let overrides: Vec<String> = overrides.chain([format!("integrator.dt={dt:?}")]).collect();
        load(preset, &overrides, METHODS).unwrap().0
    }

    /// Returns the particles after a time, with noise of a seed and a number of parts.
    fn after(prepared: &Prepared, time: f64, (seed, parts): (u64, u32)) -> Particles {
        let coupled = prepared.model.with_noise(seed, parts).unwrap();
        let mut simulation = coupled.start(StartPurpose::Measurement).unwrap();
        let steps = (time / simulation.time_step().unwrap()).round() as u64;
        simulation.advance(&[Until::Steps(steps)], &AtomicBool::new(false)).unwrap();
        simulation.particles()
    }

    /// Root mean square difference of velocities, or of positions in a short run.
    fn apart(a: &Particles, b: &Particles, of: fn(&Particle) -> [f64; 2]) -> f64 {
        let squares = a.all().iter().zip(b.all()).map(|(a, b)| {
            let ([x, y], [u, v]) = (of(a), of(b));
            (x - u).powi(2) + (y - v).powi(2)
        });
        (squares.sum::<f64>() / a.len() as f64).sqrt()
    }

    /// The bath of baoab is exact: free particles reach the same velocity as with shorter steps, to rounding, unless the noise differs.
    #[test]
    fn baoab_bath_is_exact_for_free_particles() {
        for parts in [1, 2, 3, 8_u32] {
            let at = |dt| prepared("langevin-free", &["particles.count=300"], dt);
            let [long, short] =
                [after(&at(0.1), 2.0, (7, parts)), after(&at(0.1 / f64::from(parts)), 2.0, (7, 1))];
            let difference = apart(&long, &short, Particle::planar_velocity);
            assert!(difference < 1e-13, "{parts}: {difference}");
            let other = after(&at(0.1), 2.0, (8, parts));
            assert!(apart(&long, &other, Particle::planar_velocity) > 0.5);
        }
    }

    /// Trajectories of a fluid with steps of 8, 4 and 2 parts, compared with steps of one part. With the same noise they converge: for baoab
    /// with the first power of the step, for LAN17's scheme with its root, because each misses half a kick at the start. With other noise they
    /// stay equally far apart.
    #[test]
    fn same_noise_trajectories_converge_with_the_step() {
        const PART: f64 = 0.0005;
        for (scheme, least) in [("baoab", 1.7), ("stochastic", 1.25)] {
            let integrator = format!("integrator.kind={scheme}");
            let fluid = ["particles.count=100", "domain.sides=[12.0, 12.0]", &integrator];
            let at = |parts: u32| prepared("langevin-dense", &fluid, PART * f64::from(parts));
            let exact = after(&at(1), 0.2, (7, 1));
            let differences = |seed: u64| {
                [8, 4, 2].map(|parts| {
                    apart(&after(&at(parts), 0.2, (seed, parts)), &exact, |it| it.planar_position())
                })
            };
            let [same, other] = [differences(7), differences(8)];
            assert!(same[0] > least * same[1] && same[1] > least * same[2], "{scheme}: {same:?}");
            assert!(
                other.iter().all(|it| it / other[0] > 0.9 && *it > 5.0 * same[0]),
                "{scheme}: {other:?} {same:?}"
            );
        }
    }

    /// One part and the scene's own seed reproduce the scene bitwise; without friction or temperature there is no noise.
    #[test]
    fn a_single_noise_part_changes_nothing() {
        let own = prepared("langevin-dense", &["particles.count=100", "domain.sides=[12.0, 12.0]"], 0.005);
        let mut simulation = own.start(StartPurpose::Measurement).unwrap();
        simulation.advance(&[Until::Steps(20)], &AtomicBool::new(false)).unwrap();
        assert_eq!(simulation.particles().checksum(), after(&own, 0.1, (1, 1)).checksum());
        for without in ["law.drag=0", "law.bath_temperature=0"] {
            assert!(
                prepared("langevin-free", &[without], 0.005).model.with_noise(1, 2).is_none(),
                "{without}"
            );
        }
    }
}
