//! Bias of a step from a single run, for integrators that conserve a shadow energy.
//!
//! Such an integrator conserves H + h² H₂ up to higher powers of the step h, so the energy H of a run without friction and drive fluctuates as −h²
//! H₂. To leading order a mean of A at the step is that of short steps less β h² Cov(A, H₂), which is β Cov(A, H) along the run (Bond and Leimkuhler,
//! Acta Numerica 16, 2007). The statistical error falls with h², as the bias does.

use super::findings::{MeasuredConfiguration, SceneTrials};
use super::mean::TrialMean;
use stripmine_physics::averages::mean_of_independent;
use stripmine_physics::method::Trials;
use stripmine_physics::method::observed::find;

/// Stretches of a run over which covariances are taken, each about its own means: slow drift by rounding is no fluctuation.
const STRETCHES: usize = 16;
/// Fewest rows of a stretch.
const FEWEST: usize = 8;

impl SceneTrials<'_> {
    /// Bias of the configuration and step that the mean was measured with, and half the width of its 95 % interval (the quantity's unit). None where
    /// the integrator conserves no shadow energy, or energy enters or leaves.
    pub(super) fn shadow_bias(
        &self,
        configuration: &MeasuredConfiguration,
        mean: &TrialMean,
    ) -> Option<[f64; 2]> {
        let trials = self.case.entry.trials?;
        let keeps = trials.shadow?.integrators.contains(&self.choice(configuration).scheme()?.name);
        (keeps && configuration.label == mean.configuration).then(|| self.covariance(trials, mean)).flatten()
    }

    fn covariance(&self, trials: &Trials, mean: &TrialMean) -> Option<[f64; 2]> {
        let quantities = self.case.entry.quantities;
        let temperature = find(quantities, trials.shadow?.temperature).ok()?;
        let rows: Vec<Vec<f64>> =
            mean.rows.iter().filter(|row| row[0] >= mean.known.transient).cloned().collect();
        let balance = self.conserved_balance(&rows)?;
        let energies: Vec<f64> = rows.iter().map(|row| balance.energy(row)).collect();
        let twice = rows.iter().map(|row| row[temperature]).sum::<f64>() / rows.len() as f64;
        let values: Vec<f64> = rows.iter().map(|row| row[self.target.place]).collect();
        covariance(&values, &energies).map(|both| both.map(|value| value / twice))
    }
}

/// Covariance of two series, and half the width of its 95 % interval.
fn covariance(values: &[f64], others: &[f64]) -> Option<[f64; 2]> {
    let length = values.len() / STRETCHES;
    if length < FEWEST {
        return None;
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let stretches = values.chunks_exact(length).zip(others.chunks_exact(length)).map(|(values, others)| {
        let [value, other] = [values, others].map(mean);
        let products = values.iter().zip(others).map(|(a, b)| (a - value) * (b - other)).sum::<f64>();
        products / (length - 1) as f64
    });
    mean_of_independent(&stretches.collect::<Vec<_>>()).map(Into::into)
}
