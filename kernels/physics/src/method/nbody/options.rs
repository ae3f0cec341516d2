//! Words of this method's keys.

use crate::words::define_words;

define_words! {
    /// Initial state of the bodies.
    pub enum StartKind {
        /// Two bodies on an ellipse, at the nearest point.
        Kepler = "kepler",
        /// Three bodies on the figure of eight.
        FigureEight = "figure-eight",
        /// Plummer's sphere.
        Plummer = "plummer",
        /// Uniform sphere.
        Sphere = "sphere",
        /// Spherical shell.
        Shell = "shell",
        /// Two Plummer spheres.
        TwoClusters = "two-clusters",
        /// Listed bodies.
        List = "list",
        /// Bodies of a start file.
        File = "file",
    }
}

define_words! {
    /// Engine that calculates the forces.
    pub enum ForceEngine {
        /// The cheapest engine for the number of bodies.
        Auto = "auto",
        /// Sweep that visits each pair once, in registers and on threads.
        Fast = "fast",
        /// Whole-array operations between all bodies and those shifted by an offset, for every shift: PWP's vector machine.
        Programs = "programs",
        /// Direct sum, pair by pair: the oracle.
        Reference = "reference",
    }
}

define_words! {
    /// Rounding of products and roots.
    pub enum ArithmeticKind {
        /// Every operation is rounded.
        Exact = "exact",
        /// Fused operations, with estimated roots that are corrected.
        Estimated = "estimated",
        /// Fused operations, with the processor's uncorrected estimate of roots.
        Raw = "raw",
    }
}
