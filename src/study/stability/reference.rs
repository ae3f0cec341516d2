//! Expected means of a right run, from runs at a short step over several seeds.

use super::averages::ObservedMeans;
use crate::statistics::{RunSpread, student};

/// Number of reference runs, each from its own seed.
pub(crate) const SEEDS: u64 = 8;
/// Share of right runs within the interval.
const WITHIN: f64 = 0.999;
/// Relative error below which a mean counts as right.
pub(crate) const TOLERANCE: f64 = 0.05;
/// Largest relative error of a usable reference mean.
const KNOWN: f64 = 0.1;
/// Relative width above which an interval cannot distinguish right from wrong runs.
const DECISIVE: f64 = 5.0 * TOLERANCE;

/// Interval that contains the mean of a single run, in all but one of a thousand.
#[derive(Clone, Debug, PartialEq)]
struct MeanInterval {
    observable: String,
    middle: Vec<f64>,
    /// Largest distance from the middle: of a single value, or the root mean square of several.
    reach: f64,
    scale: f64,
}

/// Intervals of all means of a run.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ExpectedMeans(Vec<MeanInterval>);

fn rms(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len().max(1) as f64;
    (values.map(|value| value * value).sum::<f64>() / count).sqrt()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    rms(a.iter().zip(b).map(|(a, b)| a - b))
}

fn middle<'m>(runs: impl Iterator<Item = &'m Vec<f64>>) -> Vec<f64> {
    let runs: Vec<&Vec<f64>> = runs.collect();
    (0..runs[0].len()).map(|i| runs.iter().map(|run| run[i]).sum::<f64>() / runs.len() as f64).collect()
}

impl ExpectedMeans {
    /// Computes intervals from the means of several runs; none from fewer than three. Errors are relative to a mean, or to `at_least` where that is
    /// larger.
    pub(super) fn of(runs: &[ObservedMeans], at_least: impl Fn(&str) -> f64) -> Option<ExpectedMeans> {
        let first = runs.first().filter(|_| runs.len() > 2)?;
        let interval = |name: &String| MeanInterval::of(name, runs, at_least(name));
        Some(ExpectedMeans(first.keys().filter_map(interval).collect()))
    }

    /// True if a wrong mean would be detected: at least one is known well enough.
    pub(crate) fn decides(&self) -> bool {
        self.0.iter().any(|interval| interval.reach <= DECISIVE * interval.scale)
    }

    /// Describes the mean with the largest excess over its interval; none if all are inside.
    pub(crate) fn worst(&self, means: &ObservedMeans) -> Option<String> {
        let off = self.0.iter().filter_map(|interval| {
            let value = means.get(&interval.observable)?;
            let off = distance(value, &interval.middle);
            // NaN is outside, too.
            let is_inside = off <= interval.reach.max(TOLERANCE * interval.scale);
            (!is_inside).then_some((interval, off))
        });
        let parts = |(interval, off): &(&MeanInterval, f64)| off / interval.scale;
        let (interval, off) = off.max_by(|a, b| parts(a).total_cmp(&parts(b)))?;
        Some(format!(
            "the mean {} has an error of {:.0} %, above the allowed {:.0} %",
            interval.observable,
            100.0 * off / interval.scale,
            100.0 * (interval.reach / interval.scale).max(TOLERANCE)
        ))
    }
}

impl MeanInterval {
    fn of(name: &str, runs: &[ObservedMeans], at_least: f64) -> Option<MeanInterval> {
        let values: Vec<&Vec<f64>> = runs.iter().filter_map(|run| run.get(name)).collect();
        let all = middle(values.iter().copied());
        let scale = rms(all.iter().copied()).max(at_least);
        let count = values.len() as f64;
        // Reach of one run from the mean of the others, in standard errors of that mean.
        let reach_of_one = student(WITHIN, values.len() - 1) * count.sqrt() * (1.0 + 1.0 / count).sqrt();
        let reach = if all.len() == 1 {
            let spread = RunSpread::of(&values.iter().map(|value| value[0]).collect::<Vec<_>>());
            let error = spread.error.filter(|error| *error < KNOWN * scale)?;
            reach_of_one * error
        } else {
            // Distance of each from the middle of the others.
            let apart: Vec<f64> = (0..values.len())
                .map(|own| {
                    let others = values.iter().enumerate().filter(|(other, _)| *other != own);
                    distance(values[own], &middle(others.map(|(_, value)| *value)))
                })
                .collect();
            let spread = RunSpread::of(&apart);
            spread.mean + reach_of_one * spread.error.unwrap_or(0.0)
        };
        Some(MeanInterval { observable: name.to_owned(), middle: all, reach, scale })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn runs(values: [[f64; 2]; 8]) -> Vec<ObservedMeans> {
        let of =
            |[a, b]: [f64; 2]| ObservedMeans::from([("a".to_owned(), vec![a]), ("b".to_owned(), vec![a, b])]);
        values.into_iter().map(of).collect()
    }

    fn around(off: [f64; 2], middle: f64) -> Vec<ObservedMeans> {
        runs(std::array::from_fn(|run| [middle + off[run % 2], middle - off[run % 2]]))
    }

    /// By hand: ±1 eight times has the standard deviation 1.069, so a run may differ by 5.408 · 1.069 · 1.061 = 6.13.
    #[test]
    fn wrong_means_exceed_scatter_and_tolerance() {
        let expected = ExpectedMeans::of(&around([1.0, -1.0], 100.0), |_| 0.0).unwrap();
        let off = |a: f64| expected.worst(&ObservedMeans::from([("a".to_owned(), vec![a])]));
        assert_eq!([off(106.1), off(93.9)], [None, None]);
        assert_eq!(off(106.2).unwrap(), "the mean a has an error of 6 %, above the allowed 6 %");
        assert!(off(f64::NAN).is_some());
        // Only ±4 and ±4.2: 24.5 and 25.8 of 100.
        let decides = |apart: f64| {
            let alone = (0..8).map(|run| vec![if run % 2 == 0 { 100.0 + apart } else { 100.0 - apart }]);
            let runs: Vec<ObservedMeans> =
                alone.map(|value| ObservedMeans::from([("a".to_owned(), value)])).collect();
            ExpectedMeans::of(&runs, |_| 0.0).unwrap().decides()
        };
        assert_eq!([decides(4.0), decides(4.2)], [true, false]);
        let certain = ExpectedMeans::of(&runs([[100.0, 50.0]; 8]), |_| 0.0).unwrap();
        let off = |a: f64| certain.worst(&ObservedMeans::from([("a".to_owned(), vec![a])]));
        assert!(off(104.9).is_none() && off(105.1).is_some());
        // A mean consistent with zero is uninformative, unless it is compared with a larger value.
        let off = |at_least: f64| {
            let expected = ExpectedMeans::of(&around([1.0, -1.0], 0.0), |_| at_least).unwrap();
            expected.worst(&ObservedMeans::from([("a".to_owned(), vec![50.0])])).is_some()
        };
        assert_eq!([off(0.0), off(100.0)], [false, true]);
        assert_eq!(ExpectedMeans::of(&runs([[0.0; 2]; 8])[..2], |_| 0.0), None);
    }
}
