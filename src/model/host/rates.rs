//! Work whose amount depends on the data: a time for each disc, cell, candidate and contact, by the number of discs, for
//! the level of memory depends on it.

use super::cost::{OutOfRange, interpolated};
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
        Amounts {
            steps: mean(self.steps, other.steps),
            discs: mean(self.discs, other.discs),
            cells: mean(self.cells, other.cells),
            candidates: mean(self.candidates, other.candidates),
            contacts: mean(self.contacts, other.contacts),
            remade: mean(self.remade, other.remade),
            relisted: mean(self.relisted, other.relisted),
        }
    }
}

/// What the phases of a method take whose work depends on the data.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rates {
    /// Numbers of discs at which was measured.
    pub discs: Vec<usize>,
    /// The phases by name; making lists is one of its own.
    pub phases: BTreeMap<String, PhaseRate>,
}

/// A phase.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PhaseRate {
    /// How many times as long everything takes with each number of discs: they lie farther away.
    pub slower: Vec<f64>,
    /// Nanoseconds of each unit, by precision; units that cost nothing are left out.
    pub ns: BTreeMap<String, BTreeMap<String, f64>>,
}

/// The part of the phase `index` in which lists are made.
pub const MAKING: &str = "making lists";

impl Rates {
    /// Nanoseconds of a phase.
    ///
    /// # Errors
    /// [`OutOfRange`] where the precision was not measured, or not so many discs.
    pub fn phase(&self, precision: &str, phase: &str, amounts: &Amounts) -> Result<f64, OutOfRange> {
        let (Some(&fewest), Some(&most)) = (self.discs.first(), self.discs.last()) else { return Ok(0.0) };
        let discs = amounts.discs as usize;
        if discs < fewest || discs > most {
            return Err(OutOfRange::Discs { discs, fewest, most });
        }
        let of = |phase: &PhaseRate| {
            let units = phase
                .ns
                .get(precision)
                .ok_or_else(|| OutOfRange::NotMeasured(format!("precision {precision}")))?;
            let slower: Vec<(f64, f64)> = self
                .discs
                .iter()
                .zip(&phase.slower)
                .map(|(&discs, &slower)| (discs as f64, slower))
                .collect();
            let each = Amounts::NAMES.iter().zip(amounts.values());
            let sum: f64 = each.map(|(name, amount)| units.get(*name).copied().unwrap_or(0.0) * amount).sum();
            Ok(interpolated(&slower, amounts.discs) * sum)
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
        let units = BTreeMap::from([("disc".to_owned(), 2.0)]);
        let phase = PhaseRate { slower: vec![1.0, 3.0], ns: BTreeMap::from([("f64".to_owned(), units)]) };
        let making = BTreeMap::from([("remade".to_owned(), 5.0)]);
        let making = PhaseRate { slower: vec![1.0, 1.0], ns: BTreeMap::from([("f64".to_owned(), making)]) };
        let phases = BTreeMap::from([("index".to_owned(), phase), (MAKING.to_owned(), making)]);
        let rates = Rates { discs: vec![100, 10_000], phases };
        let at = |discs| rates.phase("f64", "index", &Amounts { discs, remade: 10.0, ..Amounts::default() });
        assert!((at(1000.0).unwrap() - (2.0 * 2000.0 + 50.0)).abs() < 1e-9);
        assert!(matches!(at(99.0), Err(OutOfRange::Discs { fewest: 100, most: 10_000, .. })));
        assert!(matches!(
            rates.phase("f16", "index", &Amounts { discs: 200.0, ..Amounts::default() }),
            Err(OutOfRange::NotMeasured(_))
        ));
        assert_eq!(rates.phase("f64", "forces", &Amounts { discs: 200.0, ..Amounts::default() }), Ok(0.0));
    }
}
