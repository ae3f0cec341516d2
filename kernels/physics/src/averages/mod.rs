//! Averages over a run: the mean of each quantity and its error, from the rows of `thermo.csv`.
//!
//! The initial transient is removed (`equilibration`), and the standard error accounts for correlations (`waves`). An error bar is the half-width
//! of the 95 % confidence interval of the mean. Counters since the start are averaged by their increments between rows (`rows`). Averages depend on
//! the rows alone, so they are the same for any number of sessions of a run.

mod equilibration;
mod estimate;
mod joined;
#[cfg(test)]
mod noise;
mod rows;
mod student;
mod waves;
mod words;

pub use estimate::{
    AverageOutcome, Estimate, LIKELY_ENOUGH, MeanWithBar, estimate_mean, mean_of_correlated,
    mean_of_independent, predictive_half_width,
};
pub use joined::joined;
pub use rows::AveragedRows;
pub use student::{student, variance_ratio};
pub use waves::MOST as MOST_WAVES;

use crate::method::{ObservedQuantity, QuantityKind};
use serde::Serialize;

/// Definition of the error bars.
pub(crate) const BAR: &str = "half-width of the 95 % confidence interval, by Student's t";

/// Averages of a run, or of several joined ones.
#[derive(Clone, Debug, Serialize)]
pub struct RunAverages {
    /// Definition of the error bars.
    pub bar: &'static str,
    /// Number of rows of `thermo.csv` used, the transient included.
    pub rows: u64,
    /// Total time of all runs (time).
    pub span: f64,
    /// Number of joined runs.
    pub runs: usize,
    /// Average of each quantity except the time.
    pub quantities: Vec<Average>,
}

/// Average of a quantity over a run.
#[derive(Clone, Debug, Serialize)]
pub struct Average {
    /// Name of the quantity.
    pub quantity: &'static str,
    /// Averaged data: values, rates of counters, or values of the intervals between rows.
    pub of: &'static str,
    /// Unit of the average; empty for pure numbers.
    pub unit: String,
    /// Result.
    #[serde(flatten)]
    pub outcome: AverageOutcome,
}

impl RunAverages {
    /// Averages over the rows of a run.
    pub fn of(rows: &AveragedRows) -> RunAverages {
        let places =
            (0..rows.quantities().len()).filter(|&place| rows.quantities()[place].kind != QuantityKind::Time);
        let quantities = places.map(|place| Average::of(rows, place)).collect();
        RunAverages { bar: BAR, rows: rows.count(), span: rows.now() - rows.from(), runs: 1, quantities }
    }
}

impl Average {
    /// Average of the quantity with an index among those observed.
    pub fn of(rows: &AveragedRows, place: usize) -> Average {
        let quantity = rows.quantities()[place];
        let outcome = match quantity.kind {
            QuantityKind::Kept => {
                let [first, last, farthest] = rows.first_last_and_farthest(place);
                let is_number = first.is_finite() && farthest.is_finite();
                if is_number {
                    AverageOutcome::Kept { first, last, farthest }
                } else {
                    AverageOutcome::Undefined
                }
            }
            _ => estimate_mean(&rows.series(place), rows.from(), rows.block_spacing()),
        };
        Average { quantity: quantity.name, of: what(quantity), unit: unit(quantity), outcome }
    }
}

fn what(quantity: ObservedQuantity) -> &'static str {
    match quantity.kind {
        QuantityKind::Time | QuantityKind::Instant => "values",
        QuantityKind::Counter => "rate",
        QuantityKind::Interval => "intervals",
        QuantityKind::Kept => "nothing",
    }
}

/// Unit of an average; for counters that of the rate.
fn unit(quantity: ObservedQuantity) -> String {
    match (quantity.kind, quantity.unit) {
        (QuantityKind::Counter, "") => "1/time".to_owned(),
        (QuantityKind::Counter, unit) => match unit.strip_suffix("/time") {
            Some(unit) => format!("{unit}/time²"),
            None => format!("{unit}/time"),
        },
        (_, unit) => unit.to_owned(),
    }
}
