//! Words of this method's keys.

use crate::words::define_words;

define_words! {
    /// Pair search.
    pub enum PairSearchKind {
        /// The fastest search that the scene allows.
        Auto = "auto",
        /// Lattice of cells of one particle each.
        Lattice = "lattice",
        /// Sectors at least as wide as the cut-off.
        Sectors = "sectors",
        /// Neighbour lists.
        NeighborList = "neighbor-list",
    }
}

define_words! {
    /// Condition for sorting particles by sector.
    pub enum SortKind {
        /// The cheaper one: when needed, in all measured cases.
        Auto = "auto",
        /// Once a quarter of the particles has changed sectors.
        WhenNeeded = "when-needed",
        /// At every step, as in LAN17.
        EveryStep = "every-step",
    }
}

define_words! {
    /// Integrator.
    pub enum SchemeKind {
        /// Kick, drift, bath, drift, kick.
        Baoab = "baoab",
        /// LAN17's velocity Verlet with the bath in the acceleration.
        Stochastic = "stochastic",
        /// LAN17's scheme as printed, with friction by the velocity of the previous step.
        AsPrinted = "as-printed",
    }
}

impl SchemeKind {
    /// True if the kinetic energy uses the velocities after the bath, which the predictor leaves. With baoab these have m⟨v²⟩ = kT up to
    /// orders above dt², exactly in a harmonic trap. Those at the end of the step, half a kick later, have kT − dt²⟨F²⟩/(4 m), with
    /// ⟨F²⟩ = kT⟨U″⟩. With LAN17's scheme those at the end of the step have exactly kT in a trap.
    pub(super) fn is_observed_after_bath(self) -> bool {
        self == SchemeKind::Baoab
    }
}
