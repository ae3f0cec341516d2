//! Observed quantities of granular discs, each with the function that evaluates it.

use super::GranularTotals;
use super::balance::EnergyBalance;
use crate::method::QuantityKind::{Counter, Instant, Kept, Time};
use crate::method::observed::observables;
use crate::method::{MethodObservable, ObservedQuantity, quantities};
use crate::observe::Observation;

/// Observation of a moment, made once: rows, warnings, summary and closing words read the same data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GranularObservation {
    /// Sums over the discs and their contacts.
    pub(super) now: Observation,
    /// Energy balance.
    pub(super) balance: EnergyBalance,
    /// Counts and sums since the start.
    pub(super) totals: GranularTotals,
}

/// Observables, in the order of the columns.
pub(super) const OBSERVABLES: [MethodObservable<GranularObservation>; 18] = observables! {
    "time", "time", Time, |seen| seen.now.time, "The time.";
    "kinetic", "energy", Instant, |seen| seen.now.kinetic, "Kinetic energy of the grains' translation.";
    "rotational", "energy", Instant, |seen| seen.now.rotational, "Kinetic energy of their rotation.";
    "elastic", "energy", Instant, |seen| seen.now.elastic, "Elastic energy of the contacts.";
    "gravitational", "energy", Instant, |seen| seen.now.gravitational,
        "Potential energy in gravity, from the box's corner; jumps where a grain crosses a periodic side along gravity.";
    "dissipated", "energy", Counter, |seen| seen.balance.dissipated, "Energy dissipated in contacts since the start.";
    "gravity_work", "energy", Counter, |seen| seen.balance.gravity_work, "Work of gravity since the start.";
    "wall_work", "energy", Counter, |seen| seen.balance.wall_work, "Work of moving walls since the start.";
    "balance_error", "energy", Kept, |seen| seen.balance.balance_error,
        "Balance error: actual minus expected energy.";
    "momentum_x", "mass·length/time", Kept, |seen| seen.now.momentum_x, "Momentum of the grains along x.";
    "momentum_y", "mass·length/time", Kept, |seen| seen.now.momentum_y, "Momentum of the grains along y.";
    "temperature", "energy", Instant, |seen| seen.now.temperature,
        "Σ m v² over the degrees of freedom: about the mean motion and over N − 1 along periodic axes, over N along the others; NaN for a single grain in a periodic box.";
    "pressure", "force/length", Instant, |seen| seen.now.pressure,
        "Pressure of the grains over the area of the whole box: their kinetic energy about the mean motion along periodic axes, and the virial of the contacts between them.";
    "flow", "length/time", Instant, |seen| seen.now.flow,
        "Mean velocity of the grains along gravity, or along x without gravity.";
    "deepest_penetration", "", Instant, |seen| seen.now.deepest_penetration,
        "The deepest contact, as a fraction of the sum of the radii.";
    "contacts", "", Instant, |seen| seen.now.contacts as f64, "Contacts with at least one grain.";
    "deep_disc_steps", "", Counter, |seen| seen.totals.deep_disc_steps as f64,
        "Grains in contacts deeper than law.max_penetration, summed over the steps.";
    "long_steps", "", Counter, |seen| seen.totals.long_steps as f64,
        "Discs that moved so far in a step that contacts may be missed, summed over the steps.";
};

/// Names, units and meanings of the observables.
pub(super) const QUANTITIES: &[ObservedQuantity] = &quantities(&OBSERVABLES);
