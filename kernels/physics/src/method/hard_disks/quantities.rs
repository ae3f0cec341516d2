//! What is observed of hard discs: one list of quantities, each with how it is read off what was seen.

use crate::method::Kind::{Counter, Instant, Interval, Kept, Time};
use crate::method::observed::observables;
use crate::method::{Clock, Observable, Quantity, quantities};

/// All that is seen of a moment, once.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    /// When, and after how many events.
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

/// What is observed, in the order of the columns.
pub(super) const OBSERVABLES: [Observable<Seen>; 13] = observables! {
    "time", "time", Time, |seen| seen.clock.time, "The time.";
    "events", "", Counter, |seen| seen.clock.events as f64, "Collisions since the start, of pairs and at walls.";
    "collisions", "", Counter, |seen| seen.collisions as f64, "Collisions of pairs since the start.";
    "kinetic", "energy", Instant, |seen| seen.kinetic, "Kinetic energy.";
    "gravitational", "energy", Instant, |seen| seen.gravitational, "Potential energy in gravity, from the box's lower corner.";
    "work", "energy", Counter, |seen| seen.work, "Energy that thermal and moving sides have put in since the start, less what collisions have turned into heat.";
    "energy_error", "", Kept, |seen| seen.energy_error, "Error of the energy by rounding: kinetic and gravitational energy less those of the start and less the work, over the larger of energy and kinetic energy at the start.";
    "temperature", "energy", Instant, |seen| seen.temperature, "Temperature kT: Σ m v² over the degrees of freedom. Along a periodic axis the mean motion is left out and N − 1 of N count; along a closed or open one, and above a thermal side, all N do. A single disc in a periodic box has none: NaN.";
    "momentum_x", "mass·length/time", Kept, |seen| seen.momentum[0], "Momentum along x.";
    "momentum_y", "mass·length/time", Kept, |seen| seen.momentum[1], "Momentum along y.";
    "virial", "mass·length²/time", Counter, |seen| seen.virial, "Impulse times distance of the centres, summed over the collisions since the start.";
    "compressibility", "", Interval, |seen| seen.compressibility, "Z = p A/(N kT) over the time since the row before: 1 + Δvirial/(2 N ∫ kT dt), with kT at every moment of it; 1 where no pair has collided, as in the first row. Under gravity a mean over rows that are shorter than a flight is not that over longer ones.";
    "collision_rate", "1/time", Interval, |seen| seen.collision_rate, "Collisions of a disc in a unit of time since the row before: twice the collisions of pairs over the discs; 0 in the first row.";
};

/// Their names, units and meanings.
pub(crate) const QUANTITIES: &[Quantity] = &quantities(&OBSERVABLES);
