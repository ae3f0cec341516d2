//! Energy drift along long runs. An integrator without a shadow energy loses or gains a little in every step, and the loss accumulates where nothing
//! drives or dissipates. A mean then changes with the length of its run, which pairs of short runs do not show.

use super::findings::{MeasuredConfiguration, SceneTrials};
use super::mean::TrialMean;
use crate::study::SettingChoice;
use crate::study::observed::{BalanceIndices, StudyQuantities};
use crate::study::trial::SampleSpan;
use stripmine_physics::averages::mean_of_independent;
use stripmine_physics::method::ChoiceEffect;

/// Share of the trial time for the drift of a configuration.
const SHARE: f64 = 0.03;
/// Stretches of each half of a run: the mean of the second half less that of the first, stretch by stretch, is half of the drift.
const STRETCHES: usize = 8;
/// Part of all moving energy that may enter or leave a conservative run.
const KEPT: f64 = 1e-9;

impl SceneTrials<'_> {
    /// For each integrator in use, returns its choice, its longest step (time), and the growth of its bias at that step.
    pub(super) fn bias_growths(
        &self,
        configurations: &[MeasuredConfiguration],
        mean: &TrialMean,
    ) -> Vec<(SettingChoice, f64, f64)> {
        let mut all: Vec<(SettingChoice, f64, f64)> = vec![];
        for configuration in configurations.iter().filter(|configuration| configuration.dropped.is_none()) {
            let choice = self.choice(configuration);
            let is_another = all.iter().all(|(other, ..)| !other.agrees_on(&choice, ChoiceEffect::Order));
            if let Some(step) = configuration.step.filter(|_| is_another) {
                all.push((choice, step, self.bias_growth(configuration, mean)));
            }
        }
        all
    }

    /// Growth of a bias at the longest step (the quantity's unit, per unit of time); 0 where energy enters or leaves, or no drift is significant.
    ///
    /// Energies, and with them temperature and pressure, change by the same part; a mean over the run changes by half of that.
    fn bias_growth(&self, configuration: &MeasuredConfiguration, mean: &TrialMean) -> f64 {
        let keeps_shadow = || {
            let integrators = self.case.entry.trials?.shadow?.integrators;
            Some(integrators.contains(&self.choice(configuration).scheme()?.name))
        };
        if keeps_shadow() != Some(false) || self.conserved_balance(&mean.rows).is_none() {
            return 0.0;
        }
        let own = |rows: &[Vec<f64>]| drift(&self.conserved_balance(rows)?, rows);
        let relative = match configuration.label == mean.configuration {
            true => own(&mean.rows),
            false => self
                .sample_over(configuration, configuration.step, SampleSpan::Seconds(SHARE * self.seconds))
                .ok()
                .and_then(|sample| own(&sample.rows)),
        };
        let seen = relative.filter(|[rate, bar]| rate.abs() > *bar);
        seen.map_or(0.0, |[rate, _]| 0.5 * rate.abs() * mean.known.mean.abs())
    }

    /// Returns the energy balance of a run without drive or dissipation: any imbalance is an error.
    pub(super) fn conserved_balance(&self, rows: &[Vec<f64>]) -> Option<BalanceIndices> {
        let balance =
            StudyQuantities::of(self.case.entry.trials?, self.case.entry.quantities).ok()?.balance?;
        let [first, last] = [rows.first()?, rows.last()?];
        let lost =
            balance.energy(last) - balance.energy(first) - (balance.error(last) - balance.error(first));
        let is_kept = lost.abs() <= KEPT * balance.energies(last) && balance.inputs(last) == 0.0;
        is_kept.then_some(balance)
    }
}

/// Relative energy drift per unit of time, and half the width of its 95 % interval.
fn drift(balance: &BalanceIndices, rows: &[Vec<f64>]) -> Option<[f64; 2]> {
    let length = rows.len() / (2 * STRETCHES);
    if length == 0 {
        return None;
    }
    let mean = |stretch: &[Vec<f64>]| {
        let sums =
            stretch.iter().fold([0.0; 2], |[time, off], row| [time + row[0], off + balance.error(row)]);
        sums.map(|sum| sum / stretch.len() as f64)
    };
    let stretches: Vec<[f64; 2]> = rows.chunks_exact(length).take(2 * STRETCHES).map(mean).collect();
    let (early, late) = stretches.split_at(STRETCHES);
    let rates: Vec<f64> = early.iter().zip(late).map(|(a, b)| (b[1] - a[1]) / (b[0] - a[0])).collect();
    let energies = balance.energies(rows.last()?);
    mean_of_independent(&rates).map(|it| <[f64; 2]>::from(it).map(|value| value / energies))
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_physics::method::METHODS;

    /// By hand: an error of −2·10⁻³ t, with an oscillation that averages out, of an energy of 4 at the end.
    #[test]
    fn drift_is_separated_from_oscillation() {
        let method = METHODS.iter().find(|it| it.trials.is_some_and(|it| it.shadow.is_some())).unwrap();
        let balance =
            StudyQuantities::of(method.trials.unwrap(), method.quantities).unwrap().balance.unwrap();
        let place = |name: &str| method.quantities.iter().position(|it| it.name == name).unwrap();
        let row = |at: usize, rate: f64| {
            let mut row = vec![0.0; method.quantities.len()];
            row[0] = at as f64;
            row[place("balance_error")] = rate * at as f64 + 0.1 * libm::sin(1.7 * at as f64);
            row[place("kinetic")] = 4.0;
            row
        };
        let of = |rate: f64| {
            let rows: Vec<Vec<f64>> = (0..1600).map(|at| row(at, rate)).collect();
            drift(&balance, &rows).unwrap()
        };
        let [rate, bar] = of(-2e-3);
        assert!((rate + 5e-4).abs() < bar && bar < 5e-5, "{rate} ± {bar}");
        let [rate, bar] = of(0.0);
        assert!(rate.abs() < bar, "{rate} ± {bar}");
    }
}
