//! Words of this method's keys.

use crate::words::{define_words, words_for};
use stripmine_kernels::law::granular::ContactArm;
use stripmine_kernels::law::spring::Spring;
use stripmine_kernels::sweep::lattice::Coordinates;

words_for!(Spring { Hertz = "granular", Linear = "linear", });
words_for!(ContactArm { Radius = "radius", Overlap = "overlap", Lammps = "lammps", });
words_for!(Coordinates { CellRelative = "cell-relative", Absolute = "absolute", });

define_words! {
    /// Distribution of mass in a disc.
    pub enum Inertia {
        /// Uniform over the area: ½ m R².
        Disc = "disc",
        /// Sphere: ⅖ m R².
        Sphere = "sphere",
    }
}

impl Inertia {
    /// I/(m R²).
    pub(crate) fn factor(self) -> f64 {
        match self {
            Inertia::Disc => 0.5,
            Inertia::Sphere => 0.4,
        }
    }
}

define_words! {
    /// Search for contacts.
    pub enum SearchKind {
        /// The fastest.
        Auto = "auto",
        /// On the exclusive lattice.
        Lattice = "lattice",
        /// In sectors that hold any number of discs.
        Sectors = "sectors",
        /// By neighbour lists.
        NeighborList = "neighbor-list",
    }
}

define_words! {
    /// Engine that steps the discs.
    pub enum EngineChoice {
        /// The fastest.
        Auto = "auto",
        /// Visits each pair once and evaluates the law for contacts only.
        Fast = "fast",
        /// Vector programs over the whole lattice, as in BP93.
        Programs = "programs",
    }
}

define_words! {
    /// Version of the programs.
    pub enum ProgramVersion {
        /// Ours: only what a scene needs, positions relative to the cell, checks among the equations.
        Ours = "ours",
        /// Printed in BP93: Index, Test and contact_i, unscaled Gear derivatives.
        Printed = "printed",
    }
}

define_words! {
    /// Integrator.
    pub enum IntegratorKind {
        /// Gear's predictor–corrector.
        Gear = "gear",
        /// Velocity Verlet.
        VelocityVerlet = "velocity-verlet",
    }
}
