//! Checked scene and its simulation behind the interfaces shared by all methods.

use super::check::{CheckedGranularScene, MotionEstimates};
use super::document::GranularDocument;
use super::facts::{expected_error, facts};
use super::fast::reach;
use super::programs::with_program_law;
use super::theory::limits::step_limits;
use super::{Lengths, ProgramArrays, StepProgram, memory, model, programs, running};
use crate::method::pairwise::PairForcesTask;
use crate::method::{
    BoundPrograms, PhysicsFailure, Prepared, ProgramCall, Schedule, Simulation, StartPurpose, Startable,
    VectorProgram, names_of,
};
use crate::particles::Particles;
use crate::scene::{Precision, SceneErrors, WallMotion};
use crate::structure::PairForces;
use crate::words::Words;
use serde_json::{Map, Value, json};
use std::f64::consts::PI;
use std::path::Path;

impl GranularDocument {
    /// Generates the discs and checks the scene against the method's preconditions, as every method does.
    ///
    /// # Errors
    /// As [`check`](Self::check).
    pub fn prepare(self) -> Result<Prepared, SceneErrors> {
        Ok(self.check()?.prepared())
    }

    /// Prepares the scene at any step: predictions for the step reject nothing.
    ///
    /// # Errors
    /// As [`check`](Self::check).
    pub(crate) fn prepare_at_any_step(self) -> Result<Prepared, SceneErrors> {
        Ok(self.check_at_any_step()?.prepared())
    }
}

impl CheckedGranularScene {
    /// Prepared scene.
    fn prepared(self) -> Prepared {
        let scene = &self.scene;
        Prepared {
            units: scene.units.clone(),
            scene: scene.to_toml(),
            schedule: Schedule::of_steps(&scene.run),
            target: scene.run.target.clone(),
            output: scene.output.clone(),
            domain: self.domain,
            seed: scene.start.seed(),
            start_file: scene.start.file().map(Path::to_owned),
            law_file: None,
            facts: facts(&self),
            warnings: self.warnings.clone(),
            choices: self.choices.clone(),
            left_out: self.left_out.clone(),
            step_limits: step_limits(&self),
            expected_error: expected_error(&self),
            memory: memory::foreseen(&self),
            settings: self.settings(),
            event_columns: None,
            model: Box::new(self),
        }
    }

    fn settings(&self) -> Map<String, Value> {
        let CheckedGranularScene { scene, domain, particles, geometry, .. } = self;
        let discs: f64 = particles.all().iter().map(|disc| std::f64::consts::PI * disc.radius.powi(2)).sum();
        let cell_edge = scene.needs_lattice().then_some(geometry.frame.edge);
        let settings = [
            ("packing_fraction", json!(discs / (domain.area()))),
            ("precision", json!(scene.machine.precision.word())),
            ("integrator", json!(scene.integrator.scheme.name())),
            ("execution", json!(scene.machine.execution_name())),
            ("text", json!((!scene.machine.is_fast()).then(|| scene.machine.text.word()))),
            ("friction", json!(scene.has_friction())),
            ("cell_edge", json!(cell_edge)),
            ("instruction_set", json!(scene.machine.instructions().name())),
        ];
        settings.map(|(name, value)| (name.to_owned(), value)).into_iter().collect()
    }
}

impl Startable for CheckedGranularScene {
    fn particles(&self) -> &Particles {
        &self.particles
    }

    fn has_segments(&self) -> bool {
        !self.scene.plane.list.is_empty()
    }

    fn own_quantities(&self) -> Vec<String> {
        let of_walls =
            self.walls.all().iter().flat_map(|wall| names_of("wall", &wall.label, !wall.motion.is_fixed()));
        let lines = 1..=self.scene.plane.lines.len();
        of_walls.chain(lines.flat_map(|line| names_of("flux", &line.to_string(), false))).collect()
    }

    fn work(&self) -> f64 {
        // Cost of moving them and finding the pairs, plus the contacts, whose number grows with density.
        let discs = self.particles.all().iter();
        let fraction = discs.map(|disc| PI * disc.radius * disc.radius).sum::<f64>() / self.domain.area();
        2.5 + 16.0 * fraction.min(1.0)
    }

    fn programs(&self) -> Vec<VectorProgram> {
        // Lists and sectors have no vector programs: count those of the lattice.
        let on_lattice = match self.scene.needs_lattice() {
            true => None,
            false => match self.on_lattice() {
                Some(on_lattice) => Some(on_lattice),
                None => return vec![],
            },
        };
        let model = model(on_lattice.as_ref().unwrap_or(self));
        let particles = &self.particles;
        let lengths = Lengths::new(&model, particles.grain_count(), particles.len());
        let as_any = |step: StepProgram| VectorProgram {
            part: step.part.name(),
            length: step.length.symbol(),
            n: lengths.range(step.length).len(),
            times: 1,
            program: step.program,
        };
        programs(&model, Precision::F64).into_iter().map(as_any).collect()
    }

    fn with_bound_programs(&self, task: &mut BoundPrograms<'_>) -> bool {
        let on_lattice = if self.scene.needs_lattice() { None } else { self.on_lattice() };
        if on_lattice.is_none() && !self.scene.needs_lattice() {
            return false;
        }
        let model = model(on_lattice.as_ref().unwrap_or(self));
        let programs = programs(&model, self.scene.machine.precision);
        let mut arrays = ProgramArrays::<f64, f64>::new(&model, &self.particles);
        let (memory, lengths) = arrays.memory();
        let calls: Vec<ProgramCall<'_>> = programs
            .iter()
            .flat_map(|step| {
                let call = move |range| ProgramCall {
                    part: step.part.name(),
                    program: step.program.as_ref(),
                    range,
                };
                lengths.ranges(step.length).into_iter().map(call)
            })
            .collect();
        task(&calls, &memory);
        true
    }

    fn programs_note(&self) -> Option<String> {
        let by = self.scene.search.by;
        (!self.scene.needs_lattice()).then(|| {
            format!(
                "the programs are those of search.by = \"lattice\"; a run of the scene finds contacts by {}",
                by.word()
            )
        })
    }

    fn pair_forces(&self) -> Option<PairForces> {
        Some(with_program_law(&model(self), PairForcesTask(reach(&self.particles))))
    }

    fn follows_crossings(&self) -> bool {
        true
    }

    fn start(&self, purpose: StartPurpose) -> Result<Box<dyn Simulation>, PhysicsFailure> {
        Ok(Box::new(running::begin(self, purpose)?))
    }

    fn started_from(&self, particles: Particles) -> Prepared {
        let estimates = MotionEstimates::of(&self.scene, &particles);
        CheckedGranularScene { particles, estimates, ..self.clone() }.prepared()
    }

    fn period(&self) -> Option<f64> {
        match self.scene.walls {
            WallMotion::Oscillating { frequency, .. } => Some(1.0 / frequency),
            WallMotion::Fixed => {
                let frequencies = self.scene.plane.list.iter().map(|wall| wall.motion.frequency);
                frequencies.filter(|&frequency| frequency > 0.0).reduce(f64::min).map(|slowest| 1.0 / slowest)
            }
        }
    }
}
