//! Rates of work whose amount depends on the data: a time for each step, disc, cell, candidate, contact and list entry.

use super::out_of_range::OutOfRange;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Amounts of work in a step: measured in a run, or estimated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Amounts {
    /// Steps, always one: the cost of a phase without work.
    pub steps: f64,
    pub discs: f64,
    /// Cells of the lattice; none for lists.
    pub cells: f64,
    /// Entries of lists; on the lattice the occupied cells in half the mask, for randomly placed discs.
    pub(crate) candidates: f64,
    /// Pairs for which the law is evaluated.
    pub contacts: f64,
    /// Average number of list rebuilds.
    pub(crate) makings: f64,
    /// Average number of discs whose lists are rebuilt.
    pub(crate) remade: f64,
    /// Average number of entries of rebuilt lists.
    pub(crate) relisted: f64,
}

/// One number for each of the [`Amounts`].
pub(crate) type AmountUnits = [f64; 8];

impl Amounts {
    /// Amounts in the order of units.
    pub(crate) fn values(&self) -> AmountUnits {
        let Amounts { steps, discs, cells, candidates, contacts, makings, remade, relisted } = *self;
        [steps, discs, cells, candidates, contacts, makings, remade, relisted]
    }
}

/// Nanoseconds per unit in the phases of a method, by phase and precision.
pub(crate) type PhaseRates = BTreeMap<String, BTreeMap<String, AmountUnits>>;

/// Name of the part of the phase `index` that builds lists.
pub(crate) const MAKING: &str = "making lists";

/// Nanoseconds of a phase.
///
/// # Errors
/// [`OutOfRange`] where the precision was not measured.
pub(crate) fn phase(
    rates: &PhaseRates,
    phase: &str,
    precision: &str,
    amounts: &Amounts,
) -> Result<f64, OutOfRange> {
    let of = |units: &BTreeMap<String, AmountUnits>| {
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
    fn phase_time_includes_list_building() {
        let of = |units: AmountUnits| BTreeMap::from([("f64".to_owned(), units)]);
        let index = of([7.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let making = of([0.0, 0.0, 0.0, 0.0, 0.0, 100.0, 5.0, 0.0]);
        let rates = PhaseRates::from([("index".to_owned(), index), (MAKING.to_owned(), making)]);
        let amounts =
            Amounts { steps: 1.0, discs: 1000.0, makings: 0.1, remade: 100.0, ..Amounts::default() };
        assert_eq!(phase(&rates, "index", "f64", &amounts), Ok(7.0 + 2000.0 + 10.0 + 500.0));
        assert_eq!(phase(&rates, "forces", "f64", &amounts), Ok(0.0));
        assert!(matches!(phase(&rates, "index", "f16", &amounts), Err(OutOfRange::NotMeasured(_))));
    }
}
