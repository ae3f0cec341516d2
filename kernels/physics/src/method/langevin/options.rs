//! The words of this method's keys.

use crate::words::define_words;

define_words! {
    /// How pairs are found.
    pub enum By {
        /// As is fastest.
        Auto = "auto",
        /// On a lattice of cells that are one particle's each.
        Lattice = "lattice",
        /// In sectors.
        Sectors = "sectors",
        /// In lists.
        NeighborList = "neighbor-list",
    }
}

define_words! {
    /// When particles are put in the order of their sectors.
    pub enum SortKind {
        /// As is cheaper: when needed, wherever both were measured.
        Auto = "auto",
        /// As soon as a quarter of them has changed sectors.
        WhenNeeded = "when-needed",
        /// At every step, as the source.
        EveryStep = "every-step",
    }
}

define_words! {
    /// The integrator.
    pub enum SchemeKind {
        /// Kick, drift, bath, drift, kick.
        Baoab = "baoab",
        /// The source's: velocity Verlet with the bath in the acceleration.
        Stochastic = "stochastic",
        /// The same with friction by the velocity of the step before, as the source prints it.
        AsPrinted = "as-printed",
    }
}

impl SchemeKind {
    /// Whether the kinetic energy is that of the velocities after the bath, which the predictor leaves. By baoab these have
    /// m⟨v²⟩ = kT but for higher orders than dt², exactly in a harmonic trap; those of the end of the step, half a kick later, have
    /// kT − dt²⟨F²⟩/(4 m), with ⟨F²⟩ = kT⟨U″⟩. By the source's scheme those of the end of the step have kT exactly in a trap.
    pub(super) fn is_observed_after_bath(self) -> bool {
        self == SchemeKind::Baoab
    }
}
