//! Scene of bodies as plain data.

use super::keys::*;
use super::options::{ArithmeticKind, ForceEngine, StartKind};
use super::schemes::SchemeName;
use crate::scene::{
    Binding, Output, Precision, RunKeys, StartFile, TIME, Write, bind_arithmetic, bind_execution,
    bind_heading,
};
use stripmine_kernels::{Execution, InstructionSet};

/// Bodies at the start.
#[derive(Clone, Debug, PartialEq)]
pub struct NbodyStart {
    /// Kind of start.
    pub kind: StartKind,
    /// Number of drawn bodies.
    pub count: usize,
    /// Seed of the drawn bodies.
    pub seed: u64,
    /// Ratio of kinetic to potential energy of spheres.
    pub virial: f64,
    /// Outward velocity over distance, of spheres (1/time).
    pub(crate) expansion: f64,
    /// Eccentricity of the ellipse.
    pub eccentricity: f64,
    /// Mass ratio of the two bodies on the ellipse.
    pub(crate) mass_ratio: f64,
    /// Distance of two clusters (length).
    pub separation: f64,
    /// Speed of the two clusters (length/time).
    pub(crate) approach: f64,
    /// Mass, position and velocity of each listed body.
    pub bodies: Vec<Vec<f64>>,
    /// Start file.
    pub file: StartFile,
    /// Ratio of energies for velocities that the file lacks.
    pub(crate) file_virial: Option<f64>,
}

/// Scene of the method, in its own units; `units` names them.
#[derive(Clone, Debug, PartialEq)]
pub struct NbodyScene {
    /// Label of the unit system.
    pub units: String,
    /// Bodies at the start.
    pub start: NbodyStart,
    /// Softening ε (length).
    pub softening: f64,
    /// Gravitational constant G (length³/(mass·time²)).
    pub gravitational_constant: f64,
    /// Integrator.
    pub scheme: SchemeName,
    /// Factor by which PWP's integrator multiplies velocities in each step.
    pub damping: f64,
    /// Tolerance of steps that adapt.
    pub tolerance: f64,
    /// Time step, or the interval of output if steps adapt (time).
    pub dt: f64,
    /// Engine that calculates the forces.
    pub engine: ForceEngine,
    /// Execution of the engine's programs, if it has any.
    pub execution: Execution,
    /// Rounding of products and roots.
    pub arithmetic: ArithmeticKind,
    /// Precision of the forces; the state is in double precision.
    pub precision: Precision,
    /// Instruction set; the widest available if none.
    pub instruction_set: Option<InstructionSet>,
    /// Duration and output intervals.
    pub run: RunKeys,
    /// Output files.
    pub output: Output,
}

impl Default for NbodyScene {
    fn default() -> Self {
        NbodyScene {
            units: String::new(),
            start: NbodyStart {
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
                file: StartFile::default(),
                file_virial: None,
            },
            softening: 0.0,
            gravitational_constant: 1.0,
            scheme: SchemeName::Leapfrog,
            damping: 1.0,
            tolerance: 1e-9,
            dt: 0.0,
            engine: ForceEngine::Fast,
            execution: Execution::Chained,
            arithmetic: ArithmeticKind::Exact,
            precision: Precision::F64,
            instruction_set: None,
            run: RunKeys::default(),
            output: Output::default(),
        }
    }
}

impl NbodyStart {
    fn bind(&mut self, binding: &mut dyn Binding) {
        binding.choice(&GENERATE, &mut self.kind);
        match self.kind {
            StartKind::Kepler => {
                binding.number(&ECCENTRICITY, &mut self.eccentricity);
                binding.number(&MASS_RATIO, &mut self.mass_ratio);
            }
            StartKind::FigureEight => {}
            StartKind::File => {
                self.file.bind_frame(binding, &FILE, &FRAME);
                binding.number_if_any(&MASS, &mut self.file.supplied.mass);
                binding.number_if_any(&VIRIAL, &mut self.file_virial);
                if self.file_virial.is_some() {
                    binding.whole(&SEED, &mut self.seed);
                }
            }
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

    /// True if the start is drawn from random numbers.
    pub fn is_drawn(&self) -> bool {
        match self.kind {
            StartKind::Kepler | StartKind::FigureEight | StartKind::List => false,
            StartKind::File => self.file_virial.is_some(),
            _ => true,
        }
    }
}

/// Intervals of output in a run whose scene does not give their length.
const OUTPUTS: f64 = 1000.0;

/// Gravitational constant of CODATA 2018 (m³/(kg s²)).
const CODATA: f64 = 6.674_30e-11;

/// Gravitational constant of a unit system: 1 unless it is the SI.
pub(super) fn constant_of(units: &str) -> f64 {
    if units == "SI" { CODATA } else { 1.0 }
}

impl NbodyScene {
    /// Binds every key of the method.
    pub(super) fn bind(&mut self, binding: &mut dyn Binding) {
        bind_heading(binding, &mut self.units, VOCABULARY.keys.method);
        self.start.bind(binding);
        binding.number(&SOFTENING, &mut self.softening);
        self.bind_constant(binding);
        binding.choice(&INTEGRATOR, &mut self.scheme);
        if self.scheme == SchemeName::DampedEuler {
            binding.number(&DAMPING, &mut self.damping);
        }
        if self.scheme.is_adaptive() {
            binding.number(&TOLERANCE, &mut self.tolerance);
        }
        binding.number(&STEP_LENGTH, &mut self.dt);
        if self.dt == 0.0 && binding.reads() {
            let mut time = None;
            binding.number_if_any(&TIME, &mut time);
            self.dt = time.filter(|time| *time > 0.0).map_or(1.0, |time| time / OUTPUTS);
        }
        binding.choice(&ENGINE, &mut self.engine);
        if self.engine == ForceEngine::Programs {
            bind_execution(binding, &EXECUTION, &mut self.execution);
        }
        if matches!(self.engine, ForceEngine::Auto | ForceEngine::Fast) {
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

    /// Instruction set of a run.
    pub(super) fn instructions(&self) -> InstructionSet {
        self.instruction_set.unwrap_or_else(InstructionSet::best)
    }

    /// Writes the whole scene as TOML, including defaults. Parsing it gives an equal scene.
    pub fn to_toml(&self) -> String {
        let mut write = Write::default();
        self.clone().bind(&mut write);
        write.to_toml(&VOCABULARY.keys)
    }
}
