//! Student's distribution.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};

/// Student's t: the number of standard errors that to either side hold a mean with a probability, by the degrees of freedom, at least one.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The table of every textbook: two-sided probability, degrees of freedom, t.
    #[test]
    fn students_t_is_that_of_the_tables() {
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
