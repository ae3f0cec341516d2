//! Observables of bodies: one list of quantities, each with its definition.

use super::conserved::ConservedQuantities;
use crate::method::QuantityKind::{Instant, Kept, Time};
use crate::method::observed::observables;
use crate::method::{MethodObservable, ObservedQuantity, quantities};

/// Observation of the system at a moment.
#[derive(Clone, Copy, Debug)]
pub(super) struct NbodyObservation {
    pub(super) time: f64,
    pub(super) conserved: ConservedQuantities,
    pub(super) energy_error: f64,
    pub(super) balance_error: f64,
    pub(super) half_mass_radius: f64,
}

impl NbodyObservation {
    /// Ratio of kinetic energy to the magnitude of the potential energy, which is never 0.
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

/// Observables, in the order of the columns.
pub(super) const OBSERVABLES: [MethodObservable<NbodyObservation>; 12] = observables! {
    "time", "time", Time, |seen| seen.time, "Time.";
    "kinetic", "energy", Instant, |seen| seen.conserved.kinetic, "Kinetic energy.";
    "potential", "energy", Instant, |seen| seen.conserved.potential, "Potential energy of the softened pairs.";
    "energy_error", "", Kept, |seen| seen.energy_error, "Relative energy error: the change of the energy since the start, over the larger of its magnitude and the kinetic energy at the start.";
    "virial_ratio", "", Instant, |seen| seen.virial_ratio(), "Virial ratio of kinetic energy to the magnitude of the potential energy: 0.5 in equilibrium.";
    "momentum", "mass·length/time", Kept, |seen| seen.momentum(), "Magnitude of the momentum.";
    "angular_momentum_x", "mass·length²/time", Kept, |seen| seen.conserved.angular_momentum[0], "Angular momentum about the origin, along x.";
    "angular_momentum_y", "mass·length²/time", Kept, |seen| seen.conserved.angular_momentum[1], "Angular momentum about the origin, along y.";
    "angular_momentum_z", "mass·length²/time", Kept, |seen| seen.conserved.angular_momentum[2], "Angular momentum about the origin, along z.";
    "centre", "length", Kept, |seen| length(seen.conserved.centre), "Distance of the centre of mass from the origin.";
    "balance_error", "energy", Kept, |seen| seen.balance_error, "Change of the energy since the start.";
    "half_mass_radius", "length", Instant, |seen| seen.half_mass_radius, "Radius around the centre of mass that contains half of the mass.";
};

/// Names, units and meanings of the observables.
pub(super) const QUANTITIES: &[ObservedQuantity] = &quantities(&OBSERVABLES);
