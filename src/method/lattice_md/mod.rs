//! Lattice molecular dynamics of granular discs, BP93: every step is a sequence of vector programs over the discs and
//! over a lattice with at most one disc a cell.

mod arrays;
mod programs;

pub use arrays::{Arrays, Lengths};
pub use programs::{Part, StepProgram, ledger, programs};

use stripmine_kernels::integrator::gear::{Acceleration, Inertia};
use stripmine_kernels::isa::{Memory, ProgramError};
use stripmine_kernels::law::granular::{Contact, Disc};
use stripmine_kernels::mask::Mask;
use stripmine_kernels::sweep::lattice::{Coordinates, Frame, LatticeShape};
use stripmine_kernels::{Execution, InstructionSet};

/// How many derivatives Gear's scheme carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum GearValues {
    /// Third order; the most stable with damping.
    Four,
    /// Fourth order.
    Five,
    /// Fifth order.
    Six,
}

impl GearValues {
    /// All schemes.
    pub const ALL: [GearValues; 3] = [GearValues::Four, GearValues::Five, GearValues::Six];

    /// The number of values.
    pub const fn count(self) -> usize {
        match self {
            GearValues::Four => 4,
            GearValues::Five => 5,
            GearValues::Six => 6,
        }
    }
}

/// Whether discs differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Discs {
    /// All alike: radius, mass and inertia are numbers, not vectors.
    Equal {
        /// Radius and inverse mass.
        disc: Disc,
        /// Inverse moment of inertia.
        inverse_inertia: f64,
    },
    /// Each its own.
    Varying,
}

/// What is modelled: no more than a scene needs.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// The lattice.
    pub shape: LatticeShape,
    /// Where it lies.
    pub frame: Frame,
    /// The neighbourhood, met from both sides.
    pub mask: Mask,
    /// What positions on the lattice are measured from.
    pub coordinates: Coordinates,
    /// The contact law's parameters.
    pub contact: Contact,
    /// Whether there is friction, and with it rotation, torque and spin.
    pub friction: bool,
    /// Whether discs differ.
    pub discs: Discs,
    /// The integrator.
    pub values: GearValues,
    /// Time step (time).
    pub dt: f64,
    /// Acceleration of gravity (length/time²).
    pub gravity: [f64; 2],
}

impl Model {
    /// Degrees of freedom of a disc.
    pub fn freedoms(&self) -> usize {
        if self.friction { 3 } else { 2 }
    }

    /// Whether a damping makes the accelerations depend on velocities.
    pub fn acceleration(&self) -> Acceleration {
        let Contact { normal_damping, shear_damping, .. } = self.contact;
        let damped = normal_damping != 0.0 || (self.friction && shear_damping != 0.0);
        if damped { Acceleration::OfVelocities } else { Acceleration::OfPositions }
    }

    fn inertia(&self) -> Inertia {
        match self.discs {
            Discs::Equal { disc, inverse_inertia } => {
                Inertia::Equal { inverse_mass: disc.inverse_mass, inverse_inertia }
            }
            Discs::Varying => Inertia::Varying,
        }
    }
}

/// Runs the programs of some parts, in their order, on bound arrays.
///
/// # Errors
/// [`ProgramError`] if the memory does not suit a program; nothing of that program was executed.
pub fn execute(
    programs: &[StepProgram],
    parts: &[Part],
    memory: &Memory<'_>,
    lengths: &Lengths,
    execution: Execution,
    set: InstructionSet,
) -> Result<(), ProgramError> {
    for step in programs.iter().filter(|step| parts.contains(&step.part)) {
        step.program.run(memory, lengths.range(step.length), execution, set)?;
    }
    Ok(())
}
