//! Cheapest step and run length for a target error.

use super::bias::BiasEstimate;

/// Costs of a configuration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CostTerms {
    /// Wall seconds of a unit of time at the longest step.
    pub(crate) cost: f64,
    /// Wall seconds of the rows of a unit of time.
    pub rows: f64,
    /// Transient, which is not averaged over (time).
    pub(crate) transient: f64,
}

/// Largest relative growth at which a run length counts as converged.
const SETTLED: f64 = 1.0 + 1e-6;
/// Most iterations of a run length.
const REPEATS: usize = 64;

/// Cheapest step and time for an error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Optimum {
    /// The step, in parts of the longest.
    pub part: f64,
    /// Bias at the step.
    pub(crate) bias: BiasEstimate,
    /// Time averaged over (time).
    pub time: f64,
    /// Wall seconds.
    pub seconds: f64,
}

/// Steps tried per halving.
const BETWEEN: i32 = 4;
/// Shortest step tried, in parts of the longest.
pub(super) const SHORTEST: f64 = 1.0 / 256.0;
/// Shortest step tried where no bias is significant: smaller steps do not reduce the uncertainty of a bias.
pub(super) const UNBIASED: f64 = 0.25;

/// Returns the cheapest step and time whose total error is at most `error`: `bias` (a function of the step in parts of the longest and of the run
/// time) plus a statistical error that a run reaches after `time_for` it. None where bias alone exceeds the error.
///
/// A shorter step costs more per unit of time and has less bias, which leaves more of the error to statistics and so needs less time. A bias that
/// grows with the time needs a longer run, which is found by iteration from below.
pub(crate) fn cheapest_step_and_time(
    terms: CostTerms,
    (error, shortest): (f64, f64),
    bias: impl Fn(f64, f64) -> BiasEstimate,
    time_for: impl Fn(f64) -> f64,
) -> Option<Optimum> {
    let settled = |part: f64| {
        let mut time = 0.0;
        for _ in 0..REPEATS {
            let bias = bias(part, time);
            let needed = time_for(bias.error_left_to_statistics(error)?);
            if needed <= time * SETTLED {
                return Some((bias, needed));
            }
            time = needed;
        }
        None
    };
    let parts = (0..).map(|at| 2f64.powf(-f64::from(at) / f64::from(BETWEEN)));
    let of = |part: f64| {
        let (bias, time) = settled(part)?;
        let seconds = (terms.cost / part + terms.rows) * (time + terms.transient);
        Some(Optimum { part, bias, time, seconds })
    };
    parts.take_while(|part| *part >= shortest).filter_map(of).min_by(|a, b| a.seconds.total_cmp(&b.seconds))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TERMS: CostTerms = CostTerms { cost: 2.0, rows: 0.0, transient: 0.0 };

    fn best(terms: CostTerms, bias: impl Fn(f64) -> BiasEstimate) -> Option<Optimum> {
        cheapest_step_and_time(terms, (0.1, SHORTEST), |part, _| bias(part), |chance| 4.0 / (chance * chance))
    }

    /// By hand: with a bias of 2e-5 per unit of time, 4/(0.1 − 2e-5 t)² = t has its first root at t = 492.10; with 1e-4 it has none, as the
    /// largest t (0.1 − 1e-4 t)² is 1000/3 · 0.00444 = 1.48, less than 4.
    #[test]
    fn growing_bias_needs_a_shorter_step() {
        let of = |creep: f64, shortest: f64| {
            let bias = |part: f64, time: f64| BiasEstimate::exactly(creep * part * time);
            cheapest_step_and_time(TERMS, (0.1, shortest), bias, |chance| 4.0 / (chance * chance))
        };
        let found = of(2e-5, 1.0).unwrap();
        assert!((found.time - 492.10).abs() < 0.01 && found.part == 1.0, "{found:?}");
        assert_eq!(of(1e-4, 1.0), None);
        assert!(of(1e-4, SHORTEST).unwrap().part < 1.0);
    }

    /// Without bias the longest step is best; with b·part the cost 1/(part (e − b part)²) is least at part = e/(3 b): a third of the error.
    #[test]
    fn linear_bias_takes_a_third_of_the_error() {
        let free = best(TERMS, |_| BiasEstimate::default()).unwrap();
        assert!(free.part == 1.0 && (free.time - 400.0).abs() < 1e-9 && (free.seconds - 800.0).abs() < 1e-9);
        let bound = best(TERMS, |part| BiasEstimate::exactly(0.3 * part)).unwrap();
        assert!((bound.bias.shift / 0.1 - 1.0 / 3.0).abs() < 0.05, "{bound:?}");
        // A bias that does not fall with the step is never reached.
        assert_eq!(best(TERMS, |_| BiasEstimate::exactly(0.1)), None);
        // A long transient favours a longer step.
        let long = CostTerms { transient: 1e5, ..TERMS };
        assert!(best(long, |part| BiasEstimate::exactly(0.3 * part)).unwrap().part > bound.part);
    }
}
