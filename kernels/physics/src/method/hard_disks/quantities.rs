//! Observables of hard discs: one list of quantities, each with its definition.

use crate::method::QuantityKind::{Counter, Instant, Interval, Kept, Time};
use crate::method::observed::observables;
use crate::method::{Clock, MethodObservable, ObservedQuantity, quantities};

/// Observation of the system at a moment.
#[derive(Clone, Copy, Debug)]
pub(super) struct HardDiskObservation {
    /// Time and number of events.
    pub(super) clock: Clock,
    /// Collisions of pairs.
    pub(super) collisions: u64,
    pub(super) kinetic: f64,
    pub(super) gravitational: f64,
    pub(super) work: f64,
    pub(super) energy_error: f64,
    pub(super) temperature: f64,
    pub(super) momentum: [f64; 2],
    pub(super) virial: f64,
    pub(super) compressibility: f64,
    pub(super) collision_rate: f64,
}

/// Observables, in the order of the columns.
pub(super) const OBSERVABLES: [MethodObservable<HardDiskObservation>; 13] = observables! {
    "time", "time", Time, |seen| seen.clock.time, "Time.";
    "events", "", Counter, |seen| seen.clock.events as f64, "Collisions since the start, of pairs and at walls.";
    "collisions", "", Counter, |seen| seen.collisions as f64, "Collisions of pairs since the start.";
    "kinetic", "energy", Instant, |seen| seen.kinetic, "Kinetic energy.";
    "gravitational", "energy", Instant, |seen| seen.gravitational, "Potential energy under gravity, zero at the lower corner of the box.";
    "work", "energy", Counter, |seen| seen.work, "Energy put in by thermal and moving sides since the start, less the energy lost in collisions.";
    "energy_error", "", Kept, |seen| seen.energy_error, "Relative energy error due to rounding: kinetic and gravitational energy, less those at the start and less the work, over the larger of total and kinetic energy at the start.";
    "temperature", "energy", Instant, |seen| seen.temperature, "Temperature kT: Σ m v² over the degrees of freedom. Along a periodic axis the mean motion is subtracted and N − 1 degrees of freedom count; along a closed or open axis, and with a thermal side, all N do. NaN for a single disc in a periodic box.";
    "momentum_x", "mass·length/time", Kept, |seen| seen.momentum[0], "Momentum along x.";
    "momentum_y", "mass·length/time", Kept, |seen| seen.momentum[1], "Momentum along y.";
    "virial", "mass·length²/time", Counter, |seen| seen.virial, "Impulse times distance of the centres, summed over the collisions since the start.";
    "compressibility", "", Interval, |seen| seen.compressibility, "Z = p A/(N kT) since the previous row: 1 + Δvirial/(2 N ∫ kT dt), with kT integrated over the interval; 1 if no pair has collided, as in the first row. Under gravity, the mean over rows shorter than a flight differs from that over longer rows.";
    "collision_rate", "1/time", Interval, |seen| seen.collision_rate, "Collisions per disc and unit of time since the previous row: twice the collisions of pairs over the number of discs; 0 in the first row.";
};

/// Names, units and meanings of the observables.
pub(crate) const QUANTITIES: &[ObservedQuantity] = &quantities(&OBSERVABLES);
