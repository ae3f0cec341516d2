//! Choice of the mask with the fewest predictions per collision, by ISO99's cost formula.

use super::grid::ExclusiveGridSize;
use crate::domain::Domain;
use crate::method::hard_disks::keys::MASKS;
use stripmine_kernels::mask::Mask;

/// Returns the mask of a name; none for `auto`.
pub fn mask(name: &str) -> Option<Mask> {
    match name {
        "min" => Some(Mask::square(2)),
        _ => name.strip_prefix('r')?.parse().ok().map(Mask::round),
    }
}

/// Mask that may be chosen.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MaskCandidate {
    pub name: &'static str,
    /// Estimated predictions of pairs per collision; infinite if the mask is unsuitable.
    pub(crate) predictions: f64,
}

/// Estimates the cost of each mask: predictions around the two discs of a collision, and a share of the predictions after a refill.
/// The grid is refilled after a flight of the slack at twice the largest speed. ISO99 section 4.
pub(crate) fn candidates(domain: &Domain, radii: [f64; 2], count: usize) -> Vec<MaskCandidate> {
    let sizes = ExclusiveGridSize::new(domain, radii[0]);
    let occupancy = count as f64 / (sizes.cells[0] * sizes.cells[1]) as f64;
    let names = MASKS.iter().filter(|name| mask(name).is_some());
    let of = |name: &&'static str| {
        let mask = mask(name)?;
        let slack = sizes.reach(&mask) - 2.0 * radii[1];
        let serves = sizes.is_wide_enough(domain, &mask) && slack > 0.0;
        let places = mask.offsets().len() as f64;
        // Reading an empty cell costs a fifth of a prediction.
        let around = places * (occupancy + EMPTY);
        let between = collisions_while_flying(domain, radii, count, 0.5 * slack / FASTEST);
        let predictions = 2.0 * around * PER_DISC + count as f64 * around * 0.5 / between.max(1e-300);
        Some(MaskCandidate { name, predictions: if serves { predictions } else { f64::INFINITY } })
    };
    names.filter_map(of).collect()
}

/// Cost of an empty cell of a mask, in predictions.
const EMPTY: f64 = 0.2;
/// Discs predicted again per disc of a collision: itself, and those that have lost their partner.
const PER_DISC: f64 = 1.7;
/// Ratio of the largest to the typical speed.
const FASTEST: f64 = 3.7;

/// Collisions of all discs while one flies a distance (length) at the typical speed, by the mean free path of Henderson's equation.
fn collisions_while_flying(domain: &Domain, radii: [f64; 2], count: usize, distance: f64) -> f64 {
    let radius = 0.5 * (radii[0] + radii[1]);
    let packing = (count as f64 * std::f64::consts::PI * radius * radius / domain.area()).min(0.9);
    let contact_value = (1.0 - 7.0 * packing / 16.0) / (1.0 - packing).powi(2);
    // ω σ/v = 4 ν g √(1/π) · … : ω = (8 ν g/σ) √(kT/(π m)), v = √(2 kT/m).
    let rate = 8.0 * packing * contact_value / (2.0 * radius) / (2.0 * std::f64::consts::PI).sqrt();
    0.5 * count as f64 * rate * distance
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Dense systems prefer the smallest mask, dilute ones a larger one. ISO99 section 4.
    #[test]
    fn dilute_systems_prefer_larger_masks() {
        let best = |packing: f64| {
            let count = 1000;
            let side = (f64::from(count) * std::f64::consts::FRAC_PI_4 / packing).sqrt();
            let domain = Domain::planar([0.0; 2], [side; 2], [true; 2]);
            let all = candidates(&domain, [0.5; 2], count as usize);
            assert_eq!(all.len(), 9);
            let best = all.into_iter().min_by(|a, b| a.predictions.total_cmp(&b.predictions)).unwrap();
            mask(best.name).unwrap().offsets().len()
        };
        let [dense, medium, rare] = [0.7, 0.3, 0.02].map(best);
        assert!(dense <= 36 && dense <= medium && medium < rare, "{dense} {medium} {rare}");
    }

    #[test]
    fn unsuitable_masks_have_infinite_cost() {
        let domain = Domain::planar([0.0; 2], [6.0; 2], [true; 2]);
        let cost = |name: &str, radii: [f64; 2]| {
            candidates(&domain, radii, 10).into_iter().find(|it| it.name == name).unwrap().predictions
        };
        assert!(cost("min", [0.5; 2]).is_finite() && cost("r10", [0.5; 2]).is_infinite());
        // Discs three times as large reach beyond 5 × 5 cells of the smallest disc.
        assert!(cost("min", [0.25, 0.75]).is_infinite());
    }
}
