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

/// Nanoseconds of each unit at one number of discs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RatePoint {
    /// Discs.
    pub discs: usize,
    /// Nanoseconds by the name of the unit; units that cost nothing are left out.
    pub ns: BTreeMap<String, f64>,
}

/// The rates of a method: by precision and phase.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Rates(pub BTreeMap<String, BTreeMap<String, Vec<RatePoint>>>);

impl Rates {
    /// Nanoseconds of a phase of a step.
    ///
    /// # Errors
    /// [`OutOfRange`] for a precision that was not measured, or another number of discs than those that were.
    pub fn phase(&self, precision: &str, phase: &str, amounts: &Amounts) -> Result<f64, OutOfRange> {
        let phases =
            self.0.get(precision).ok_or_else(|| OutOfRange::NotMeasured(format!("precision {precision}")))?;
        let Some(points) = phases.get(phase) else { return Ok(0.0) };
        let (Some(first), Some(last)) = (points.first(), points.last()) else { return Ok(0.0) };
        let discs = amounts.discs as usize;
        if discs < first.discs || discs > last.discs {
            return Err(OutOfRange::Discs { discs, fewest: first.discs, most: last.discs });
        }
        let unit = |name: &str| {
            let ns =
                points.iter().map(|point| (point.discs as f64, point.ns.get(name).copied().unwrap_or(0.0)));
            interpolated(&ns.collect::<Vec<_>>(), amounts.discs)
        };
        Ok(Amounts::NAMES.iter().zip(amounts.values()).map(|(name, amount)| unit(name) * amount).sum())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_interpolated_and_beyond_the_ends_refused() {
        let point = |discs, ns| RatePoint { discs, ns: BTreeMap::from([("disc".to_owned(), ns)]) };
        let phases = BTreeMap::from([("forces".to_owned(), vec![point(100, 1.0), point(10_000, 3.0)])]);
        let rates = Rates(BTreeMap::from([("f64".to_owned(), phases)]));
        let at = |discs| rates.phase("f64", "forces", &Amounts { discs, ..Amounts::default() });
        assert!((at(1000.0).unwrap() - 2000.0).abs() < 1e-9);
        assert!(matches!(at(99.0), Err(OutOfRange::Discs { fewest: 100, most: 10_000, .. })));
        assert!(matches!(rates.phase("f16", "forces", &Amounts::default()), Err(OutOfRange::NotMeasured(_))));
    }
}
