//! What is observed of particles in a bath: one list of quantities, each with how it is read off what was seen.

use crate::method::Kind::{Counter, Instant, Time};
use crate::method::observed::observables;
use crate::method::{Observable, Quantity, quantities};

/// All that is seen of a moment, once.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    pub(super) time: f64,
    pub(super) kinetic: f64,
    pub(super) potential: f64,
    pub(super) temperature: f64,
    pub(super) pressure: f64,
    /// Mean square displacement.
    pub(super) msd: f64,
    pub(super) momentum: [f64; 2],
    pub(super) lost: u64,
}

/// What is observed, in the order of the columns.
pub(super) const OBSERVABLES: [Observable<Seen>; 10] = observables! {
    "time", "time", Time, |seen| seen.time, "The time.";
    "kinetic", "energy", Instant, |seen| seen.kinetic, "Kinetic energy; by baoab of the velocities after the bath, which have m⟨v²⟩ = kT but for higher orders than dt², where those of the end of the step, in trajectory.xyz, are low by dt²⟨F²⟩/(4 m).";
    "potential", "energy", Instant, |seen| seen.potential, "Energy of the pairs.";
    "temperature", "energy", Instant, |seen| seen.temperature, "Σ m v² over all 2 N degrees of freedom: a bath conserves no momentum. Without friction Σ m v² about the mean motion over 2 N − 2.";
    "pressure", "force/length", Instant, |seen| seen.pressure, "Pressure of the motion and of the pairs, over the area of the box.";
    "msd", "length²", Instant, |seen| seen.msd, "Mean square displacement since the start, by the positions as if there were no sides.";
    "rms", "length", Instant, |seen| seen.msd.sqrt(), "Its root.";
    "momentum_x", "mass·length/time", Instant, |seen| seen.momentum[0], "Momentum along x.";
    "momentum_y", "mass·length/time", Instant, |seen| seen.momentum[1], "Momentum along y.";
    "lost", "", Counter, |seen| seen.lost as f64, "Particles lost since the start.";
};

/// Their names, units and meanings.
pub(super) const QUANTITIES: &[Quantity] = &quantities(&OBSERVABLES);
