//! How long a run has to be so that its bar comes out as small as planned: the variance that a plan is made of is itself an estimate, and that of the run is
//! another one.

use super::sample::Known;
use stripmine_physics::averages::{MOST_WAVES, student};

/// The probability with which a bar comes out as small as planned; that of bars themselves.
const SURE: f64 = 0.95;
/// Rounds in which the time and its degrees of freedom are found, one given the other.
const ROUNDS: usize = 8;

impl Known {
    /// The bar that a mean over some time has at most with a probability of 95 %.
    pub fn bar_over(&self, time: f64) -> f64 {
        // What does not vary is known from any time.
        if self.square == 0.0 { 0.0 } else { (self.square * self.margin(time) / time).sqrt() }
    }

    /// The time over which a mean has a bar of at most `bar` with a probability of 95 % (time).
    pub fn time_for(&self, bar: f64) -> f64 {
        let least = self.square / (bar * bar);
        // The margin falls with the time.
        (0..ROUNDS).fold(least, |time, _| least * self.margin(time))
    }

    /// How many times larger the square of a bar over some time may come out than that which follows from the trials.
    ///
    /// The square of a bar is t² s² over the time, with t of Student's distribution. Its two values of s², each a χ² over its degrees of freedom, have a ratio
    /// that follows the F distribution.
    fn margin(&self, time: f64) -> f64 {
        if self.square == 0.0 || !self.freedoms.is_finite() {
            return 1.0;
        }
        let most = MOST_WAVES as f64;
        let seen = self.freedoms.max(1.0);
        // The waves that a bar is made of grow at least with the root of the time up to a number; the time that was seen is the square over the bar's own.
        let longer = time * self.bar * self.bar / self.square;
        let planned = (seen * longer.sqrt()).clamp(1.0, most.max(seen));
        let t = |freedoms: f64| student(SURE, freedoms as usize);
        (t(planned) / t(seen)).powi(2) * largest_ratio(planned, seen)
    }
}

/// The ratio of two variances by these degrees of freedom that is not passed with a probability of 95 %.
fn largest_ratio(above: f64, below: f64) -> f64 {
    // In x = ν₁ F/(ν₁ F + ν₂) the distribution is an incomplete beta function (Abramowitz and Stegun, 26.6.2).
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if incomplete_beta(middle, 0.5 * above, 0.5 * below) < SURE { low = middle } else { high = middle }
    }
    below * low / (above * (1.0 - low))
}

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

/// Terms of the fraction at most: some times the root of the degrees of freedom are needed.
const TERMS: u32 = 2000;

fn not_zero(value: f64) -> f64 {
    if value.abs() < 1e-300 { 1e-300 } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// The table of every textbook: F at 95 %, by the degrees of freedom above and below.
    #[test]
    fn ratios_of_variances_are_those_of_the_tables() {
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
            let found = largest_ratio(above, below);
            assert!((found / f - 1.0).abs() < 1e-3, "{above} {below}: {found}");
        }
    }

    /// Bars as averages have them, of independent normal values with a variance of 1: by 1.2 √n of their waves, at most 16, whose squares are independent. The plan is
    /// made of some values, and the bar of another run of the planned length is to be as small as asked. Of 2000 plans each.
    #[test]
    fn bars_come_out_as_small_as_planned() {
        let mut state = 7_u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
        };
        let waves = |count: usize| ((1.2 * (count as f64).sqrt()) as usize).clamp(1, 16);
        // The bar of a mean of so many values.
        let mut bar = |count: usize| {
            let square = |_| -2.0 * libm::log(uniform()) * libm::cos(2.0 * PI * uniform()).powi(2);
            let mean_square = (0..waves(count)).map(square).sum::<f64>() / waves(count) as f64;
            student(0.95, waves(count)) * (mean_square / count as f64).sqrt()
        };
        for (seen, asked) in [(30, 0.2), (70, 0.15), (100, 0.1), (400, 0.1), (400, 0.05)] {
            let plans = 2000;
            let kept = (0..plans)
                .filter(|_| {
                    let first = bar(seen);
                    let known = Known {
                        mean: 0.0,
                        bar: first,
                        square: first * first * seen as f64,
                        transient: 0.0,
                        apart: 1.0,
                        freedoms: waves(seen) as f64,
                    };
                    bar((known.time_for(asked).ceil() as usize).max(2)) <= asked
                })
                .count();
            let share = kept as f64 / f64::from(plans);
            // Three standard errors of the share, and the rounding of waves and values.
            assert!((0.935..0.975).contains(&share), "{seen}: {share}");
        }
    }

    #[test]
    fn what_does_not_vary_needs_no_time() {
        let known =
            Known { mean: 1.0, bar: 0.0, square: 0.0, transient: 0.0, apart: 0.0, freedoms: f64::INFINITY };
        assert_eq!((known.time_for(0.1), known.bar_over(3.0), known.bar_over(0.0)), (0.0, 0.0, 0.0));
    }
}
