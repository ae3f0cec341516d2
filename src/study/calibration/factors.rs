//! How a program differs from what its passes and the levels say: how long it computes on whole vectors, where they say what
//! it does on short ones, and how long it waits, where they say what others do that touch as much.

use super::levels::Point;
use crate::model::host::Factors;
use std::collections::BTreeMap;

/// Factors that are tried: steps of the logarithm, and so many to either side.
const COMPUTING: (f64, i32) = (0.025, 15);
const WAITING: (f64, i32) = (0.04, 30);
/// A factor is as bad as the deviation of so many points that are as far off as it is from 1.
const BEFOREHAND: f64 = 1.0;

/// The factors of every program, by its signature: those that bring what `told` says of computing, streams and lines (ns)
/// nearest to what was measured.
pub(super) fn fit_factors<'a>(
    points: impl Iterator<Item = (&'a Point, [f64; 3])>,
    told: impl Fn(f64, [f64; 3]) -> f64,
) -> BTreeMap<String, Factors> {
    let mut programs: BTreeMap<&str, Vec<(&Point, [f64; 3])>> = BTreeMap::new();
    for (point, parts) in points {
        if let Some(program) = point.program.as_deref() {
            programs.entry(program).or_default().push((point, parts));
        }
    }
    let steps = |(step, most): (f64, i32)| (-most..=most).map(move |at| step * f64::from(at));
    let fitted = |points: &[(&Point, [f64; 3])]| {
        let mut best = (f64::INFINITY, Factors::default());
        for (computing, waiting) in steps(COMPUTING).flat_map(|c| steps(WAITING).map(move |w| (c, w))) {
            let factors = Factors { computing: computing.exp(), waiting: waiting.exp() };
            let deviations = points
                .iter()
                .map(|(point, parts)| point.deviation(told(point.start, factors.scaled(*parts))));
            let far = deviations.sum::<f64>() + BEFOREHAND * (computing.abs() + waiting.abs());
            if far < best.0 {
                best = (far, factors);
            }
        }
        best.1
    };
    programs.into_iter().map(|(program, points)| (program.to_owned(), fitted(&points))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_that_went_in_come_out() {
        let told = |start: f64, parts: [f64; 3]| start + parts.iter().sum::<f64>();
        let truth = Factors { computing: 0.8, waiting: 1.5 };
        let parts = |at: i32| [100.0, 20.0 * f64::from(at), 5.0 * f64::from(at)];
        let point = |at: i32, program: &str| {
            let ns = told(7.0, truth.scaled(parts(at)));
            Point { start: 7.0, ns, program: Some(program.to_owned()), ..Point::default() }
        };
        // One was disturbed; of the other program there is one alone, and of a drill none is asked for.
        let mut all: Vec<Point> = (0..12).map(|at| point(at, "one")).collect();
        all[3].ns *= 4.0;
        all.push(Point { ns: told(7.0, parts(12)), ..point(12, "other") });
        all.push(Point { program: None, ..point(13, "") });
        let found = fit_factors(all.iter().zip((0..).map(parts)), told);
        let one = found["one"];
        // To a step: what is known beforehand draws them towards 1.
        let off = [(one.computing / 0.8, COMPUTING.0), (one.waiting / 1.5, WAITING.0)];
        assert!(off.iter().all(|(ratio, step)| ratio.ln().abs() < *step), "{one:?}");
        assert_eq!((found["other"], found.len()), (Factors::default(), 2));
    }
}
