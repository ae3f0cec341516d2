//! What is observed of hard discs: one list of quantities, each with how it is read off what was seen.

use crate::method::Kind::{Counter, Instant, Kept, SinceStart, Time};
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
    pub(super) energy_error: f64,
    pub(super) temperature: f64,
    pub(super) momentum: [f64; 2],
    pub(super) virial: f64,
    pub(super) compressibility: f64,
    pub(super) collision_rate: f64,
}

/// What is observed, in the order of the columns.
pub(super) const OBSERVABLES: [Observable<Seen>; 11] = observables! {
    "time", "time", Time, |seen| seen.clock.time, "The time.";
    "events", "", Counter, |seen| seen.clock.events as f64, "Collisions since the start, of pairs and at walls.";
    "collisions", "", Counter, |seen| seen.collisions as f64, "Collisions of pairs since the start.";
    "kinetic", "energy", Instant, |seen| seen.kinetic, "Kinetic energy.";
    "energy_error", "", Kept, |seen| seen.energy_error, "The kinetic energy less that of the start, over that of the start: rounding where all collisions are elastic.";
    "temperature", "energy", Instant, |seen| seen.temperature, "Kinetic energy a disc and dimension, about the mean motion: over N, also where momentum is conserved and 2 N − 2 degrees of freedom move; the temperature of these is N/(N − 1) times it.";
    "momentum_x", "mass·length/time", Kept, |seen| seen.momentum[0], "Momentum along x.";
    "momentum_y", "mass·length/time", Kept, |seen| seen.momentum[1], "Momentum along y.";
    "virial", "mass·length²/time", Counter, |seen| seen.virial, "Impulse times distance of the centres, summed over the collisions since the start.";
    "compressibility", "", SinceStart { ideal: 1.0, over: Some("temperature") }, |seen| seen.compressibility, "Z = p A/(N kT): 1 + virial/(2 N kT t) since the start, with the temperature as it is.";
    "collision_rate", "1/time", SinceStart { ideal: 0.0, over: None }, |seen| seen.collision_rate, "Collisions of a disc in a unit of time since the start: twice the collisions of pairs over the discs.";
};

/// Their names, units and meanings.
pub const QUANTITIES: &[Quantity] = &quantities(&OBSERVABLES);
