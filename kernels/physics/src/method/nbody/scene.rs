//! What a scene of this method says, as plain data.

use super::keys::*;
use super::options::{ArithmeticKind, Engine, StartKind};
use super::schemes::SchemeName;
use crate::scene::{Binding, Output, Precision, Run, Write, bind_arithmetic, bind_execution, bind_heading};
use stripmine_kernels::{Execution, InstructionSet};

/// Bodies at the start.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// Where they start.
    pub kind: StartKind,
    /// How many are drawn.
    pub count: usize,
    /// Seed of what is drawn.
    pub seed: u64,
    /// Kinetic over potential energy of spheres.
    pub virial: f64,
    /// Velocity outwards over distance of spheres (1/time).
    pub(crate) expansion: f64,
    /// Of the ellipse.
    pub eccentricity: f64,
    /// Of the two bodies on it.
    pub(crate) mass_ratio: f64,
    /// Of two clusters (length).
    pub separation: f64,
    /// Their speed (length/time).
    pub(crate) approach: f64,
    /// Mass, position and velocity of each that is listed.
    pub bodies: Vec<Vec<f64>>,
}

/// What is simulated.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// The unit system: a label.
    pub units: String,
    /// Bodies at the start.
    pub start: Start,
    /// ε (length).
    pub softening: f64,
    /// G (length³/(mass·time²)).
    pub gravitational_constant: f64,
    /// The integrator.
    pub scheme: SchemeName,
    /// What the source's multiplies velocities by.
    pub damping: f64,
    /// Time step (time).
    pub dt: f64,
    /// What finds the forces.
    pub engine: Engine,
    /// How its programs are executed, where it has such.
    pub execution: Execution,
    /// How products and roots are formed.
    pub arithmetic: ArithmeticKind,
    /// Precision of the forces; the state is in double precision.
    pub precision: Precision,
    /// The instructions; the widest set that there is if none.
    pub instruction_set: Option<InstructionSet>,
    /// How long, and how often something is written.
    pub run: Run,
    /// Which files are written.
    pub output: Output,
}

impl Default for Scene {
    fn default() -> Self {
        Scene {
            units: String::new(),
            start: Start {
                kind: StartKind::Plummer,
                count: 0,
                seed: 1,
                virial: 0.0,
                expansion: 0.0,
                eccentricity: 0.5,
                mass_ratio: 1.0,
                separation: 8.0,
                approach: 0.3,
                bodies: vec![],
            },
            softening: 0.0,
            gravitational_constant: 1.0,
            scheme: SchemeName::Leapfrog,
            damping: 1.0,
            dt: 0.0,
            engine: Engine::Fast,
            execution: Execution::Chained,
            arithmetic: ArithmeticKind::Exact,
            precision: Precision::F64,
            instruction_set: None,
            run: Run::default(),
            output: Output::default(),
        }
    }
}

impl Start {
    fn bind(&mut self, binding: &mut dyn Binding) {
        binding.choice(&GENERATE, &mut self.kind);
        match self.kind {
            StartKind::Kepler => {
                binding.number(&ECCENTRICITY, &mut self.eccentricity);
                binding.number(&MASS_RATIO, &mut self.mass_ratio);
            }
            StartKind::FigureEight => {}
            StartKind::List => binding.rows(&BODIES, &mut self.bodies),
            StartKind::Plummer | StartKind::Sphere | StartKind::Shell | StartKind::TwoClusters => {
                binding.count(&COUNT, &mut self.count);
                binding.whole(&SEED, &mut self.seed);
            }
        }
        if matches!(self.kind, StartKind::Sphere | StartKind::Shell) {
            binding.number(&VIRIAL, &mut self.virial);
            binding.number(&EXPANSION, &mut self.expansion);
        }
        if self.kind == StartKind::TwoClusters {
            binding.number(&SEPARATION, &mut self.separation);
            binding.number(&APPROACH, &mut self.approach);
        }
    }

    /// Whether random numbers make it.
    pub fn is_drawn(&self) -> bool {
        !matches!(self.kind, StartKind::Kepler | StartKind::FigureEight | StartKind::List)
    }
}

/// The gravitational constant of CODATA 2018 (m³/(kg s²)).
const CODATA: f64 = 6.674_30e-11;

/// The gravitational constant of a unit system: 1 unless it is the SI.
pub(super) fn constant_of(units: &str) -> f64 {
    if units == "SI" { CODATA } else { 1.0 }
}

impl Scene {
    /// Meets every key of the method.
    pub(super) fn bind(&mut self, binding: &mut dyn Binding) {
        bind_heading(binding, &mut self.units, VOCABULARY.keys.method);
        self.start.bind(binding);
        binding.number(&SOFTENING, &mut self.softening);
        self.bind_constant(binding);
        binding.choice(&INTEGRATOR, &mut self.scheme);
        if self.scheme == SchemeName::DampedEuler {
            binding.number(&DAMPING, &mut self.damping);
        }
        binding.number(&crate::scene::DT, &mut self.dt);
        binding.choice(&ENGINE, &mut self.engine);
        if self.engine == Engine::Programs {
            bind_execution(binding, &EXECUTION, &mut self.execution);
        }
        if matches!(self.engine, Engine::Auto | Engine::Fast) {
            binding.choice(&ROOTS, &mut self.arithmetic);
        }
        bind_arithmetic(binding, &mut self.precision, &mut self.instruction_set);
        self.run.bind(binding, self.dt);
        self.output.bind(binding);
    }

    fn bind_constant(&mut self, binding: &mut dyn Binding) {
        let mut constant = match binding.reads() {
            true => None,
            false => Some(self.gravitational_constant),
        };
        binding.number_if_any(&CONSTANT, &mut constant);
        self.gravitational_constant = constant.unwrap_or_else(|| constant_of(&self.units));
    }

    /// The instructions of a run.
    pub(super) fn instructions(&self) -> InstructionSet {
        self.instruction_set.unwrap_or_else(InstructionSet::best)
    }

    /// The whole scene as TOML, defaults written out. Parsing it gives an equal scene.
    pub fn to_toml(&self) -> String {
        let mut write = Write::default();
        self.clone().bind(&mut write);
        write.to_toml(&VOCABULARY.keys)
    }
}
