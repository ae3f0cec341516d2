//! Work whose amount depends on the data: a time for each disc, cell, candidate and contact, by the number of discs, for
//! the level of memory depends on it.

use super::levels::shares;
use super::out_of_range::OutOfRange;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// How much there is to do in a step: measured in a run, or estimated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Amounts {
    /// Steps, one: what a phase takes even without work.
    pub steps: f64,
    /// Discs.
    pub discs: f64,
    /// Cells of the lattice; none for lists.
    pub cells: f64,
    /// Entries of lists; on the lattice the occupied cells in half the mask, as if discs lay at random.
    pub candidates: f64,
    /// Pairs that the law is asked about.
    pub contacts: f64,
    /// Discs whose lists are rebuilt, on average.
    pub remade: f64,
    /// Entries of the lists that are rebuilt, on average.
    pub relisted: f64,
}

impl Amounts {
    /// The names of the units, in the order of [`Amounts::values`].
    pub const NAMES: [&'static str; 7] =
        ["step", "disc", "cell", "candidate", "contact", "remade", "relisted"];

    /// The amounts by unit.
    pub fn values(&self) -> [f64; 7] {
        [self.steps, self.discs, self.cells, self.candidates, self.contacts, self.remade, self.relisted]
    }

    /// Each amount with that of another.
    #[must_use]
    pub fn with(&self, other: &Amounts, mean: impl Fn(f64, f64) -> f64) -> Amounts {
        let (ours, theirs) = (self.values(), other.values());
        let [steps, discs, cells, candidates, contacts, remade, relisted] =
            std::array::from_fn(|at| mean(ours[at], theirs[at]));
        Amounts { steps, discs, cells, candidates, contacts, remade, relisted }
    }
}

/// What the phases of a method take whose work depends on the data.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rates {
    /// Numbers of discs at which was measured.
    pub discs: Vec<f64>,
    /// The phases by name; making lists is one of its own.
    pub phases: BTreeMap<String, PhaseRate>,
}

/// A phase.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PhaseRate {
    /// How many times as long everything takes with each number of discs: they lie farther away.
    pub slower: Vec<f64>,
    /// Nanoseconds of each unit in the order of [`Amounts::NAMES`], by precision.
    pub ns: BTreeMap<String, [f64; Amounts::NAMES.len()]>,
}

/// The part of the phase `index` in which lists are made.
pub const MAKING: &str = "making lists";

impl Rates {
    /// Nanoseconds of a phase.
    ///
    /// # Errors
    /// [`OutOfRange`] where the precision was not measured, or not that number of discs.
    pub fn phase(&self, precision: &str, phase: &str, amounts: &Amounts) -> Result<f64, OutOfRange> {
        let (Some(&fewest), Some(&most)) = (self.discs.first(), self.discs.last()) else { return Ok(0.0) };
        if !(fewest..=most).contains(&amounts.discs) {
            return Err(OutOfRange::Discs { discs: amounts.discs, fewest, most });
        }
        let by_discs = shares(&self.discs, amounts.discs);
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let of = |phase: &PhaseRate| {
            let unmeasured = || OutOfRange::NotMeasured(format!("precision {precision}"));
            let units = phase.ns.get(precision).ok_or_else(unmeasured)?;
            Ok(product(&by_discs, &phase.slower) * product(units, &amounts.values()))
        };
        let making = (phase == "index").then_some(MAKING);
        [Some(phase), making].into_iter().flatten().filter_map(|name| self.phases.get(name)).map(of).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn discs_are_interpolated_and_beyond_the_ends_refused() {
        let phase = |slower: [f64; 2], units: [f64; 7]| PhaseRate {
            slower: slower.to_vec(),
            ns: BTreeMap::from([("f64".to_owned(), units)]),
        };
        let index = phase([1.0, 3.0], [0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let making = phase([1.0, 1.0], [0.0, 0.0, 0.0, 0.0, 0.0, 5.0, 0.0]);
        let phases = BTreeMap::from([("index".to_owned(), index), (MAKING.to_owned(), making)]);
        let rates = Rates { discs: vec![100.0, 10_000.0], phases };
        let at = |discs| rates.phase("f64", "index", &Amounts { discs, remade: 10.0, ..Amounts::default() });
        assert!((at(1000.0).unwrap() - (2.0 * 2000.0 + 50.0)).abs() < 1e-9);
        assert!(matches!(at(99.0), Err(OutOfRange::Discs { fewest: 100.0, most: 10_000.0, .. })));
        let some = Amounts { discs: 200.0, ..Amounts::default() };
        assert!(matches!(rates.phase("f16", "index", &some), Err(OutOfRange::NotMeasured(_))));
        assert_eq!(rates.phase("f64", "forces", &some), Ok(0.0));
    }
}
