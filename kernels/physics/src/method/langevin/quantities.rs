//! Observables of Langevin dynamics: one list of quantities, each with its definition.

use crate::method::QuantityKind::{Counter, Instant, Time};
use crate::method::observed::observables;
use crate::method::{MethodObservable, ObservedQuantity, quantities};

/// Observation of the system at a moment.
#[derive(Clone, Copy, Debug)]
pub(super) struct LangevinObservation {
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

/// Observables, in the order of the columns.
pub(super) const OBSERVABLES: [MethodObservable<LangevinObservation>; 10] = observables! {
    "time", "time", Time, |seen| seen.time, "Time.";
    "kinetic", "energy", Instant, |seen| seen.kinetic, "Kinetic energy. With baoab it uses the velocities after the bath, which have m⟨v²⟩ = kT up to orders above dt²; those at the end of the step, in trajectory.xyz, are too low by dt²⟨F²⟩/(4 m).";
    "potential", "energy", Instant, |seen| seen.potential, "Potential energy of the pairs.";
    "temperature", "energy", Instant, |seen| seen.temperature, "Temperature kT: Σ m v² over all 2 N degrees of freedom, since a bath does not conserve momentum. Without friction: Σ m v² about the mean motion over 2 N − 2.";
    "pressure", "force/length", Instant, |seen| seen.pressure, "Pressure: kinetic and pair contributions over the area of the box.";
    "msd", "length²", Instant, |seen| seen.msd, "Mean square displacement since the start, from unwrapped positions.";
    "rms", "length", Instant, |seen| seen.msd.sqrt(), "Root mean square displacement since the start.";
    "momentum_x", "mass·length/time", Instant, |seen| seen.momentum[0], "Momentum along x.";
    "momentum_y", "mass·length/time", Instant, |seen| seen.momentum[1], "Momentum along y.";
    "lost", "", Counter, |seen| seen.lost as f64, "Particles lost since the start.";
};

/// Names, units and meanings of the observables.
pub(super) const QUANTITIES: &[ObservedQuantity] = &quantities(&OBSERVABLES);
