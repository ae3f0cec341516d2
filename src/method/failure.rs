//! What stops a method, with what a user needs to find out why.

use crate::reported::{Class, Reported};
use std::fmt;
use stripmine_kernels::isa::ProgramError;
use stripmine_kernels::sweep::fast::GridError;

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
        "step {step}: {count} discs have a position or force that is no finite number, first {first}\n  \
         help: the time step is too large for the stiffness or the damping: halve dt, or use fewer Gear values"
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
        "step {step}: {count} discs left the box, first {first}\n  help: a wall was passed or the time step is too large: \
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
         cell\n  help: the discs overlap too deeply (stiffen the contacts), or the cells are too large (set search.cell_edge \
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
         law.stop_penetration = {limit}\n  help: the contacts are too soft for these weights and speeds: raise law.stiffness \
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
    /// A disc that moved so far in a step that it may have passed through another unseen.
    #[error(
        "step {step}: {count} discs moved farther than {limit:.6} in the step, first {first}; contacts deeper than \
         law.max_penetration could pass unseen between two steps\n  help: lower dt to {dt:.4e}, slow the discs, or set \
         integrator.on_long_step = \"count\""
    )]
    LongStep {
        /// The step.
        step: u64,
        /// How many.
        count: u64,
        /// The first.
        first: Culprit,
        /// How far a disc may move (length).
        limit: f64,
        /// A step in which the first would move as far (time).
        dt: f64,
    },
    /// Sums over all discs that no number holds.
    #[error(
        "step {step}: {quantity} is {value}, which is no finite number\n  help: the units make masses, speeds or stiffness too large \
         for double precision; choose units in which they are nearer to 1"
    )]
    Overflow {
        /// The step.
        step: u64,
        /// What was summed up.
        quantity: &'static str,
        /// What came out.
        value: f64,
    },
    /// Sectors do not fit the box.
    #[error("{0}\n  help: take more discs, a smaller search.skin, or search.by = \"lattice\"")]
    NoSectors(#[from] GridError),
    /// The machine refused a program.
    #[error(transparent)]
    Machine(#[from] ProgramError),
}

impl Failure {
    /// What broke, when, and which particles.
    pub fn what(&self) -> String {
        self.parts().0
    }

    /// What to do about it.
    pub fn remedy(&self) -> Option<String> {
        self.parts().1
    }

    fn parts(&self) -> (String, Option<String>) {
        let text = self.to_string();
        match text.split_once(HELP) {
            Some((what, remedy)) => (what.to_owned(), Some(remedy.to_owned())),
            None => (text, None),
        }
    }
}

/// What stands between what broke and what to do about it.
const HELP: &str = "\n  help: ";

impl Reported for Failure {
    fn class(&self) -> Class {
        Class::Precondition
    }
}
