//! What is observed of bodies: one list of quantities, each with how it is read off what was seen.

use super::conserved::Conserved;
use crate::method::Kind::{Instant, Kept, Time};
use crate::method::observed::observables;
use crate::method::{Observable, Quantity, quantities};

/// All that is seen of a moment, once.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    pub(super) time: f64,
    pub(super) conserved: Conserved,
    pub(super) energy_error: f64,
    pub(super) balance_error: f64,
    pub(super) half_mass_radius: f64,
}

impl Seen {
    /// Kinetic energy over the magnitude of the potential energy; any two bodies attract each other.
    pub(super) fn virial_ratio(&self) -> f64 {
        self.conserved.kinetic / self.conserved.potential.abs()
    }

    /// Magnitude of the momentum.
    pub(super) fn momentum(&self) -> f64 {
        length(self.conserved.momentum)
    }
}

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// What is observed, in the order of the columns.
pub(super) const OBSERVABLES: [Observable<Seen>; 12] = observables! {
    "time", "time", Time, |seen| seen.time, "The time.";
    "kinetic", "energy", Instant, |seen| seen.conserved.kinetic, "Kinetic energy.";
    "potential", "energy", Instant, |seen| seen.conserved.potential, "Energy of the softened pairs.";
    "energy_error", "", Kept, |seen| seen.energy_error, "The energy less that of the start, over the larger of its magnitude and the kinetic energy at the start.";
    "virial_ratio", "", Instant, |seen| seen.virial_ratio(), "Kinetic energy over the magnitude of the potential energy: 0.5 in equilibrium.";
    "momentum", "mass·length/time", Kept, |seen| seen.momentum(), "Magnitude of the momentum.";
    "angular_momentum_x", "mass·length²/time", Kept, |seen| seen.conserved.angular_momentum[0], "Angular momentum about the origin, along x.";
    "angular_momentum_y", "mass·length²/time", Kept, |seen| seen.conserved.angular_momentum[1], "The same along y.";
    "angular_momentum_z", "mass·length²/time", Kept, |seen| seen.conserved.angular_momentum[2], "The same along z.";
    "centre", "length", Kept, |seen| length(seen.conserved.centre), "Distance of the centre of mass from the origin.";
    "balance_error", "energy", Kept, |seen| seen.balance_error, "The energy less that of the start.";
    "half_mass_radius", "length", Instant, |seen| seen.half_mass_radius, "Distance from the centre of mass within which half of the mass is.";
};

/// Their names, units and meanings.
pub(super) const QUANTITIES: &[Quantity] = &quantities(&OBSERVABLES);
