//! Error measures of a run.

use crate::study::state::ParticleState;
use serde::{Deserialize, Serialize};
use stripmine_physics::domain::Domain;

/// Error measure of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Measure {
    /// Root mean square distance of the particles from those of the reference (the method's length).
    Position,
    /// The largest such distance (the method's length).
    LargestPosition,
    /// Largest error of the energy balance over the samples (moving energy).
    Energy,
    /// Difference of the momentum from the reference's (sum of its magnitudes).
    Momentum,
    /// Difference of the angular momentum from the reference's (sum of its magnitudes).
    AngularMomentum,
}

impl Measure {
    pub(crate) const ALL: [Measure; 5] = [
        Measure::Position,
        Measure::LargestPosition,
        Measure::Energy,
        Measure::Momentum,
        Measure::AngularMomentum,
    ];

    /// Name with its unit.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Measure::Position => "position, RMS",
            Measure::LargestPosition => "position, largest",
            Measure::Energy => "energy balance (relative)",
            Measure::Momentum => "momentum (relative)",
            Measure::AngularMomentum => "angular momentum (relative)",
        }
    }
}

/// Errors of a run by measure, without those undefined in the scene.
pub(crate) type Errors = std::collections::BTreeMap<Measure, f64>;

/// Errors of a state compared with the reference's; distances are given in units of `length`.
pub(crate) fn errors(
    state: &ParticleState,
    reference: &ParticleState,
    (domain, length): (&Domain, f64),
    inertia: Option<f64>,
) -> Errors {
    let [rms, largest] = state.distance(reference, domain).map(|distance| distance / length);
    let mut errors = Errors::from([(Measure::Position, rms), (Measure::LargestPosition, largest)]);
    let (ours, (theirs, scale)) = (state.momentum().0, reference.momentum());
    if scale > 0.0 {
        errors.insert(Measure::Momentum, (ours[0] - theirs[0]).hypot(ours[1] - theirs[1]) / scale);
    }
    let angular = |state: &ParticleState| state.angular_momentum(domain, inertia);
    if let (Some((ours, _)), Some((theirs, scale))) = (angular(state), angular(reference))
        && scale > 0.0
    {
        errors.insert(Measure::AngularMomentum, (ours - theirs).abs() / scale);
    }
    errors
}
