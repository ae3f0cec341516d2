//! Averages over a run: the mean of each quantity with its error, from the rows of `thermo.csv`.
//!
//! The transient at the beginning is cut off (`equilibration`), the error of the mean is that of correlated values (`waves`), and a bar is
//! the half width of the interval that holds the true mean with a probability of 95 %. What is counted since the start is averaged by its
//! increments from row to row (`rows`). Nothing but the rows enters, so that averages are the same in however many sessions a run was made.

mod equilibration;
mod estimate;
mod joined;
#[cfg(test)]
mod noise;
mod rows;
mod student;
mod waves;
mod words;

pub use estimate::{Estimate, LIKELY_ENOUGH, Outcome, estimated, foreseeing, of_correlated, of_independent};
pub use joined::joined;
pub use rows::Rows;
pub use student::{student, variance_ratio};
pub use waves::MOST as MOST_WAVES;

use crate::method::{Kind, Quantity};
use serde::Serialize;

/// What a bar is, once for all of them.
pub(crate) const BAR: &str = "half width of the 95 % interval, by Student's t";

/// The averages of a run, or of several joined.
#[derive(Clone, Debug, Serialize)]
pub struct Averages {
    /// What a bar is.
    pub bar: &'static str,
    /// Rows of `thermo.csv` that they are from, those of the transient among them.
    pub rows: u64,
    /// The time that they are over, of all runs (time).
    pub span: f64,
    /// Runs that are joined.
    pub runs: usize,
    /// One for each quantity but the time.
    pub quantities: Vec<Average>,
}

/// What there is to be said of a quantity over a run.
#[derive(Clone, Debug, Serialize)]
pub struct Average {
    /// Its name.
    pub quantity: &'static str,
    /// What is averaged: values, rates of what is counted, or values of the intervals between rows.
    pub of: &'static str,
    /// The unit of the average, empty for pure numbers.
    pub unit: String,
    /// The average.
    #[serde(flatten)]
    pub outcome: Outcome,
}

impl Averages {
    /// Of the rows of a run.
    pub fn of(rows: &Rows) -> Averages {
        let places =
            (0..rows.quantities().len()).filter(|&place| rows.quantities()[place].kind != Kind::Time);
        let quantities = places.map(|place| Average::of(rows, place)).collect();
        Averages { bar: BAR, rows: rows.count(), span: rows.now() - rows.from(), runs: 1, quantities }
    }
}

impl Average {
    /// Of the quantity at a place among those observed.
    pub fn of(rows: &Rows, place: usize) -> Average {
        let quantity = rows.quantities()[place];
        let outcome = match quantity.kind {
            Kind::Kept => {
                let [first, last, farthest] = rows.kept(place);
                let is_number = first.is_finite() && farthest.is_finite();
                if is_number { Outcome::Kept { first, last, farthest } } else { Outcome::Undefined }
            }
            _ => estimated(&rows.series(place), rows.from(), rows.block_spacing()),
        };
        Average { quantity: quantity.name, of: what(quantity), unit: unit(quantity), outcome }
    }
}

fn what(quantity: Quantity) -> &'static str {
    match quantity.kind {
        Kind::Time | Kind::Instant => "values",
        Kind::Counter => "rate",
        Kind::Interval => "intervals",
        Kind::Kept => "nothing",
    }
}

/// The unit of an average: of what is counted, that of its rate.
fn unit(quantity: Quantity) -> String {
    match (quantity.kind, quantity.unit) {
        (Kind::Counter, "") => "1/time".to_owned(),
        (Kind::Counter, unit) => match unit.strip_suffix("/time") {
            Some(unit) => format!("{unit}/time²"),
            None => format!("{unit}/time"),
        },
        (_, unit) => unit.to_owned(),
    }
}
