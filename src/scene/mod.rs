//! Scenes: what is simulated, as a TOML file says it.
//!
//! A file is read through one table of keys ([`KEYS`]), which knows name, type, range, unit, default and documentation
//! of each; all mistakes are found at once, each with its place ([`SceneErrors`]). The result is plain data
//! ([`Scene`]). [`Document::check`] then makes the discs and holds the scene against what the method demands
//! ([`Checked`]).

mod assemble;
mod check;
mod document;
mod error;
mod key_table;
mod keys;
mod places;
mod presets;
mod rules;

pub use check::{Checked, Estimates, Geometry};
pub use error::{Place, Reason, SceneError, SceneErrors, Warning};
pub use key_table::{KEYS, SECTIONS};
pub use keys::{Bounds, Fallback, Key, Kind, Selector, Use, Value};
pub use places::Document;
pub use presets::{PRESETS, Preset, preset};

use std::path::PathBuf;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::law::granular::Contact;
use stripmine_kernels::sweep::lattice::Coordinates;

/// The version of the scene format that this program reads.
pub const FORMAT: u64 = 1;

/// What is simulated. Units are the scene's own; `units` names them.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// The unit system: a label.
    pub units: String,
    /// The box.
    pub domain: Domain,
    /// The discs at the start.
    pub start: Start,
    /// The motion of wall discs.
    pub walls: WallMotion,
    /// What discs in contact do to each other.
    pub law: Law,
    /// How contacts are found and the arithmetic is done.
    pub method: Method,
    /// How motion follows from forces.
    pub integrator: Integrator,
    /// How long, and how often something is written.
    pub run: Run,
    /// Which files are written.
    pub output: Output,
}

/// The box.
#[derive(Clone, Debug, PartialEq)]
pub struct Domain {
    /// Lower left corner (length).
    pub origin: [f64; 2],
    /// Sides (length); none where a hexagonal start sets them.
    pub sides: Option<[f64; 2]>,
    /// Which sides are periodic.
    pub periodic: [bool; 2],
    /// Acceleration of gravity (length/time²).
    pub gravity: [f64; 2],
}

/// The discs at the start.
#[derive(Clone, Debug, PartialEq)]
pub enum Start {
    /// Read from an extended XYZ file.
    File(PathBuf),
    /// As listed.
    List(List),
    /// On a hexagonal lattice, each shifted at random by at most 0.45 of the gap; the box is made to fit.
    Hexagonal {
        /// Number of discs, at least.
        count: usize,
        /// N π R² over the area of the box.
        packing_fraction: f64,
        /// The discs.
        grains: Grains,
    },
    /// At random in the box, without overlap.
    Random {
        /// How many.
        amount: Amount,
        /// The discs.
        grains: Grains,
    },
    /// At random in a pipe along x between two rows of wall discs, the upper row shifted by half a spacing.
    Pipe {
        /// How many; the packing fraction is that of the clear channel.
        amount: Amount,
        /// The discs.
        grains: Grains,
        /// The wall discs.
        lining: Lining,
        /// Width between the surfaces of the wall discs (length).
        clear_width: f64,
    },
    /// At random above a floor of wall discs.
    Box {
        /// How many; the packing fraction is that of the fill height.
        amount: Amount,
        /// The discs.
        grains: Grains,
        /// The floor.
        lining: Lining,
        /// Height above the floor up to which discs are placed (length).
        fill_height: f64,
    },
}

/// How many discs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amount {
    /// This many.
    Count(usize),
    /// As many as make N π R² this part of the area that is open to them.
    PackingFraction(f64),
}

/// Discs to be generated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grains {
    /// Mean radius (length).
    pub radius: f64,
    /// Standard deviation of the Gaussian radii, relative to the mean.
    pub spread: f64,
    /// Largest deviation of a radius, relative to the mean.
    pub cut: f64,
    /// Mass of a disc of the mean radius (mass); others have it times (R/mean)².
    pub mass: f64,
    /// Velocities.
    pub speed: Speed,
    /// Seed of radii, positions and velocities.
    pub seed: u64,
}

/// Velocities at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Speed {
    /// Gaussian, of this standard deviation for each component (length/time); 0 is rest.
    Deviation(f64),
    /// Maxwell, of this kT (mass·length²/time²).
    Temperature(f64),
}

/// Wall discs in a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lining {
    /// Radius (length).
    pub radius: f64,
    /// Distance of neighbouring centres (length).
    pub spacing: f64,
}

/// Discs one by one.
#[derive(Clone, Debug, PartialEq)]
pub struct List {
    /// Centres of the grains (length).
    pub positions: Vec<[f64; 2]>,
    /// Velocities (length/time).
    pub velocities: Vec<[f64; 2]>,
    /// Angular velocities (1/time).
    pub omegas: Vec<f64>,
    /// Radii (length).
    pub radii: Vec<f64>,
    /// Radius (length) of a disc of mass `mass`.
    pub radius: f64,
    /// Mass of a disc of radius `radius`; others have it times (R/radius)².
    pub mass: f64,
    /// Centres of the wall discs (length).
    pub wall_positions: Vec<[f64; 2]>,
    /// Radius of the wall discs (length).
    pub wall_radius: f64,
}

/// How wall discs move, all together.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum WallMotion {
    /// Not at all.
    #[default]
    Fixed,
    /// r(t) = r(0) + a sin(2π f t).
    Oscillating {
        /// a (length).
        amplitude: [f64; 2],
        /// f (1/time).
        frequency: f64,
    },
}

/// The granular contact law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law {
    /// Stiffness, dampings, friction, clamp and arm.
    pub contact: Contact,
    /// How mass is distributed in a disc.
    pub inertia: Inertia,
    /// Penetration, as a fraction of the sum of the radii, up to which the lattice is exact.
    pub max_penetration: f64,
    /// Penetration that stops the run.
    pub stop_penetration: f64,
}

impl Law {
    /// Whether there is a tangential force, and with it rotation.
    pub fn has_friction(&self) -> bool {
        self.contact.friction > 0.0 && self.contact.shear_damping > 0.0
    }
}

/// How mass is distributed in a disc.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Inertia {
    /// Evenly over the area: ½ m R².
    #[default]
    Disc,
    /// As in a sphere: ⅖ m R².
    Sphere,
}

impl Inertia {
    /// I/(m R²).
    pub fn factor(self) -> f64 {
        match self {
            Inertia::Disc => 0.5,
            Inertia::Sphere => 0.4,
        }
    }
}

/// How contacts are found and the arithmetic is done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Method {
    /// Lattice or its rival.
    pub kind: MethodKind,
    /// Side of a lattice cell (length); none: the fewest cells.
    pub cell_edge: Option<f64>,
    /// Width of the mask in cells, 5 or 7; none: the smallest that serves.
    pub mask: Option<usize>,
    /// What becomes of a disc whose lattice cell is another's.
    pub on_conflict: OnConflict,
    /// What positions on the lattice are measured from.
    pub coordinates: Coordinates,
    /// Precision of state and forces.
    pub precision: Precision,
    /// How a step is executed.
    pub execution: Execution,
    /// The SIMD instructions; none: the widest there are.
    pub instruction_set: Option<InstructionSet>,
}

impl Method {
    /// Whether discs must have a cell of the exclusive lattice to themselves, or be seen through its mask.
    pub fn needs_lattice(&self) -> bool {
        match self.kind {
            MethodKind::Lattice => true,
            MethodKind::Sectors => false,
            MethodKind::NeighborList { .. } => self.execution != Execution::Fast,
        }
    }
}

/// What becomes of a disc whose lattice cell is another's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OnConflict {
    /// The run stops.
    #[default]
    Stop,
    /// It is kept beside the lattice, and counted.
    Resolve,
}

/// How contacts are found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MethodKind {
    /// On the exclusive lattice.
    Lattice,
    /// In sectors that hold any number of discs.
    Sectors,
    /// By neighbour lists.
    NeighborList {
        /// How lists are made.
        rebuild: Rebuild,
        /// Listed pairs are up to this far from contact (length); none: 0.3 R_max.
        skin: Option<f64>,
    },
}

/// How neighbour lists are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rebuild {
    /// By looking into the cells around each disc.
    Cells,
    /// By trying every pair, as in the source.
    AllPairs,
}

/// Precision of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// State and forces in f64.
    #[default]
    F64,
    /// State and forces in f32.
    F32,
    /// State in f64, forces in f32.
    Mixed,
}

/// How a step of the lattice is executed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Execution {
    /// By vector programs over the whole lattice, as the source has it. All ways give the same bits.
    Programs(stripmine_kernels::Execution),
    /// Each pair once, the law for contacts only: equal to the programs but for rounding.
    Fast,
}

impl Execution {
    /// The name in scenes and on the command line.
    pub fn name(self) -> String {
        use stripmine_kernels::Execution as Programs;
        match self {
            Execution::Fast => "fast".to_owned(),
            Execution::Programs(Programs::Chained) => "chained".to_owned(),
            Execution::Programs(Programs::Eager) => "eager".to_owned(),
            Execution::Programs(Programs::Strip(length)) => format!("strip:{length}"),
        }
    }

    /// How vector programs are run, where there are some.
    pub fn of_programs(self) -> stripmine_kernels::Execution {
        match self {
            Execution::Programs(execution) => execution,
            Execution::Fast => stripmine_kernels::Execution::Chained,
        }
    }
}

/// How motion follows from forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// Gear's predictor–corrector.
    Gear {
        /// Derivatives carried: 4, 5 or 6.
        values: usize,
    },
    /// Velocity Verlet.
    VelocityVerlet,
}

/// The integrator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Integrator {
    /// How motion follows from forces.
    pub scheme: Scheme,
    /// Time step (time).
    pub dt: f64,
    /// What becomes of a disc that moves farther in a step than contacts can be seen.
    pub on_long_step: OnLongStep,
}

/// What becomes of a disc that moves farther in a step than contacts can be seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OnLongStep {
    /// The run stops.
    #[default]
    Stop,
    /// It is counted.
    Count,
}

/// How long, and how often something is written (steps; 0 is never).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    /// Steps to do.
    pub steps: u64,
    /// Steps between rows of observables.
    pub thermo_every: u64,
    /// Steps between snapshots.
    pub snapshot_every: u64,
    /// Steps between checkpoints.
    pub checkpoint_every: u64,
}

/// Which files are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Output {
    /// Extended XYZ snapshots.
    pub trajectory: bool,
    /// LAMMPS dump snapshots.
    pub lammps_dump: bool,
    /// The final state as a LAMMPS data file.
    pub lammps_data: bool,
}

impl Scene {
    /// Reads a scene from its text; `file` is the name that errors give it, and start files are looked for beside it.
    ///
    /// # Errors
    /// [`SceneErrors`]: every mistake of the text.
    pub fn parse(file: &str, text: &str) -> Result<Scene, SceneErrors> {
        Document::parse(file, text, &[]).map(|document| document.scene)
    }

    /// Reads the scene that is a preset's name or a file's path.
    ///
    /// # Errors
    /// [`SceneErrors`]: neither preset nor readable file, or every mistake of the text.
    pub fn load(what: &str) -> Result<Scene, SceneErrors> {
        Document::load(what, &[]).map(|document| document.scene)
    }

    /// The scene with some values replaced, each given as `section.key=value`. An override takes the place of keys that
    /// exclude it, and of keys that another choice leaves without meaning.
    ///
    /// # Errors
    /// [`SceneErrors`]: every mistake of the overrides.
    pub fn with_overrides(&self, overrides: &[&str]) -> Result<Scene, SceneErrors> {
        let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
        Document::parse("scene", &self.to_toml(), &overrides).map(|document| document.scene)
    }

    /// The whole scene as TOML, defaults written out. Parsing it gives an equal scene.
    pub fn to_toml(&self) -> String {
        assemble::write(self)
    }

    /// Makes the discs and holds the scene against what the method demands.
    ///
    /// # Errors
    /// [`SceneErrors`]: every precondition that does not hold.
    pub fn check(&self) -> Result<Checked, SceneErrors> {
        Document::of(self.clone()).check()
    }

    /// The simulated time (time).
    pub fn duration(&self) -> f64 {
        self.run.steps as f64 * self.integrator.dt
    }
}
