//! How a program differs from what its passes and the levels say: how long it computes on whole vectors, where they say what
//! it does on short ones, and how long it waits, where they say what others do that touch as much.

use super::fit;
use super::point::{BEYOND, Point};
use crate::model::host::Factors;
use crate::statistics::non_negative;
use std::collections::BTreeMap;

/// Factors that are tried: the step of the logarithm, and the number of steps to either side.
const COMPUTING: (f64, i32) = (0.025, 15);
const WAITING: (f64, i32) = (0.04, 30);
/// Prior weight of a factor of 1, in points that deviate as much as the factor does from 1.
const PRIOR: f64 = 1.0;

/// The factors of every program, by its signature: those that bring what `predicted` gives for computing, streams and lines (ns)
/// nearest to what was measured.
pub(super) fn fit_factors<'a>(
    points: impl Iterator<Item = (&'a Point, [f64; 3])>,
    predicted: impl Fn(f64, [f64; 3]) -> f64,
) -> BTreeMap<String, Factors> {
    let steps = |(step, most): (f64, i32)| (-most..=most).map(move |at| step * f64::from(at));
    let fitted = |points: &[(&Point, [f64; 3])]| {
        let mut best = (f64::INFINITY, Factors::default());
        for (computing, waiting) in steps(COMPUTING).flat_map(|c| steps(WAITING).map(move |w| (c, w))) {
            let factors =
                Factors { computing: computing.exp(), waiting: waiting.exp(), ..Factors::default() };
            let deviations = points
                .iter()
                .map(|(point, parts)| point.deviation(predicted(point.start, factors.scaled(*parts))));
            let far = deviations.sum::<f64>() + PRIOR * (computing.abs() + waiting.abs());
            if far < best.0 {
                best = (far, factors);
            }
        }
        best.1
    };
    by_program(points).map(|(program, points)| (program.to_owned(), fitted(&points))).collect()
}

/// A point, and what is said of its computing, streams and lines (ns).
type Parts<'a> = (&'a Point, [f64; 3]);

fn by_program<'a>(
    points: impl Iterator<Item = Parts<'a>>,
) -> impl Iterator<Item = (&'a str, Vec<Parts<'a>>)> {
    let mut programs: BTreeMap<&str, Vec<Parts>> = BTreeMap::new();
    for (point, parts) in points {
        if let Some(program) = point.program.as_deref() {
            programs.entry(program).or_default().push((point, parts));
        }
    }
    programs.into_iter()
}

/// What is fitted of a program in the interpreter: computing, waiting, and the additional cost of bytes from beyond each level.
const COSTS: usize = 2 + BEYOND;
/// Prior weight of the costs of all programs, in points.
const PRIOR_COSTS: f64 = 0.3;
/// Rounds in which what is far from the fit weighs less and less.
const ROUNDS: usize = 6;

/// The same of programs in the interpreter, which do one thing after the other: with the additional cost of bytes from beyond
/// each level.
pub(super) fn fit_costs<'a>(points: impl Iterator<Item = Parts<'a>>) -> BTreeMap<String, Factors> {
    let fitted = |points: &[Parts]| {
        let features = |(point, [computing, streams, lines]): &Parts| {
            let mut features = [*computing, streams + lines, 0.0, 0.0, 0.0, 0.0];
            features[2..].copy_from_slice(&point.bytes());
            features
        };
        // As large as they are in the median where they are at all.
        let usual: [f64; COSTS] = std::array::from_fn(|at| {
            let shares = points.iter().map(|parts| features(parts)[at] / parts.0.ns);
            fit::median(shares.filter(|share| *share > 0.0))
        });
        let mut costs = [1.0, 1.0, 0.0, 0.0, 0.0, 0.0];
        for _ in 0..ROUNDS {
            let measured = points.iter().map(|parts| {
                let (point, features) = (parts.0, features(parts));
                let ns = point.start
                    + features.iter().zip(costs).map(|(feature, cost)| feature * cost).sum::<f64>();
                let scale = point.scale(point.deviation(ns));
                (features.map(|feature| feature * scale), (point.ns - point.start) * scale)
            });
            let known = (0..COSTS).map(|at| {
                let mut row = [0.0; COSTS];
                row[at] = PRIOR_COSTS * usual[at].max(0.01);
                (row, if at < 2 { row[at] } else { 0.0 })
            });
            costs = non_negative(&measured.chain(known).collect::<Vec<_>>());
        }
        let [computing, waiting, beyond @ ..] = costs;
        Factors { computing, waiting, beyond }
    };
    by_program(points).map(|(program, points)| (program.to_owned(), fitted(&points))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_that_went_in_come_out() {
        let predicted = |start: f64, parts: [f64; 3]| start + parts.iter().sum::<f64>();
        let truth = Factors { computing: 0.8, waiting: 1.5, ..Factors::default() };
        let parts = |at: i32| [100.0, 20.0 * f64::from(at), 5.0 * f64::from(at)];
        let point = |at: i32, program: &str| {
            let ns = predicted(7.0, truth.scaled(parts(at)));
            Point { start: 7.0, ns, program: Some(program.to_owned()), ..Point::default() }
        };
        // One was disturbed; of the other program there is one alone, and of a drill none is asked for.
        let mut all: Vec<Point> = (0..12).map(|at| point(at, "one")).collect();
        all[3].ns *= 4.0;
        all.push(Point { ns: predicted(7.0, parts(12)), ..point(12, "other") });
        all.push(Point { program: None, ..point(13, "") });
        let found = fit_factors(all.iter().zip((0..).map(parts)), predicted);
        let one = found["one"];
        // To a step: the prior draws them towards 1.
        let off = [(one.computing / 0.8, COMPUTING.0), (one.waiting / 1.5, WAITING.0)];
        assert!(off.iter().all(|(ratio, step)| ratio.ln().abs() < *step), "{one:?}");
        assert_eq!((found["other"], found.len()), (Factors::default(), 2));
    }

    #[test]
    fn costs_of_levels_that_went_in_come_out() {
        // Little to much from beyond the third and the fourth, which take longer than is said.
        let point = |at: i32| {
            let bytes = [4.0, 4.0, f64::from(at), f64::from(at / 3)].map(|bytes| 100.0 * bytes);
            let mut features = Point::default().features;
            features[1..=BEYOND].copy_from_slice(&bytes);
            let parts = [1000.0, 0.1 * bytes.iter().sum::<f64>(), 0.0];
            let ns = 5.0 + 0.9 * parts[0] + parts[1] + 0.5 * bytes[2] + 2.0 * bytes[3];
            let program = Some("one".to_owned());
            (Point { start: 5.0, ns, features, program, weight: 1.0, ..Point::default() }, parts)
        };
        let points: Vec<_> = (0..20).map(point).collect();
        let found = fit_costs(points.iter().map(|(point, parts)| (point, *parts)))["one"];
        for (point, parts) in &points {
            let extra: f64 = point.bytes().iter().zip(found.beyond).map(|(bytes, cost)| bytes * cost).sum();
            let ns = point.start + found.scaled(*parts).iter().sum::<f64>() + extra;
            assert!(point.deviation(ns) < 0.03, "{found:?}: {ns} {}", point.ns);
        }
    }
}
