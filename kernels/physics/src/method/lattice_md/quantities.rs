//! What is observed of granular discs: one list of quantities, each with how it is read off what was seen.

use super::Totals;
use super::balance::Balance;
use crate::method::Kind::{Counter, Instant, Kept, Time};
use crate::method::observed::observables;
use crate::method::{Observable, Quantity, quantities};
use crate::observe::Observation;

/// All that is seen of a moment, once: rows, warnings, summary and closing words read the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Seen {
    /// What the discs and their contacts sum up to.
    pub(super) now: Observation,
    /// Where energy has come from and gone to.
    pub(super) balance: Balance,
    /// What has been counted and summed up since the start.
    pub(super) totals: Totals,
}

/// What is observed, in the order of the columns.
pub(super) const OBSERVABLES: [Observable<Seen>; 18] = observables! {
    "time", "time", Time, |seen| seen.now.time, "The time.";
    "kinetic", "energy", Instant, |seen| seen.now.kinetic, "Kinetic energy of the grains' translation.";
    "rotational", "energy", Instant, |seen| seen.now.rotational, "Kinetic energy of their rotation.";
    "elastic", "energy", Instant, |seen| seen.now.elastic, "Energy that contacts store.";
    "gravitational", "energy", Instant, |seen| seen.now.gravitational,
        "Potential energy in gravity, from the box's corner; jumps where a grain crosses a periodic side along gravity.";
    "dissipated", "energy", Counter, |seen| seen.balance.dissipated, "What contacts have turned into heat since the start.";
    "gravity_work", "energy", Counter, |seen| seen.balance.gravity_work, "What gravity has put in since the start.";
    "wall_work", "energy", Counter, |seen| seen.balance.wall_work, "What moving walls have put in since the start.";
    "balance_error", "energy", Kept, |seen| seen.balance.balance_error,
        "The energy that there is, less what there should be.";
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
        "Discs that moved farther in a step than contacts can be seen, summed over the steps.";
};

/// Their names, units and meanings.
pub(super) const QUANTITIES: &[Quantity] = &quantities(&OBSERVABLES);
