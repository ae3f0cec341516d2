//! Density waves along an axis: what tells them from an even spread.

use std::f64::consts::TAU;

/// How many places lie in each of `bins` equal parts of `0..length`. What lies at a rim, or beyond, is in the bin there.
pub fn histogram(places: impl IntoIterator<Item = f64>, length: f64, bins: usize) -> Vec<u32> {
    let mut counts = vec![0; bins];
    for place in places {
        counts[((place / length * bins as f64) as usize).min(bins - 1)] += 1;
    }
    counts
}

/// Variance over mean of counts, the Fano factor: 1 where particles are independent, less where they keep their
/// distance, more where they gather. The variance is that of the counts themselves (divided by their number).
pub fn fano(counts: &[u32]) -> f64 {
    let n = counts.len() as f64;
    let mean = counts.iter().sum::<u32>() as f64 / n;
    counts.iter().map(|&count| (f64::from(count) - mean).powi(2)).sum::<f64>() / n / mean
}

/// The strongest Fourier amplitude of the density at wavelengths from `shortest` on, as a fraction of the particles:
/// 1 if all stand at distances of one wavelength, about 1/√N if they stand anywhere.
pub fn strongest_mode(places: &[f64], length: f64, shortest: f64) -> f64 {
    let amplitude = |mode: usize| {
        let turn = TAU * mode as f64 / length;
        let sums = places.iter().fold([0.0; 2], |[cosines, sines], place| {
            let angle = turn * place;
            [cosines + libm::cos(angle), sines + libm::sin(angle)]
        });
        sums[0].hypot(sums[1]) / places.len() as f64
    };
    (1..=(length / shortest) as usize).map(amplitude).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_even_spread_has_no_variance_and_a_heap_has_all_of_it() {
        assert_eq!(fano(&histogram((0..40).map(|i| 0.05 + 0.1 * f64::from(i)), 4.0, 4)), 0.0);
        // Everything in one of four bins: mean 10, variance (30² + 3·10²)/4.
        assert_eq!(fano(&histogram([0.5; 40], 4.0, 4)), 30.0);
    }

    #[test]
    fn rims_are_inside() {
        assert_eq!(histogram([0.0, 4.0, 4.1, -0.1], 4.0, 4), [2, 0, 0, 2]);
    }

    #[test]
    fn a_wave_is_seen_at_its_wavelength_and_not_below_the_shortest() {
        let places: Vec<f64> = (0..400).map(|i| 2.0 * f64::from(i % 5)).collect();
        assert!((strongest_mode(&places, 10.0, 2.0) - 1.0).abs() < 1e-12);
        assert!(strongest_mode(&places, 10.0, 2.5) < 1e-12);
    }
}
