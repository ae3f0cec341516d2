//! What is fitted, and what lies outside of it.

use serde::{Deserialize, Serialize};

/// A fitted number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "[f64; 2]", into = "[f64; 2]")]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Half the width of its 95 % confidence interval: from the residuals of the fit, and from how far the parts of the
    /// measurement differ.
    pub interval: f64,
}

impl From<[f64; 2]> for Estimate {
    fn from([value, interval]: [f64; 2]) -> Estimate {
        Estimate { value, interval }
    }
}

impl From<Estimate> for [f64; 2] {
    fn from(Estimate { value, interval }: Estimate) -> [f64; 2] {
        [value, interval]
    }
}

impl Estimate {
    /// Without another, and as unsure as both; nothing takes less than zero.
    #[must_use]
    pub fn less(self, other: Estimate) -> Estimate {
        Estimate { value: (self.value - other.value).max(0.0), interval: self.interval.hypot(other.interval) }
    }
}

/// A pass of one kind over a vector in the first-level cache: Hockney's `r_inf = 1/tau`, `n_half = t0/tau`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "[Estimate; 2]", into = "[Estimate; 2]")]
pub struct PassCost {
    /// Nanoseconds an element, tau.
    pub element: Estimate,
    /// Nanoseconds of a pass in addition, t0.
    pub start: Estimate,
}

impl From<[Estimate; 2]> for PassCost {
    fn from([element, start]: [Estimate; 2]) -> PassCost {
        PassCost { element, start }
    }
}

impl From<PassCost> for [Estimate; 2] {
    fn from(PassCost { element, start }: PassCost) -> [Estimate; 2] {
        [element, start]
    }
}

/// Why there is no prediction.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OutOfRange {
    /// Vectors longer or shorter than those that were measured.
    #[error(
        "vectors of {n} elements lie outside the calibrated range of {shortest} to {longest}: calibrate on them, or ask \
         for another number of particles"
    )]
    Length {
        /// Elements asked for.
        n: usize,
        /// Shortest vectors.
        shortest: usize,
        /// Longest vectors.
        longest: usize,
    },
    /// More or fewer discs than those that were measured.
    #[error(
        "{discs} discs lie outside the calibrated range of {fewest} to {most}: ask for another number of particles"
    )]
    Discs {
        /// Discs asked for.
        discs: usize,
        /// Fewest discs.
        fewest: usize,
        /// Most discs.
        most: usize,
    },
    /// An execution, precision or program that was not measured.
    #[error("{0} was not calibrated")]
    NotMeasured(String),
}

/// Between points of rising positive abscissae, linearly over their logarithm; beyond the ends as there.
pub(super) fn interpolated(points: &[(f64, f64)], at: f64) -> f64 {
    let Some(&(first, value)) = points.first() else { return 0.0 };
    if at <= first {
        return value;
    }
    for pair in points.windows(2) {
        let [(x0, y0), (x1, y1)] = [pair[0], pair[1]];
        if at <= x1 {
            return y0 + (y1 - y0) * (at / x0).ln() / (x1 / x0).ln();
        }
    }
    points.last().map_or(0.0, |&(_, value)| value)
}
