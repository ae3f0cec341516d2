//! The words of this method's keys.

use crate::words::define_words;

define_words! {
    /// Where bodies start.
    pub enum StartKind {
        /// Two bodies on an ellipse, at the nearest point.
        Kepler = "kepler",
        /// Three on a figure of eight.
        FigureEight = "figure-eight",
        /// Plummer's sphere.
        Plummer = "plummer",
        /// A uniform sphere.
        Sphere = "sphere",
        /// A shell.
        Shell = "shell",
        /// Two Plummer spheres.
        TwoClusters = "two-clusters",
        /// As listed.
        List = "list",
    }
}

define_words! {
    /// What finds the forces.
    pub enum Engine {
        /// What is the cheapest for the number of bodies.
        Auto = "auto",
        /// Each pair once, in registers, on threads.
        Fast = "fast",
        /// Whole-array operations between bodies and those a shift behind them, for every shift: the source's vector machine.
        Programs = "programs",
        /// Pair by pair as the sum is written: the oracle.
        Reference = "reference",
    }
}

define_words! {
    /// How products and roots are formed.
    pub enum ArithmeticKind {
        /// Every operation rounded.
        Exact = "exact",
        /// Fused, with estimated roots that are corrected.
        Estimated = "estimated",
        /// Fused, with roots as the processor estimates them.
        Raw = "raw",
    }
}
