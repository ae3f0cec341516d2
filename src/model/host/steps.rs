//! Steps whose work depends on the data: timed at some numbers of discs and densities, and interpolated between these.

use super::costs::shares;
use super::out_of_range::OutOfRange;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Nanoseconds by number of discs, and for each of these by density.
pub type Grid = Vec<Vec<f64>>;

/// The phases of steps as they were timed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Steps {
    /// Numbers of discs, rising.
    pub discs: Vec<f64>,
    /// Occupancies, on cells as wide as the radius, rising.
    pub occupancies: Vec<f64>,
    /// Nanoseconds of a phase, by method, precision and phase.
    pub ns: BTreeMap<String, BTreeMap<String, BTreeMap<String, Grid>>>,
}

impl Steps {
    /// Nanoseconds of a phase: between neighbouring points a power law of the number of discs and of the density.
    ///
    /// # Errors
    /// [`OutOfRange`] where the method or the precision was not timed, or not that number of discs or that density.
    pub fn phase(
        &self,
        (method, precision, phase): (&str, &str, &str),
        (discs, occupancy): (f64, f64),
    ) -> Result<f64, OutOfRange> {
        for (what, points, value) in
            [("discs", &self.discs, discs), ("discs a cell", &self.occupancies, occupancy)]
        {
            let ends = [points.first(), points.last()].map(|end| end.copied().unwrap_or(f64::NAN));
            if !(ends[0]..=ends[1]).contains(&value) {
                return Err(OutOfRange::Discs { what, value, ends });
            }
        }
        let unmeasured = || OutOfRange::NotMeasured(format!("{method}, {precision}"));
        let phases = self.ns.get(method).and_then(|of| of.get(precision)).ok_or_else(unmeasured)?;
        let Some(grid) = phases.get(phase) else { return Ok(0.0) };
        let by_occupancy = shares(&self.occupancies, occupancy);
        let row = |ns: &Vec<f64>| {
            let logarithms = ns.iter().map(|ns| ns.max(f64::MIN_POSITIVE).ln());
            logarithms.zip(&by_occupancy).map(|(ln, share)| share * ln).sum::<f64>()
        };
        let by_discs = shares(&self.discs, discs);
        Ok(grid.iter().map(row).zip(by_discs).map(|(ln, share)| share * ln).sum::<f64>().exp())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_points_there_are_power_laws_and_beyond_the_ends_nothing() {
        let grid = vec![vec![1000.0, 500.0], vec![20_000.0, 5000.0]];
        let phases = BTreeMap::from([("index".to_owned(), grid)]);
        let precisions = BTreeMap::from([("f64".to_owned(), phases)]);
        let ns = BTreeMap::from([("fast".to_owned(), precisions)]);
        let steps = Steps { discs: vec![100.0, 10_000.0], occupancies: vec![0.01, 0.16], ns };
        let at = |phase, discs, occupancy| steps.phase(("fast", "f64", phase), (discs, occupancy));
        assert!((at("index", 100.0, 0.01).unwrap() - 1000.0).abs() < 1e-9);
        assert!((at("index", 100.0, 0.04).unwrap() - 707.106_781).abs() < 1e-3);
        assert!((at("index", 1000.0, 0.01).unwrap() - 4472.135_954).abs() < 1e-3);
        assert!((at("index", 1000.0, 0.04).unwrap() - 2659.147_948).abs() < 1e-3);
        assert_eq!(at("forces", 1000.0, 0.04), Ok(0.0));
        for (discs, occupancy) in [(99.0, 0.1), (10_001.0, 0.1), (1000.0, 0.17)] {
            assert!(matches!(at("index", discs, occupancy), Err(OutOfRange::Discs { .. })));
        }
        let other = steps.phase(("fast", "f16", "index"), (1000.0, 0.1));
        assert!(matches!(other, Err(OutOfRange::NotMeasured(_))));
    }
}
