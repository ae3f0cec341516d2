//! Student's t distribution, and the F distribution of the ratio of two variances.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};

/// Quantile of Student's t: the number of standard errors to either side that contain the mean with a probability, for at least one degree of
/// freedom.
pub fn student(probability: f64, freedoms: usize) -> f64 {
    // With t = √ν tan θ the probability is a finite sum (Abramowitz and Stegun, 26.7.3 and 26.7.4).
    let within = |angle: f64| {
        let cosine = libm::cos(angle);
        let mut power = freedoms % 2;
        let (mut term, mut sum) = (if power == 1 { cosine } else { 1.0 }, 0.0);
        while power + 2 <= freedoms {
            sum += term;
            term *= cosine * cosine * (power + 1) as f64 / (power + 2) as f64;
            power += 2;
        }
        let sum = sum * libm::sin(angle);
        if freedoms % 2 == 1 { FRAC_2_PI * (angle + sum) } else { sum }
    };
    let (mut low, mut high) = (0.0, FRAC_PI_2);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if within(middle) < probability { low = middle } else { high = middle }
    }
    (freedoms as f64).sqrt() * libm::tan(high)
}

/// Quantile of the F distribution: the ratio of two variances, with `above` and `below` degrees of freedom, that is not exceeded with a
/// probability.
///
/// With one degree of freedom above, it is the square of Student's t, also for fractional degrees of freedom below.
pub fn variance_ratio(probability: f64, above: f64, below: f64) -> f64 {
    // In x = ν₁ F/(ν₁ F + ν₂) the distribution is an incomplete beta function (Abramowitz and Stegun, 26.6.2).
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if incomplete_beta(middle, 0.5 * above, 0.5 * below) < probability {
            low = middle;
        } else {
            high = middle;
        }
    }
    below * low / (above * (1.0 - low))
}

/// Largest number of terms of the continued fraction; it needs a few times the root of the degrees of freedom.
const TERMS: u32 = 2000;

/// The regularised incomplete beta function, by its continued fraction (Abramowitz and Stegun, 26.5.8).
fn incomplete_beta(x: f64, a: f64, b: f64) -> f64 {
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - incomplete_beta(1.0 - x, b, a);
    }
    let front = libm::exp(
        libm::lgamma(a + b) - libm::lgamma(a) - libm::lgamma(b) + a * libm::log(x) + b * libm::log(1.0 - x),
    ) / a;
    let (mut fraction, mut c, mut d) = (1.0, 1.0, 0.0);
    for term in 0..TERMS {
        let m = f64::from(term / 2);
        let numerator = match term {
            0 => 1.0,
            _ if term % 2 == 0 => m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m)),
            _ => -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0)),
        };
        d = 1.0 / not_zero(1.0 + numerator * d);
        c = not_zero(1.0 + numerator / c);
        fraction *= c * d;
        if (c * d - 1.0).abs() < 1e-12 {
            break;
        }
    }
    front * (fraction - 1.0)
}

fn not_zero(value: f64) -> f64 {
    if value.abs() < 1e-300 { 1e-300 } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Textbook table: F at 95 %, by the degrees of freedom above and below.
    #[test]
    fn variance_ratios_match_the_tables() {
        for (above, below, f) in [
            (1.0, 1.0, 161.45),
            (5.0, 2.0, 19.30),
            (2.0, 5.0, 5.786),
            (10.0, 10.0, 2.978),
            (30.0, 30.0, 1.841),
            (120.0, 30.0, 1.683),
            (10_000.0, 30.0, 1.623),
            (10_000.0, 10.0, 2.539),
        ] {
            let found = variance_ratio(0.95, above, below);
            assert!((found / f - 1.0).abs() < 1e-3, "{above} {below}: {found}");
        }
    }

    /// Two formulas agree: a finite sum, and an incomplete beta function.
    #[test]
    fn students_t_squared_is_a_ratio_of_variances() {
        for probability in [0.5, 0.95, 0.99, 0.999] {
            for freedoms in (1..=40).chain([100, 300, 1000]) {
                let [t, f] = [
                    student(probability, freedoms),
                    variance_ratio(probability, 1.0, freedoms as f64).sqrt(),
                ];
                assert!((t / f - 1.0).abs() < 1e-9, "{probability} {freedoms}: {t} {f}");
            }
        }
    }

    /// Textbook table: two-sided probability, degrees of freedom, t.
    #[test]
    fn students_t_matches_the_tables() {
        for (probability, freedoms, t) in [
            (0.95, 1, 12.706),
            (0.95, 2, 4.303),
            (0.95, 3, 3.182),
            (0.999, 7, 5.408),
            (0.95, 19, 2.093),
            (0.99, 30, 2.750),
            (0.95, 120, 1.980),
        ] {
            let found = student(probability, freedoms);
            assert!((found - t).abs() < 5.1e-4, "{probability} {freedoms}: {found}");
        }
    }
}
