//! Means over the second half of a run: of the quantities in the trials of a method, and of the density along each side.

use crate::study::Subject;
use crate::study::state::ParticleState;
use std::collections::BTreeMap;
use stripmine_physics::domain::Domain;
use stripmine_physics::method::Simulation;

/// Samples of a run after the first, which is taken before its first step.
pub(crate) const LOOKS: u64 = 64;
/// Bins of the density profile along each side.
const BINS: usize = 8;
/// Name of the density profile among the means.
const PROFILE: &str = "density profile";

/// Means of a run over time: a value for each observable, and the profile.
pub(crate) type ObservedMeans = BTreeMap<String, Vec<f64>>;

/// Running averages of a run.
pub(crate) struct RunningMeans<'s> {
    subject: &'s Subject,
    domain: Domain,
    looks: u64,
    pub(crate) means: ObservedMeans,
    /// Mean of the root mean square speed (length/time).
    pub speed: f64,
}

impl<'s> RunningMeans<'s> {
    /// Starts the averages of a run in a box.
    pub(super) fn new(subject: &'s Subject, domain: Domain) -> Self {
        RunningMeans { subject, domain, looks: 0, means: ObservedMeans::new(), speed: 0.0 }
    }

    /// Takes a sample with observed `values`; samples of the first half do not count.
    pub(super) fn look(&mut self, simulation: &dyn Simulation, values: &[f64]) {
        self.looks += 1;
        if self.looks <= LOOKS / 2 {
            return;
        }
        let observed =
            self.subject.watched().map(|watched| (watched.name.to_owned(), vec![values[watched.place]]));
        let state = ParticleState::of(&simulation.particles());
        let profile = profile(&state, &self.domain);
        let share = 1.0 / (LOOKS + 1 - LOOKS / 2) as f64;
        self.speed += share * state.speed();
        for (name, values) in observed.chain([(PROFILE.to_owned(), profile)]) {
            let sum = self.means.entry(name).or_insert_with(|| vec![0.0; values.len()]);
            sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += share * value);
        }
    }
}

/// True if these can be means of a run of the scene: the right names, each with the right number of values, all finite.
pub(crate) fn are_means_of(subject: &Subject, means: &ObservedMeans) -> bool {
    let expected: BTreeMap<&str, usize> =
        subject.watched().map(|watched| (watched.name, 1)).chain([(PROFILE, 2 * BINS)]).collect();
    means.iter().map(|(name, values)| (name.as_str(), values.len())).eq(expected)
        && means.values().flatten().all(|value| value.is_finite())
}

/// Density profile: share of the particles in each bin, along one side of the box and then the other, times the number of bins; 1 where uniform.
fn profile(state: &ParticleState, domain: &Domain) -> Vec<f64> {
    let mut bins = vec![0.0; 2 * BINS];
    for position in state.positions() {
        let inside = domain.wrapped(position);
        for axis in 0..2 {
            let place = (inside[axis] - domain.origin[axis]) / domain.length(axis);
            let bin = ((place * BINS as f64).max(0.0) as usize).min(BINS - 1);
            bins[axis * BINS + bin] += BINS as f64 / state.len().max(1) as f64;
        }
    }
    bins
}
