//! Prepared scene of bodies: facts, step limits, memory forecast, settings and the start of a simulation.

use super::bodies::PointMasses;
use super::checked::CheckedNbody;
use super::field::GravityField;
use super::options::StartKind;
use super::scene::constant_of;
use super::shifted::{counted, with_bound_programs};
use super::simulation;
use super::starts::ORBIT;
use crate::domain::{BoxSide, Domain};
use crate::memory::{MemoryForecast, PROGRAM, RankMemory, available};
use crate::method::entry::left_out;
use crate::method::{
    BoundPrograms, Fact, LimitConsequence, PhysicsFailure, Prepared, Schedule, Simulation, StartPurpose,
    Startable, StepLimit, VectorProgram,
};
use crate::particles::{Particle, Particles};
use crate::scene::Precision;
use crate::units::with_symbol;
use crate::words::Words;
use serde_json::{Map, Value, json};

impl CheckedNbody {
    /// Turns the checked scene into the interface common to all methods.
    pub(super) fn prepared(self) -> Prepared {
        let scene = &self.scene;
        Prepared {
            units: scene.units.clone(),
            scene: scene.to_toml(),
            schedule: Schedule::of_steps(&scene.run),
            target: scene.run.target.clone(),
            output: scene.output.clone(),
            domain: Domain { origin: [0.0; 3], sides: [BoxSide::Open; 3] },
            seed: scene.start.is_drawn().then_some(scene.start.seed),
            start_file: (scene.start.kind == StartKind::File).then(|| scene.start.file.path().to_owned()),
            law_file: None,
            facts: self.facts(),
            warnings: self.warnings.clone(),
            choices: self.choices.clone(),
            left_out: left_out(&[(scene.softening == 0.0, "softening: law.softening is 0")]),
            step_limits: self.step_limits(),
            expected_error: None,
            memory: self.memory(),
            settings: self.settings(),
            event_columns: None,
            model: Box::new(self),
        }
    }

    fn facts(&self) -> Vec<Fact> {
        let (scene, count) = (&self.scene, self.particles.len());
        vec![
            Fact::new("units", scene.units.as_str(), "units", scene.units.as_str()),
            Fact::new("grains", count, "bodies", count.to_string()),
            Fact::new("start", scene.start.kind.word(), "start", scene.start.kind.word()),
            Fact::new("softening", scene.softening, "softening", {
                with_symbol(&scene.softening.to_string(), &scene.units, "length")
            }),
            self.constant_in_words(),
            Fact::new("integrator", scene.scheme.word(), "integrator", scene.scheme.word()),
            Fact::words("steps", {
                let dt = with_symbol(&format!("{:?}", scene.dt), &scene.units, "time");
                match scene.scheme.is_adaptive() {
                    true => format!("adaptive; {} intervals of output of dt = {dt}", scene.run.steps),
                    false => format!("{} of dt = {dt}", scene.run.steps),
                }
            }),
        ]
    }

    fn constant_in_words(&self) -> Fact {
        let (units, constant) = (self.scene.units.as_str(), self.scene.gravitational_constant);
        let mut words = constant.to_string();
        if constant == constant_of(units) && constant != 1.0 {
            words = format!("{constant:e} m³/(kg s²), for units = \"{units}\"");
        }
        Fact::new("gravitational_constant", constant, "gravitational constant", words)
    }

    fn step_limits(&self) -> Vec<StepLimit> {
        let scene = &self.scene;
        match scene.start.kind {
            _ if scene.scheme.is_adaptive() => vec![],
            StartKind::Kepler => {
                // At the nearest point the bodies turn as on a circle of that radius. Fourth-order schemes resolve it in ten steps, so
                // a warning begins there; the energy error judges the run.
                let orbit = ORBIT / scene.gravitational_constant.sqrt();
                let step = orbit * (1.0 - scene.start.eccentricity).powf(1.5) / 20.0;
                let why =
                    "a twentieth of the period of a circle through the nearest point, 2π (1 − e)^{3/2}/(20 √G)"
                        .to_owned();
                vec![StepLimit {
                    name: "nearest-passage",
                    step,
                    share: scene.dt / step,
                    warned_beyond: 2.0,
                    beyond: LimitConsequence::Inaccurate,
                    why,
                }]
            }
            _ if scene.softening > 0.0 => {
                let heaviest = self.particles.all().iter().map(|body| body.mass).fold(0.0, f64::max);
                let attraction = scene.gravitational_constant * heaviest;
                let step = (scene.softening.powi(3) / (2.0 * attraction)).sqrt();
                let why =
                    "√(ε³/2Gm): the oscillation period of two of the heaviest bodies through each other, over 2π"
                        .to_owned();
                vec![StepLimit {
                    name: "closest-encounter",
                    step,
                    share: scene.dt / step,
                    warned_beyond: 1.0,
                    beyond: LimitConsequence::Inaccurate,
                    why,
                }]
            }
            _ => vec![],
        }
    }

    fn memory(&self) -> MemoryForecast {
        let count = self.particles.len();
        let [held, carried] = self.scene.scheme.stored_quantities();
        // Positions, velocities and masses, and the state before a step; the quantities of the scheme; scratch for the half-mass radius and the
        // nearest pair. Particles of the scene, of the run, and of two frames.
        let columns = 24 * (2 + 2 + held + carried) + 8 + 3 * 16 + 4;
        let particles = 4 * size_of::<Particle>();
        let needed =
            PROGRAM + (count * (columns + particles) + GravityField::bytes(&self.scene, count)) as f64;
        MemoryForecast {
            needed: needed as u64,
            available: available(),
            what: format!("{count} bodies"),
            remedy: "use fewer bodies",
            // Every rank has all bodies.
            ranks: RankMemory { each: needed - PROGRAM, ..RankMemory::default() },
        }
    }

    fn settings(&self) -> Map<String, Value> {
        let scene = &self.scene;
        let settings = [
            ("precision", json!(scene.precision.word())),
            ("integrator", json!(scene.scheme.word())),
            ("engine", json!(scene.engine.word())),
            ("arithmetic", json!(scene.arithmetic.word())),
            ("instruction_set", json!(scene.instructions().name())),
        ];
        settings.map(|(name, value)| (name.to_owned(), value)).into_iter().collect()
    }
}

impl Startable for CheckedNbody {
    fn particles(&self) -> &Particles {
        &self.particles
    }

    fn programs(&self) -> Vec<VectorProgram> {
        counted(self.scene.softening, self.particles.len())
    }

    fn with_bound_programs(&self, task: &mut BoundPrograms<'_>) -> bool {
        let all = self.particles.all();
        let bodies = PointMasses::new(all.iter().map(|body| (body.position, body.velocity, body.mass)));
        match self.scene.precision {
            Precision::F64 => with_bound_programs::<f64>(self.scene.softening, &bodies, task),
            Precision::F32 | Precision::Mixed => {
                with_bound_programs::<f32>(self.scene.softening, &bodies, task)
            }
        }
        true
    }

    fn start(&self, purpose: StartPurpose) -> Result<Box<dyn Simulation>, PhysicsFailure> {
        Ok(Box::new(simulation::begin(self, purpose)?))
    }

    fn started_from(&self, particles: Particles) -> Prepared {
        CheckedNbody { particles, ..self.clone() }.prepared()
    }
}
