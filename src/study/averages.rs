//! Means over the second half of a run: of the quantities that a method states, and of the density along each side.

use super::state::State;
use super::subject::Subject;
use std::collections::BTreeMap;
use stripmine_physics::domain::Domain;
use stripmine_physics::method::Simulation;

/// Looks of a run; means are over the second half.
pub const LOOKS: u64 = 64;
/// Bins of the density profile along each side.
const BINS: usize = 8;
/// The name of the density profile among the means.
pub const PROFILE: &str = "density profile";

/// Means over time of a run: a value for each observable, and the profile.
pub type Means = BTreeMap<String, Vec<f64>>;

/// Means in the making.
pub struct Averages<'s> {
    subject: &'s Subject,
    domain: Domain,
    looks: u64,
    means: Means,
    speed: f64,
}

impl<'s> Averages<'s> {
    /// Of a run in a box, before the first of its [`LOOKS`] + 1 looks.
    pub fn new(subject: &'s Subject, domain: Domain) -> Self {
        Averages { subject, domain, looks: 0, means: Means::new(), speed: 0.0 }
    }

    /// Whether the next look counts.
    pub fn are_due(&self) -> bool {
        self.looks >= LOOKS / 2
    }

    /// Takes a look that does not count.
    pub fn pass(&mut self) {
        self.looks += 1;
    }

    /// Takes a look that counts, at which `values` were observed.
    pub fn add(&mut self, simulation: &dyn Simulation, values: &[f64]) {
        self.looks += 1;
        let has_seeds = self.subject.prepared.seed.is_some();
        let means = self.subject.observed.means.iter().filter(|watched| has_seeds || !watched.fluctuates);
        let observed = means.map(|watched| (watched.name.to_owned(), vec![values[watched.place]]));
        let state = State::of(&simulation.particles());
        let profile = profile(&state, &self.domain);
        let share = 1.0 / (LOOKS + 1 - LOOKS / 2) as f64;
        self.speed += share * state.speed();
        for (name, values) in observed.chain([(PROFILE.to_owned(), profile)]) {
            let sum = self.means.entry(name).or_insert_with(|| vec![0.0; values.len()]);
            sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += share * value);
        }
    }

    /// The mean of the root mean square speed (length/time), after the last look: what mean velocities are held against.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// The means, after the last look.
    pub fn means(self) -> Means {
        self.means
    }
}

/// Whether these are means of a run of the scene: all of them, each with as many values as it has, and these are numbers.
pub fn are_of(subject: &Subject, means: &Means) -> bool {
    let has_seeds = subject.prepared.seed.is_some();
    let watched = subject.observed.means.iter().filter(|watched| has_seeds || !watched.fluctuates);
    let expected: BTreeMap<&str, usize> =
        watched.map(|watched| (watched.name, 1)).chain([(PROFILE, 2 * BINS)]).collect();
    means.iter().map(|(name, values)| (name.as_str(), values.len())).eq(expected)
        && means.values().flatten().all(|value| value.is_finite())
}

/// The share of the particles in each bin, along one side of the box and then the other, times the bins: 1 where they are even.
fn profile(state: &State, domain: &Domain) -> Vec<f64> {
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
