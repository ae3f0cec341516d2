//! The words of this method's keys.

use crate::words::{define_words, words_for};
use stripmine_kernels::law::granular::ContactArm;
use stripmine_kernels::law::spring::Spring;
use stripmine_kernels::sweep::lattice::Coordinates;

words_for!(Spring { Hertz = "granular", Linear = "linear", });
words_for!(ContactArm { Radius = "radius", Overlap = "overlap", Lammps = "lammps", });
words_for!(Coordinates { CellRelative = "cell-relative", Absolute = "absolute", });

define_words! {
    /// How mass is distributed in a disc.
    pub enum Inertia {
        /// Evenly over the area: ½ m R².
        Disc = "disc",
        /// As in a sphere: ⅖ m R².
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
    /// How contacts are found.
    pub enum By {
        /// As is fastest.
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
    /// What steps the discs.
    pub enum EngineChoice {
        /// As is fastest.
        Auto = "auto",
        /// Each pair once, the law for contacts only.
        Fast = "fast",
        /// Vector programs over the whole lattice, as the source has it.
        Programs = "programs",
    }
}

define_words! {
    /// Whose programs are run.
    pub enum ProgramText {
        /// Ours: no more than a scene needs, positions relative to the cell, checks among the equations.
        Ours = "ours",
        /// The source's own, as printed: Index, Test and contact_i, Gear's derivatives as they are.
        Printed = "printed",
    }
}

define_words! {
    /// A kind of integrator.
    pub enum IntegratorKind {
        /// Gear's predictor–corrector.
        Gear = "gear",
        /// Velocity Verlet.
        VelocityVerlet = "velocity-verlet",
    }
}
