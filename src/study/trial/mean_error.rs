//! Mean of a run with its error, and the spacing of rows that reaches an error most cheaply: each row costs time, and values between rows are lost.

use super::any_number;
use serde::{Deserialize, Serialize};
use stripmine_physics::averages::{Estimate, MeanWithBar, mean_of_independent, predictive_half_width};

/// Fewest rows of a run of known time.
pub(crate) const ROWS: f64 = 250.0;
/// Spacings of rows that are compared, in spacings of the sample; the widest first.
const EVERY: [usize; 4] = [8, 4, 2, 1];
/// Fewest values of a thinned series.
const FEWEST: usize = 100;
/// Largest ratio of costs at which a closer spacing is preferred: fewer rows make smaller files.
const WORTH: f64 = 0.8;

/// Estimated mean of a run.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct MeanEstimate {
    #[serde(with = "any_number")]
    pub mean: f64,
    /// Half the width of its 95 % confidence interval (the error bar).
    #[serde(with = "any_number")]
    pub bar: f64,
    /// Time averaged over (time).
    #[serde(with = "any_number")]
    pub(crate) span: f64,
    /// Waves of the error bar: its degrees of freedom.
    #[serde(with = "any_number")]
    pub waves: f64,
    /// Square of the error bar of a mean over one unit of time, with rows spaced by [`every`](Self::every).
    #[serde(with = "any_number")]
    pub square: f64,
    /// Time between rows (time); 0 where it does not matter.
    #[serde(with = "any_number")]
    pub every: f64,
    /// Square of the error bar of a single value; 0 where rows lose nothing.
    #[serde(with = "any_number")]
    pub single: f64,
    /// Length of the transient (time).
    #[serde(with = "any_number")]
    pub(crate) transient: f64,
    /// Time between independent samples (time).
    #[serde(with = "any_number")]
    pub apart: f64,
    /// Degrees of freedom of the square; infinite where it is exact.
    #[serde(with = "any_number")]
    pub(crate) freedoms: f64,
}

/// Costs of a run whose rows are instantaneous values, so that values between rows are lost.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowPace {
    /// Wall seconds of a unit of time, without rows.
    pub(crate) cost: f64,
    /// Wall seconds of a row.
    pub row: f64,
}

impl MeanEstimate {
    /// A mean without statistical error.
    pub(crate) fn exactly(mean: f64) -> MeanEstimate {
        MeanEstimate {
            mean,
            bar: 0.0,
            square: 0.0,
            every: 0.0,
            single: 0.0,
            span: 0.0,
            waves: f64::INFINITY,
            transient: 0.0,
            apart: 0.0,
            freedoms: f64::INFINITY,
        }
    }

    /// Estimates the mean from the means of whole runs of a time (time); none from fewer than two.
    pub(crate) fn of_whole_runs(means: &[f64], time: f64) -> Option<MeanEstimate> {
        let count = means.len() as f64;
        let MeanWithBar { value, bar } = mean_of_independent(means)?;
        let (span, waves) = (count * time, count - 1.0);
        Some(MeanEstimate {
            bar,
            square: bar * bar * span,
            span,
            waves,
            freedoms: waves,
            ..MeanEstimate::exactly(value)
        })
    }

    /// Estimates the mean from an average and its values, each with its time (time). With a pace, the spacing of rows is optimised.
    pub(crate) fn of(it: Estimate, values: &[[f64; 2]], pace: Option<RowPace>) -> MeanEstimate {
        let kept: Vec<f64> =
            values.iter().filter(|[time, _]| *time > it.equilibrated_at).map(|[_, value]| *value).collect();
        let [bar, freedoms] = predictive_half_width(&kept).unwrap_or([it.bar, it.freedoms]);
        let all = MeanEstimate {
            mean: it.mean,
            bar: it.bar,
            square: bar * bar * it.span,
            every: 0.0,
            single: 0.0,
            span: it.span,
            waves: it.freedoms,
            transient: it.equilibrated_at,
            apart: it.span / it.independent_samples,
            freedoms,
        };
        pace.and_then(|pace| all.by_rows(&kept, pace)).unwrap_or(all)
    }

    /// Optimises the spacing of rows for the cost of an error; none if there are too few values.
    fn by_rows(self, values: &[f64], pace: RowPace) -> Option<MeanEstimate> {
        let count = values.len() as f64;
        let spacing = self.span / count;
        let squares: f64 = values.iter().map(|value| (value - self.mean).powi(2)).sum();
        let mut best: Option<(f64, MeanEstimate)> = None;
        for by in EVERY {
            let seen: Vec<f64> = values.iter().skip(by - 1).step_by(by).copied().collect();
            let Some([bar, freedoms]) =
                predictive_half_width(&seen).filter(|_| by == 1 || seen.len() >= FEWEST)
            else {
                continue;
            };
            let every = by as f64 * spacing;
            let square = bar * bar * every * seen.len() as f64;
            let cost = square * (pace.cost + pace.row / every);
            if best.is_none_or(|(least, _)| cost < WORTH * least) {
                best = Some((
                    cost,
                    MeanEstimate { square, every, single: 4.0 * squares / count, freedoms, ..self },
                ));
            }
        }
        best.map(|(_, known)| known)
    }

    /// Returns the mean with its variance at another spacing of rows (time).
    ///
    /// The variance of a mean over rows Δ apart is that of values with exponentially decaying correlation, v Δ coth(v Δ/s). Here v is the variance of
    /// a single value and s that of close rows in a unit of time: the limits are s for close rows, and v Δ for independent rows.
    #[must_use]
    pub(crate) fn with_row_spacing(&self, every: f64) -> MeanEstimate {
        if self.single == 0.0 || every <= self.every {
            return *self;
        }
        let alone = |every: f64| self.single * every;
        let square = match alone(self.every) / self.square {
            // Values are independent already.
            part if part >= 1.0 => self.square * every / self.every,
            part => {
                let close = alone(self.every) / libm::atanh(part);
                alone(every) / libm::tanh(alone(every) / close)
            }
        };
        MeanEstimate { square, every, ..*self }
    }

    /// Number of rows of a run of some time.
    pub(crate) fn rows_in(&self, time: f64) -> f64 {
        if self.every > 0.0 { (time / self.every).max(ROWS) } else { ROWS }
    }

    /// Number of rows per unit of time in long runs.
    pub(crate) fn rows(&self) -> f64 {
        if self.every > 0.0 { 1.0 / self.every } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_physics::averages::{AverageOutcome, estimate_mean};

    const FREE: RowPace = RowPace { cost: 1.0, row: 0.0 };

    /// Values a unit of time apart, correlated with the one before.
    fn known(memory: f64, pace: Option<RowPace>) -> MeanEstimate {
        let (mut state, mut value) = (5_u64, 0.0);
        let mut next = |end: u32| {
            let mut uniform = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
            };
            value = memory * value + (1.0 - memory * memory).sqrt() * 12f64.sqrt() * uniform();
            [f64::from(end), value]
        };
        let series: Vec<[f64; 2]> = (1..=8000).map(&mut next).collect();
        let values: Vec<f64> = series.iter().map(|it| it[1]).collect();
        match estimate_mean(&values, 0.0, 1.0) {
            AverageOutcome::Mean(estimate) => MeanEstimate::of(estimate, &series, pace),
            outcome => unreachable!("{outcome:?}"),
        }
    }

    /// By hand, for a variance of 1 and an error bar of two standard errors: rows Δ apart of values that keep a part m in a unit of time have
    /// 4 Δ (1 + m^Δ)/(1 − m^Δ). With m = 0.9 that is 76 for every value and 79 for every eighth: the eighth is enough. With m = 0 it is 4 and 32: every
    /// value counts, unless a row costs as much as eight units of time.
    #[test]
    fn row_spacing_minimises_cost() {
        let near = |found: f64, exact: f64| (found / exact - 1.0).abs() < 0.25;
        let slow = known(0.9, Some(FREE));
        assert!(
            slow.every == 8.0 && near(slow.square, 32.0 * (1.0 + 0.9f64.powi(8)) / (1.0 - 0.9f64.powi(8))),
            "{slow:?}"
        );
        let quick = known(0.0, Some(FREE));
        assert!(quick.every == 1.0 && near(quick.square, 4.0) && near(quick.single, 4.0), "{quick:?}");
        let expensive = known(0.0, Some(RowPace { row: 80.0, ..FREE }));
        assert!(expensive.every == 8.0 && near(expensive.square, 32.0), "{expensive:?}");
        // Rows that lose nothing may have any spacing.
        let means = known(0.0, None);
        assert!(means.every == 0.0 && near(means.square, 4.0) && means.single == 0.0, "{means:?}");
        // A wider spacing follows the same formula.
        let later = known(0.5, Some(FREE)).with_row_spacing(4.0);
        assert!(
            near(later.square, 16.0 * (1.0 + 0.0625) / (1.0 - 0.0625)) && later.every == 4.0,
            "{later:?}"
        );
        assert!(near(quick.with_row_spacing(10.0).square, 40.0));
        assert_eq!(means.with_row_spacing(100.0).square, means.square);
        assert_eq!(
            [quick.rows_in(1000.0), quick.rows_in(10.0), means.rows_in(1000.0), means.rows()],
            [1000.0, ROWS, ROWS, 0.0]
        );
    }
}
