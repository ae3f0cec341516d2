//! What stops a method, with what a user needs to find out why.

use std::fmt;
use stripmine_kernels::isa::ProgramError;

/// A particle that a failure names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Culprit {
    /// Its id.
    pub id: u32,
    /// Where it is (length).
    pub position: [f64; 2],
    /// How fast (length/time).
    pub velocity: [f64; 2],
}

impl fmt::Display for Culprit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Culprit { id, position: [x, y], velocity: [vx, vy] } = self;
        write!(f, "disc {id} at ({x:.9}, {y:.9}) with velocity ({vx:.4e}, {vy:.4e})")
    }
}

/// The physics broke a precondition of the method. Found in the step in which it happens.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Failure {
    /// Positions or forces that are no numbers.
    #[error(
        "step {step}: {count} discs have a position or force that is no finite number, first {first}; \
         the time step is too large for the stiffness or the damping: halve dt, or use fewer Gear values"
    )]
    NotFinite {
        /// The step.
        step: u64,
        /// How many.
        count: u64,
        /// The first.
        first: Culprit,
    },
    /// Discs outside a closed side, or more than a period outside a periodic one.
    #[error(
        "step {step}: {count} discs left the box, first {first}; a wall was passed or the time step is too large: \
         use larger or stiffer wall discs, slower grains, or a smaller dt"
    )]
    OutOfBox {
        /// The step.
        step: u64,
        /// How many.
        count: u64,
        /// The first.
        first: Culprit,
    },
    /// Two discs in one cell: the lattice would lose one.
    #[error(
        "step {step}: {first} and {second} are in one cell, {distance:.6} apart; the exclusive lattice holds one disc a \
         cell: the discs overlap too deeply (stiffen the contacts), or the cells are too large (set method.cell_edge \
         towards the largest radius)"
    )]
    Conflict {
        /// The step.
        step: u64,
        /// One disc.
        first: Culprit,
        /// The other.
        second: Culprit,
        /// Distance of their centres (length).
        distance: f64,
    },
    /// A contact deeper than the scene allows.
    #[error(
        "step {step}: {first} and {second} overlap by {penetration:.4} of the sum of their radii, more than \
         law.stop_penetration = {limit}; the contacts are too soft for these weights and speeds: raise law.stiffness \
         (and lower dt), or slow the discs"
    )]
    TooDeep {
        /// The step.
        step: u64,
        /// One disc.
        first: Culprit,
        /// The other.
        second: Culprit,
        /// ξ/(R_i + R_j).
        penetration: f64,
        /// The limit.
        limit: f64,
    },
    /// Sectors meet themselves across a periodic side.
    #[error(
        "a periodic side of the box has no room for three sectors as wide as a contact and the skin reach; take more \
         discs, a smaller method.skin, or method.kind = \"lattice\""
    )]
    NoRoomForSectors,
    /// The machine refused a program.
    #[error(transparent)]
    Machine(#[from] ProgramError),
}
