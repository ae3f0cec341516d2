//! Comparison of the mean from another start with that from the scene's own.

use super::findings::{MeasuredConfiguration, SceneTrials};
use super::mean::TrialMean;
use crate::study::trial::{MeanEstimate, RowPace, SampleSpan, values};
use stripmine_physics::averages::{Average, AverageOutcome, AveragedRows};
use stripmine_physics::method::ObservedQuantity;
use stripmine_physics::scene::SEED;

/// Means of two starts differ if they are this many error bars apart: about three standard errors.
const SURE: f64 = 1.5;

impl SceneTrials<'_> {
    /// Returns the mean from another start less that from the scene's own, if it exceeds both error bars.
    ///
    /// Noise may hide the end of a transient in one of the two runs. Means that differ are therefore compared again after the later transient.
    pub(super) fn starts_differ(
        &self,
        configuration: &MeasuredConfiguration,
        mean: &mut TrialMean,
    ) -> Option<f64> {
        // Whole runs have different starts anyway.
        let seed = self.case.prepared.seed.filter(|_| self.whole.is_none())?;
        let another = MeasuredConfiguration {
            overrides: configuration.overrides.clone().set(&SEED, seed.wrapping_add(1)),
            ..configuration.clone()
        };
        let sample = self
            .sample_over(&another, configuration.step, SampleSpan::Seconds(self.shares[4] * self.seconds))
            .ok()?;
        let mut other = sample.known()?;
        if differ(&mean.known, &other) {
            let observed = (self.case.quantities(), self.target.place);
            let later = mean.known.transient.max(other.transient);
            // A run that ends before that gives no mean.
            other = mean_after(&sample.rows, observed, (&other, sample.pace()), later)?;
            let pace = sample.pace().map(|_| RowPace { cost: mean.cost, row: mean.row });
            mean.known = mean_after(&mean.rows, observed, (&mean.known, pace), later).unwrap_or(mean.known);
            mean.transients = vec![mean.known.transient];
        }
        mean.transients.push(other.transient);
        differ(&mean.known, &other).then_some(other.mean - mean.known.mean)
    }
}

/// True if two means differ by more than both error bars.
fn differ(one: &MeanEstimate, other: &MeanEstimate) -> bool {
    (one.mean - other.mean).abs() > SURE * one.bar.hypot(other.bar)
}

/// Returns the mean over the rows after a time, or the known mean if its transient already ends later; none if the remaining rows have no mean.
fn mean_after(
    rows: &[Vec<f64>],
    (quantities, place): (&'static [ObservedQuantity], usize),
    (known, pace): (&MeanEstimate, Option<RowPace>),
    time: f64,
) -> Option<MeanEstimate> {
    if known.transient >= time {
        return Some(*known);
    }
    let mut later = AveragedRows::new(quantities);
    rows.iter().filter(|row| row[0] >= time).for_each(|row| later.add(row));
    match Average::of(&later, place).outcome {
        AverageOutcome::Mean(estimate) => {
            let values = values(rows, place, &later.time_series(place), pace.is_some());
            Some(MeanEstimate::of(estimate, &values, pace))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_physics::method::QuantityKind;

    const OBSERVED: &[ObservedQuantity] = &[
        ObservedQuantity { name: "time", unit: "time", kind: QuantityKind::Time, doc: "" },
        ObservedQuantity { name: "flow", unit: "", kind: QuantityKind::Instant, doc: "" },
    ];

    /// By hand: 20 up to a time of 100, then 2 and 4 by turns, whose mean is 3.
    #[test]
    fn missed_transient_is_cut_off() {
        let value = |at: i32| if at < 100 { 20.0 } else { f64::from(2 + at % 2 * 2) };
        let rows: Vec<Vec<f64>> = (0..1000).map(|at| vec![f64::from(at), value(at)]).collect();
        let missed = MeanEstimate { mean: 4.7, bar: 0.5, transient: 5.0, ..MeanEstimate::exactly(4.7) };
        let pace = Some(RowPace { cost: 1.0, row: 0.0 });
        let cut = |transient: f64| mean_after(&rows, (OBSERVED, 1), (&missed, pace), transient);
        let known = cut(100.0).unwrap();
        assert!((known.mean - 3.0).abs() < 0.01 && known.transient >= 100.0, "{known:?}");
        assert_eq!(cut(5.0).map(|it| it.mean), Some(4.7));
        assert!(cut(2000.0).is_none());
        let right = MeanEstimate { bar: 0.1, ..MeanEstimate::exactly(3.0) };
        assert!(differ(&right, &missed) && !differ(&right, &known));
    }
}
