//! Work whose amount depends on the data: a time for each step, disc, cell, candidate, contact and entry of a list.

use super::out_of_range::OutOfRange;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// How much there is to do in a step: measured in a run, or estimated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Amounts {
    /// Steps, one: what a phase takes even without work.
    pub steps: f64,
    pub discs: f64,
    /// Cells of the lattice; none for lists.
    pub cells: f64,
    /// Entries of lists; on the lattice the occupied cells in half the mask, as if discs lay at random.
    pub(crate) candidates: f64,
    /// Pairs that the law is asked about.
    pub contacts: f64,
    /// How often lists are rebuilt, on average.
    pub(crate) makings: f64,
    /// Discs whose lists are rebuilt, on average.
    pub(crate) remade: f64,
    /// Entries of the lists that are rebuilt, on average.
    pub(crate) relisted: f64,
}

/// A number for each of the [`Amounts`].
pub(crate) type Units = [f64; 8];

impl Amounts {
    /// The amounts by unit.
    pub(crate) fn values(&self) -> Units {
        let Amounts { steps, discs, cells, candidates, contacts, makings, remade, relisted } = *self;
        [steps, discs, cells, candidates, contacts, makings, remade, relisted]
    }
}

/// Nanoseconds of each unit in the phases of a method, by phase and precision.
pub(crate) type Rates = BTreeMap<String, BTreeMap<String, Units>>;

/// The part of the phase `index` in which lists are made.
pub(crate) const MAKING: &str = "making lists";

/// Nanoseconds of a phase.
///
/// # Errors
/// [`OutOfRange`] where the precision was not measured.
pub(crate) fn phase(
    rates: &Rates,
    phase: &str,
    precision: &str,
    amounts: &Amounts,
) -> Result<f64, OutOfRange> {
    let of = |units: &BTreeMap<String, Units>| {
        let units = units.get(precision);
        let units = units.ok_or_else(|| OutOfRange::NotMeasured(format!("precision {precision}")))?;
        Ok(units.iter().zip(amounts.values()).map(|(unit, amount)| unit * amount).sum::<f64>())
    };
    let making = (phase == "index").then_some(MAKING);
    [Some(phase), making].into_iter().flatten().filter_map(|name| rates.get(name)).map(of).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_phase_is_the_sum_of_its_units_and_of_making_lists() {
        let of = |units: Units| BTreeMap::from([("f64".to_owned(), units)]);
        let index = of([7.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let making = of([0.0, 0.0, 0.0, 0.0, 0.0, 100.0, 5.0, 0.0]);
        let rates = Rates::from([("index".to_owned(), index), (MAKING.to_owned(), making)]);
        let amounts =
            Amounts { steps: 1.0, discs: 1000.0, makings: 0.1, remade: 100.0, ..Amounts::default() };
        assert_eq!(phase(&rates, "index", "f64", &amounts), Ok(7.0 + 2000.0 + 10.0 + 500.0));
        assert_eq!(phase(&rates, "forces", "f64", &amounts), Ok(0.0));
        assert!(matches!(phase(&rates, "index", "f16", &amounts), Err(OutOfRange::NotMeasured(_))));
    }
}
