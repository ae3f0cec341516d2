//! Density waves along an axis, and statistics that distinguish them from a uniform distribution.

use serde::Serialize;
use std::f64::consts::TAU;

/// Histogram of positions in `bins` equal parts of `0..length`. Positions at an end or beyond are counted in the bin there.
pub fn histogram(places: impl IntoIterator<Item = f64>, length: f64, bins: usize) -> Vec<u32> {
    let mut counts = vec![0; bins];
    for place in places {
        counts[((place / length * bins as f64) as usize).min(bins - 1)] += 1;
    }
    counts
}

/// Fano factor of counts, their variance over their mean: 1 for independent particles, less if they repel, more if they cluster. The variance is
/// that of the counts themselves (divided by their number).
pub fn fano(counts: &[u32]) -> f64 {
    let n = counts.len() as f64;
    let mean = counts.iter().sum::<u32>() as f64 / n;
    counts.iter().map(|&count| (f64::from(count) - mean).powi(2)).sum::<f64>() / n / mean
}

/// Largest Fourier amplitude of the density at wavelengths from `shortest` on, as a fraction of the particles: 1 if all are one wavelength apart,
/// about 1/√N for random positions.
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

/// Directions of waves: the spectral power at wavelengths from `shortest` on, and the fractions of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Directions {
    /// Mean over wavelengths and times of |Σ exp(ikx)|²/N: 1 for independent particles.
    pub power: f64,
    /// Fraction of waves that move towards lower positions.
    pub back: f64,
    /// Fraction that is constant in time.
    pub standing: f64,
    /// Fraction of waves that move towards higher positions.
    pub forth: f64,
    /// Fractions towards lower and towards higher positions of a single wave for each wavelength, with the same strength at all times and the mean
    /// phase velocity of that wavelength. A wave that grows and decays has some power in the opposite direction.
    pub of_one_wave: [f64; 2],
}

/// Directions of the waves in counts taken at equal intervals of time, all with the same bins of `0..length`.
///
/// The density of each wavelength is a complex number that rotates in one direction or the other: a density f(x − ct) rotates by −kc for each unit
/// of time.
pub fn directions(looks: &[Vec<u32>], length: f64, shortest: f64) -> Directions {
    let ([mut back, mut standing, mut forth], mut one_wave) = ([0.0; 3], [0.0; 3]);
    let times = looks.len();
    let modes = (length / shortest) as usize;
    for mode in 1..=modes {
        let amplitudes: Vec<[f64; 2]> =
            looks.iter().map(|counts| transform(mode, counts.iter().map(|&n| [f64::from(n), 0.0]))).collect();
        for (sum, power) in [&mut back, &mut standing, &mut forth].into_iter().zip(powers(&amplitudes)) {
            *sum += power;
        }
        for (sum, power) in one_wave.iter_mut().zip(powers(&of_one_wave(&amplitudes))) {
            *sum += power;
        }
    }
    let all = back + standing + forth;
    let particles = looks.first().map_or(0, |counts| counts.iter().sum::<u32>());
    let power = all / (times * times * modes) as f64 / f64::from(particles);
    Directions {
        power,
        back: back / all,
        standing: standing / all,
        forth: forth / all,
        of_one_wave: [one_wave[0] / all, one_wave[2] / all],
    }
}

/// Spectral power of a wavelength that moves backwards, stands, and moves forwards.
fn powers(amplitudes: &[[f64; 2]]) -> [f64; 3] {
    let times = amplitudes.len();
    let mut powers = [0.0; 3];
    for frequency in 0..times {
        let [re, im] = transform(frequency, amplitudes.iter().copied());
        // Frequencies above the half are negative ones.
        let index = match frequency {
            0 => 1,
            _ if 2 * frequency < times => 0,
            _ => 2,
        };
        powers[index] += re * re + im * im;
    }
    powers
}

/// Wave with the same magnitudes as these at all times and their mean phase change between samples.
fn of_one_wave(amplitudes: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let turned = amplitudes.windows(2).fold([0.0; 2], |[re, im], pair| {
        let [[a, b], [c, d]] = [pair[0], pair[1]];
        [re + a * c + b * d, im + a * d - b * c]
    });
    let turn = libm::atan2(turned[1], turned[0]);
    let at = |(look, [re, im]): (usize, &[f64; 2])| {
        let (sine, cosine) = libm::sincos(turn * look as f64);
        let size = re.hypot(*im);
        [size * cosine, size * sine]
    };
    amplitudes.iter().enumerate().map(at).collect()
}

/// Component of the discrete Fourier transform.
fn transform(frequency: usize, values: impl ExactSizeIterator<Item = [f64; 2]>) -> [f64; 2] {
    let turn = -TAU * frequency as f64 / values.len() as f64;
    values.enumerate().fold([0.0; 2], |[re, im], (i, [a, b])| {
        let (sine, cosine) = libm::sincos(turn * i as f64);
        [re + a * cosine - b * sine, im + a * sine + b * cosine]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counts of a wave with two wavelengths along the bins that moves by `shift` bins between samples.
    fn wave(shift: i32) -> Vec<Vec<u32>> {
        let count = |look: i32, bin: i32| {
            10 + (8.0 * (TAU * f64::from(bin - shift * look) / 16.0).cos()).round() as u32
        };
        (0..16).map(|look| (0..32).map(|bin| count(look, bin)).collect()).collect()
    }

    #[test]
    fn waves_move_in_their_direction() {
        for (shift, expected) in [(1, [0.0, 0.0, 1.0]), (-1, [1.0, 0.0, 0.0]), (0, [0.0, 1.0, 0.0])] {
            let Directions { power, back, standing, forth, of_one_wave } =
                directions(&wave(shift), 32.0, 8.0);
            assert!((of_one_wave[0] - back).abs() < 1e-2 && (of_one_wave[1] - forth).abs() < 1e-2, "{shift}");
            // Mean over samples and wavelengths, as defined.
            let looks = wave(shift);
            let strength = |counts: &[u32], mode: f64| {
                let angle = |bin: usize| TAU * mode * bin as f64 / 32.0;
                let sums = counts.iter().enumerate().fold([0.0; 2], |[a, b], (bin, &count)| {
                    [a + f64::from(count) * angle(bin).cos(), b + f64::from(count) * angle(bin).sin()]
                });
                sums[0].hypot(sums[1]).powi(2) / f64::from(counts.iter().sum::<u32>())
            };
            let of_look = |counts: &Vec<u32>| {
                [1.0, 2.0, 3.0, 4.0].map(|mode| strength(counts, mode)).iter().sum::<f64>()
            };
            let naive = looks.iter().map(of_look).sum::<f64>() / (4.0 * looks.len() as f64);
            assert!((power / naive - 1.0).abs() < 1e-9, "{power} instead of {naive}");
            for (found, expected) in [back, standing, forth].into_iter().zip(expected) {
                assert!((found - expected).abs() < 1e-2, "{shift}: {found} instead of {expected}");
            }
        }
    }

    /// A backward wave that grows and decays has forward power, and so has the single wave of the same strength; two opposite waves have more
    /// forward power than a single wave.
    #[test]
    fn fading_waves_differ_from_opposite_waves() {
        let looks = |of: fn(f64, f64) -> f64| -> Vec<Vec<u32>> {
            let count = |look: i32, bin: i32| {
                (100.0 + of(f64::from(look), TAU * f64::from(bin) / 16.0)).round() as u32
            };
            (0..48).map(|look| (0..32).map(|bin| count(look, bin)).collect()).collect()
        };
        let fades = looks(|look, phase| 80.0 * (-0.1 * look).exp() * (phase + 0.4 * look).cos());
        let Directions { forth, of_one_wave, .. } = directions(&fades, 32.0, 8.0);
        assert!(forth > 0.005 && forth < 1.5 * of_one_wave[1], "{forth} {of_one_wave:?}");
        let both = looks(|look, phase| 60.0 * (phase + 0.4 * look).cos() + 30.0 * (phase - 0.4 * look).cos());
        let Directions { forth, of_one_wave, .. } = directions(&both, 32.0, 8.0);
        assert!(forth > 0.15 && forth > 2.0 * of_one_wave[1], "{forth} {of_one_wave:?}");
    }

    #[test]
    fn fano_is_zero_for_an_even_spread() {
        assert_eq!(fano(&histogram((0..40).map(|i| 0.05 + 0.1 * f64::from(i)), 4.0, 4)), 0.0);
        // All in one of four bins: mean 10, variance (30² + 3·10²)/4.
        assert_eq!(fano(&histogram([0.5; 40], 4.0, 4)), 30.0);
    }

    #[test]
    fn positions_at_the_ends_are_counted() {
        assert_eq!(histogram([0.0, 4.0, 4.1, -0.1], 4.0, 4), [2, 0, 0, 2]);
    }

    #[test]
    fn strongest_mode_respects_the_shortest_wavelength() {
        let places: Vec<f64> = (0..400).map(|i| 2.0 * f64::from(i % 5)).collect();
        assert!((strongest_mode(&places, 10.0, 2.0) - 1.0).abs() < 1e-12);
        assert!(strongest_mode(&places, 10.0, 2.5) < 1e-12);
    }
}
