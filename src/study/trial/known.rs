//! The mean of a run with its error, and the spacing of rows that reaches an error at the least cost: a row takes time, and values between rows are lost.

use super::any_number;
use serde::{Deserialize, Serialize};
use stripmine_physics::averages::{Estimate, foreseeing, of_independent};

/// Rows of a run whose time is known, where nothing asks for more.
pub(crate) const ROWS: f64 = 250.0;
/// Spacings of rows that are compared, in spacings of the sample; the widest first.
const EVERY: [usize; 4] = [8, 4, 2, 1];
/// Values that are left of a series at least.
const FEWEST: usize = 100;
/// A closer spacing is taken if it lowers the cost to less than this part: fewer rows make smaller files.
const WORTH: f64 = 0.8;

/// A mean as a run knows it.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Known {
    #[serde(with = "any_number")]
    pub mean: f64,
    /// Half the width of its interval of 95 %.
    #[serde(with = "any_number")]
    pub bar: f64,
    /// Time that the mean is over (time).
    #[serde(with = "any_number")]
    pub(crate) span: f64,
    /// Waves of the bar: its degrees of freedom.
    #[serde(with = "any_number")]
    pub waves: f64,
    /// Square of the bar of a mean over one unit of time, by rows [`every`](Self::every) so often.
    #[serde(with = "any_number")]
    pub square: f64,
    /// Time between rows (time); 0 where it does not matter.
    #[serde(with = "any_number")]
    pub every: f64,
    /// Square of the bar of a single value; 0 where rows miss nothing.
    #[serde(with = "any_number")]
    pub single: f64,
    /// Time that does not count (time).
    #[serde(with = "any_number")]
    pub(crate) transient: f64,
    /// Time between independent samples (time).
    #[serde(with = "any_number")]
    pub apart: f64,
    /// Degrees of freedom of the square; infinite where it is exact.
    #[serde(with = "any_number")]
    pub(crate) freedoms: f64,
}

/// Cost of the time and of the rows of a run whose rows have values of moments, and nothing of those between.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pace {
    /// Wall seconds of a unit of time, rows apart.
    pub(crate) cost: f64,
    /// Wall seconds of a row.
    pub row: f64,
}

impl Known {
    /// A mean that chance does not touch.
    pub(crate) fn exactly(mean: f64) -> Known {
        Known {
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

    /// Of the means of whole runs of a time (time); none of fewer than two.
    pub(crate) fn of_whole_runs(means: &[f64], time: f64) -> Option<Known> {
        let count = means.len() as f64;
        let [mean, bar] = of_independent(means)?;
        let (span, waves) = (count * time, count - 1.0);
        Some(Known { bar, square: bar * bar * span, span, waves, freedoms: waves, ..Known::exactly(mean) })
    }

    /// Of an estimate, and the values that it is of, each with its time (time). With a pace rows are as far apart as is cheapest for the error.
    pub(crate) fn of(it: Estimate, values: &[[f64; 2]], pace: Option<Pace>) -> Known {
        let kept: Vec<f64> =
            values.iter().filter(|[time, _]| *time > it.equilibrated_at).map(|[_, value]| *value).collect();
        let [bar, freedoms] = foreseeing(&kept).unwrap_or([it.bar, it.freedoms]);
        let all = Known {
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

    /// Returns the mean with the spacing of rows that reaches an error at the least cost; none if there are too few values.
    fn by_rows(self, values: &[f64], pace: Pace) -> Option<Known> {
        let count = values.len() as f64;
        let spacing = self.span / count;
        let squares: f64 = values.iter().map(|value| (value - self.mean).powi(2)).sum();
        let mut best: Option<(f64, Known)> = None;
        for by in EVERY {
            let seen: Vec<f64> = values.iter().skip(by - 1).step_by(by).copied().collect();
            let Some([bar, freedoms]) = foreseeing(&seen).filter(|_| by == 1 || seen.len() >= FEWEST) else {
                continue;
            };
            let every = by as f64 * spacing;
            let square = bar * bar * every * seen.len() as f64;
            let cost = square * (pace.cost + pace.row / every);
            if best.is_none_or(|(least, _)| cost < WORTH * least) {
                best = Some((cost, Known { square, every, single: 4.0 * squares / count, freedoms, ..self }));
            }
        }
        best.map(|(_, known)| known)
    }

    /// Returns the mean with the variance that rows of this spacing give (time).
    ///
    /// The variance of a mean over rows Δ apart is that of values whose memory fades exponentially, v Δ coth(v Δ/s), with v that of a single value and s that of
    /// close rows in a unit of time: s where rows are close, and v Δ where each is independent of the next.
    #[must_use]
    pub(crate) fn looked_at(&self, every: f64) -> Known {
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
        Known { square, every, ..*self }
    }

    /// Rows of a run of some time.
    pub(crate) fn rows_in(&self, time: f64) -> f64 {
        if self.every > 0.0 { (time / self.every).max(ROWS) } else { ROWS }
    }

    /// Rows of a unit of time in long runs.
    pub(crate) fn rows(&self) -> f64 {
        if self.every > 0.0 { 1.0 / self.every } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_physics::averages::{Outcome, estimated};

    const FREE: Pace = Pace { cost: 1.0, row: 0.0 };

    /// Values a unit of time apart that remember a part of the one before.
    fn known(memory: f64, pace: Option<Pace>) -> Known {
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
        match estimated(&values, 0.0, 1.0) {
            Outcome::Mean(estimate) => Known::of(estimate, &series, pace),
            outcome => unreachable!("{outcome:?}"),
        }
    }

    /// By hand, for a variance of 1 and a bar of two standard errors: rows Δ apart of values that keep a part m in a unit of time have 4 Δ (1 + m^Δ)/(1 − m^Δ). With
    /// m = 0.9 that is 76 for every value and 79 for every eighth: the eighth is enough. With m = 0 it is 4 and 32: every value counts, unless a row costs as much as
    /// eight units of time.
    #[test]
    fn rows_are_as_close_as_pays() {
        let near = |found: f64, exact: f64| (found / exact - 1.0).abs() < 0.25;
        let slow = known(0.9, Some(FREE));
        assert!(
            slow.every == 8.0 && near(slow.square, 32.0 * (1.0 + 0.9f64.powi(8)) / (1.0 - 0.9f64.powi(8))),
            "{slow:?}"
        );
        let quick = known(0.0, Some(FREE));
        assert!(quick.every == 1.0 && near(quick.square, 4.0) && near(quick.single, 4.0), "{quick:?}");
        let dear = known(0.0, Some(Pace { row: 80.0, ..FREE }));
        assert!(dear.every == 8.0 && near(dear.square, 32.0), "{dear:?}");
        // Rows that miss nothing do not matter.
        let means = known(0.0, None);
        assert!(means.every == 0.0 && near(means.square, 4.0) && means.single == 0.0, "{means:?}");
        // By rows farther apart, by the same formula.
        let later = known(0.5, Some(FREE)).looked_at(4.0);
        assert!(
            near(later.square, 16.0 * (1.0 + 0.0625) / (1.0 - 0.0625)) && later.every == 4.0,
            "{later:?}"
        );
        assert!(near(quick.looked_at(10.0).square, 40.0));
        assert_eq!(means.looked_at(100.0).square, means.square);
        assert_eq!(
            [quick.rows_in(1000.0), quick.rows_in(10.0), means.rows_in(1000.0), means.rows()],
            [1000.0, ROWS, ROWS, 0.0]
        );
    }
}
