//! Scene of this method as plain data.

use super::keys::*;
use super::model::{GearValues, GranularScheme, OnLongStep};
use super::neighbor_list::Rebuild;
pub use super::options::{EngineChoice, Inertia, IntegratorKind, ProgramVersion, SearchKind};
use super::wall_keys::{SceneWall, SceneWalls};
use crate::method::pairwise::search::OnConflict;
use crate::scene::{
    Binding, DT, DiscStart, Output, Precision, RunKeys, SceneDomain, WallMotion, Write, bind_arithmetic,
    bind_execution, bind_heading, execution_name,
};
use crate::words::Words;
use stripmine_kernels::law::granular::{Contact, ContactArm};
use stripmine_kernels::law::spring::Spring;
use stripmine_kernels::sweep::lattice::Coordinates;
use stripmine_kernels::{Execution, InstructionSet};

/// Simulated scene. Units are the scene's own; `units` names them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GranularScene {
    /// The unit system: a label.
    pub units: String,
    /// The box.
    pub domain: SceneDomain,
    /// The discs at the start.
    pub start: DiscStart,
    /// Motion of wall discs.
    pub walls: WallMotion,
    /// Plane walls.
    pub plane: SceneWalls,
    /// Contact law.
    pub law: GranularLaw,
    /// Search for contacts.
    pub search: SearchSettings,
    /// Integrator.
    pub integrator: Integrator,
    /// Engine, precision and instruction set.
    pub machine: MachineSettings,
    /// Length of the run and intervals of its output.
    pub run: RunKeys,
    /// Files to write.
    pub output: Output,
}

/// The granular contact law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GranularLaw {
    /// Spring, dampings, friction, clamp and arm.
    pub contact: Contact,
    /// Distribution of mass in a disc.
    pub inertia: Inertia,
    /// Penetration, as a fraction of the sum of the radii, up to which the lattice is exact.
    pub max_penetration: f64,
    /// Penetration that stops the run.
    pub stop_penetration: f64,
}

impl Default for GranularLaw {
    fn default() -> Self {
        let contact = Contact {
            spring: Spring::Hertz,
            stiffness: 0.0,
            normal_damping: 0.0,
            shear_damping: 0.0,
            friction: 0.0,
            cohesionless: true,
            arm: ContactArm::Radius,
        };
        GranularLaw { contact, inertia: Inertia::Disc, max_penetration: 0.0, stop_penetration: 0.0 }
    }
}

impl GranularLaw {
    /// True with a tangential force, and with it rotation.
    pub(crate) fn has_friction(&self) -> bool {
        self.contact.friction > 0.0 && self.contact.shear_damping > 0.0
    }

    fn bind(&mut self, binding: &mut dyn Binding) {
        binding.choice(&LAW, &mut self.contact.spring);
        binding.number(&STIFFNESS, &mut self.contact.stiffness);
        binding.number(&NORMAL_DAMPING, &mut self.contact.normal_damping);
        binding.number(&SHEAR_DAMPING, &mut self.contact.shear_damping);
        binding.number(&FRICTION, &mut self.contact.friction);
        binding.switch(&COHESIONLESS, &mut self.contact.cohesionless);
        binding.choice(&INERTIA, &mut self.inertia);
        binding.choice(&CONTACT_ARM, &mut self.contact.arm);
        binding.number(&MAX_PENETRATION, &mut self.max_penetration);
        binding.number(&STOP_PENETRATION, &mut self.stop_penetration);
    }
}

/// Search for contacts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SearchSettings {
    /// Lattice, sectors or lists.
    pub by: SearchKind,
    /// Side of a lattice cell (length); none for the fewest cells.
    pub(crate) cell_edge: Option<f64>,
    /// Width of the mask in cells, 5 or 7; none for the smallest that works.
    pub mask: Option<u64>,
    /// Action for a disc in an occupied lattice cell.
    pub(crate) on_conflict: OnConflict,
    /// Construction of the lists.
    pub rebuild: Rebuild,
    /// Largest gap of a listed pair (length); none for the engine's best choice.
    pub skin: Option<f64>,
}

impl SearchSettings {
    fn bind(&mut self, binding: &mut dyn Binding) {
        binding.choice(&SEARCH, &mut self.by);
        if self.by != SearchKind::Sectors {
            binding.number_if_any(&CELL_EDGE, &mut self.cell_edge);
            binding.whole_if_any(&MASK, &mut self.mask);
        }
        if matches!(self.by, SearchKind::Auto | SearchKind::Lattice) {
            binding.choice(&ON_CONFLICT, &mut self.on_conflict);
        }
        if self.by == SearchKind::NeighborList {
            binding.choice(&REBUILD, &mut self.rebuild);
            binding.number_if_any(&SKIN, &mut self.skin);
        }
    }
}

/// Engine, precision and instruction set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MachineSettings {
    /// Engine that steps the discs.
    pub engine: EngineChoice,
    /// Version of the programs.
    pub text: ProgramVersion,
    /// Execution of the programs.
    pub execution: Execution,
    /// Origin of positions in programs.
    pub coordinates: Coordinates,
    /// Precision of state and forces.
    pub precision: Precision,
    /// SIMD instructions; none for the widest available.
    pub instruction_set: Option<InstructionSet>,
}

impl Default for MachineSettings {
    fn default() -> Self {
        MachineSettings {
            engine: EngineChoice::Auto,
            text: ProgramVersion::Ours,
            execution: Execution::Chained,
            coordinates: Coordinates::CellRelative,
            precision: Precision::F64,
            instruction_set: None,
        }
    }
}

impl MachineSettings {
    /// True if the fast engine steps the discs.
    pub(crate) fn is_fast(&self) -> bool {
        self.engine != EngineChoice::Programs
    }

    /// Name of the executing engine: `fast`, or the execution of the programs.
    pub(crate) fn execution_name(&self) -> String {
        if self.is_fast() { EngineChoice::Fast.word().to_owned() } else { execution_name(self.execution) }
    }

    /// Instruction set in use.
    pub fn instructions(&self) -> InstructionSet {
        self.instruction_set.unwrap_or_else(InstructionSet::best)
    }

    fn bind(&mut self, binding: &mut dyn Binding) {
        binding.choice(&ENGINE, &mut self.engine);
        // The engine that auto selects lacks these keys, unless one of them is given.
        let is_open = self.engine == EngineChoice::Auto && binding.reads();
        if self.engine == EngineChoice::Programs || is_open {
            binding.choice(&TEXT, &mut self.text);
            if self.text == ProgramVersion::Printed {
                self.coordinates = Coordinates::Absolute;
            }
            bind_execution(binding, &EXECUTION, &mut self.execution);
            binding.choice(&COORDINATES, &mut self.coordinates);
        }
        bind_arithmetic(binding, &mut self.precision, &mut self.instruction_set);
    }
}

/// The integrator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Integrator {
    /// Integration scheme.
    pub scheme: GranularScheme,
    /// Time step (time).
    pub dt: f64,
    /// Action for a disc that moves so far in a step that contacts may be missed.
    pub(crate) on_long_step: OnLongStep,
}

impl Default for Integrator {
    fn default() -> Self {
        Integrator { scheme: GranularScheme::VelocityVerlet, dt: 0.0, on_long_step: OnLongStep::Stop }
    }
}

impl Integrator {
    fn bind(&mut self, binding: &mut dyn Binding) {
        let (mut kind, mut values) = match self.scheme {
            GranularScheme::Gear(values) => (IntegratorKind::Gear, values),
            GranularScheme::VelocityVerlet => (IntegratorKind::VelocityVerlet, GearValues::Four),
        };
        binding.choice(&INTEGRATOR, &mut kind);
        self.scheme = match kind {
            IntegratorKind::VelocityVerlet => GranularScheme::VelocityVerlet,
            IntegratorKind::Gear => {
                let mut count = values.count() as u64;
                binding.whole(&VALUES, &mut count);
                let asked = GearValues::ALL.into_iter().find(|values| values.count() as u64 == count);
                values = asked.unwrap_or(values);
                GranularScheme::Gear(values)
            }
        };
        binding.number(&DT, &mut self.dt);
        binding.choice(&ON_LONG_STEP, &mut self.on_long_step);
    }
}

impl GranularScene {
    /// Binds every key of the method.
    pub(super) fn bind(&mut self, binding: &mut dyn Binding) {
        bind_heading(binding, &mut self.units, VOCABULARY.keys.method);
        self.domain.bind(binding);
        self.start.bind(binding);
        self.walls.bind(binding, &self.start);
        self.plane.bind(binding);
        self.law.bind(binding);
        self.search.bind(binding);
        self.integrator.bind(binding);
        self.machine.bind(binding);
        self.run.bind(binding, self.integrator.dt);
        self.output.bind(binding);
    }

    /// Writes the whole scene as TOML, including defaults. Parsing it gives an equal scene.
    pub fn to_toml(&self) -> String {
        let mut write = Write::default();
        self.clone().bind(&mut write);
        write.to_toml(&VOCABULARY.keys)
    }

    /// True if discs need exclusive lattice cells, or are found through the mask.
    pub fn needs_lattice(&self) -> bool {
        match self.search.by {
            SearchKind::Auto | SearchKind::Lattice => true,
            SearchKind::Sectors => false,
            SearchKind::NeighborList => !self.machine.is_fast(),
        }
    }

    /// True with a tangential force between grains or at a plane wall, and with it rotation.
    pub(crate) fn has_friction(&self) -> bool {
        let at_wall = |wall: &SceneWall| {
            let [_, damping, friction] = wall.own;
            damping.unwrap_or(self.law.contact.shear_damping) > 0.0
                && friction.unwrap_or(self.law.contact.friction) > 0.0
        };
        self.law.has_friction() || self.plane.list.iter().any(at_wall)
    }

    /// Largest normal and tangential damping of a contact, between grains or at a plane wall (1/time).
    pub(crate) fn dampings(&self) -> [f64; 2] {
        let law = &self.law.contact;
        let [normal, shear] =
            [0, 1].map(|k| self.plane.list.iter().filter_map(|wall| wall.own[k]).fold(0.0, f64::max));
        [normal.max(law.normal_damping), shear.max(law.shear_damping)]
    }

    /// Simulated time (time).
    pub fn duration(&self) -> f64 {
        self.run.steps as f64 * self.integrator.dt
    }
}
