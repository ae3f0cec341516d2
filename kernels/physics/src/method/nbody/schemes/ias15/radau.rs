//! Polynomials of the acceleration through the eight Gauss–Radau nodes of a step, as powers and in Newton's form.
//!
//! With s from 0 at the beginning of a step to 1 at its end, a(s) = a₀ + b₀ s + … + b₆ s⁷ = a₀ + g₀ s + g₁ s (s − h₁) + … .

#![allow(
    clippy::excessive_precision,
    reason = "constants have more digits than the compiler keeps, so that it rounds them"
)]

/// Coefficients of a polynomial beside the acceleration at the beginning.
pub(super) const COEFFICIENTS: usize = 7;

/// Nodes of a step: zeros of the Legendre polynomials P₇(2 s − 1) + P₈(2 s − 1), of which the first is the beginning.
pub(super) const NODES: [f64; COEFFICIENTS + 1] = [
    0.0,
    0.056_262_560_536_922_146_466,
    0.180_240_691_736_892_364_988,
    0.352_624_717_113_169_637_374,
    0.547_153_626_330_555_383_001,
    0.734_210_177_215_410_531_523,
    0.885_320_946_839_095_768_090,
    0.977_520_613_561_287_501_891,
];

/// Coefficients of s^(k+1) in the n-th product s (s − h₁) … (s − hₙ), as row n and column k: bₖ is the sum of these times gₙ.
const TO_POWERS: [[f64; COEFFICIENTS]; COEFFICIENTS] = [
    [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [-0.056_262_560_536_922_146_466, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.010_140_802_830_063_629_986, -0.236_503_252_273_814_511_45, 1.0, 0.0, 0.0, 0.0, 0.0],
    [
        -0.003_575_897_729_251_617_594_9,
        0.093_537_695_259_462_065_896,
        -0.589_127_969_386_984_148_83,
        1.0,
        0.0,
        0.0,
        0.0,
    ],
    [
        0.001_956_565_409_947_221_076_9,
        -0.054_755_386_889_068_686_441,
        0.415_881_200_082_306_861_69,
        -1.136_281_595_717_539_531_8,
        1.0,
        0.0,
        0.0,
    ],
    [
        -0.001_436_530_236_370_891_542_4,
        0.042_158_527_721_268_707_707,
        -0.360_099_596_502_056_812_29,
        1.250_150_711_840_691_025_9,
        -1.870_491_772_932_950_063_4,
        1.0,
        0.0,
    ],
    [
        0.001_271_790_309_026_867_749_3,
        -0.038_760_357_915_906_770_37,
        0.360_962_243_452_845_983_23,
        -1.466_884_208_400_426_964_4,
        2.906_136_259_308_429_301_4,
        -2.755_812_719_772_045_831_4,
        1.0,
    ],
];

/// Coefficients of bₖ in gₙ, as row n and column k: the inverse of [`TO_POWERS`].
const TO_NEWTON: [[f64; COEFFICIENTS]; COEFFICIENTS] = [
    [
        1.0,
        0.056_262_560_536_922_146_466,
        0.003_165_475_718_170_829_25,
        1.780_977_692_217_433_881_1e-4,
        1.002_023_652_232_912_721e-5,
        5.637_641_639_318_207_610_4e-7,
        3.171_881_540_176_136_647_6e-8,
    ],
    [
        0.0,
        1.0,
        0.236_503_252_273_814_511_45,
        0.045_792_985_506_027_918_895,
        0.008_431_857_153_525_701_544_5,
        0.001_529_784_002_500_465_818_9,
        2.762_930_909_826_476_593_1e-4,
    ],
    [
        0.0,
        0.0,
        1.0,
        0.589_127_969_386_984_148_83,
        0.253_534_069_054_569_266_52,
        0.097_834_236_532_444_005_365,
        0.036_028_553_983_736_459_6,
    ],
    [
        0.0,
        0.0,
        0.0,
        1.0,
        1.136_281_595_717_539_531_8,
        0.875_254_664_684_091_091_23,
        0.576_733_000_277_078_731_35,
    ],
    [0.0, 0.0, 0.0, 0.0, 1.0, 1.870_491_772_932_950_063_4, 2.248_588_760_769_159_793_4],
    [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 2.755_812_719_772_045_831_4],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
];

/// Coefficients of powers from those of Newton's form.
pub(super) fn powers_of(newton: &[f64; COEFFICIENTS]) -> [f64; COEFFICIENTS] {
    std::array::from_fn(|k| (k..COEFFICIENTS).rev().map(|n| TO_POWERS[n][k] * newton[n]).sum())
}

/// Coefficients of Newton's form from those of powers.
pub(super) fn newton_of(powers: &[f64; COEFFICIENTS]) -> [f64; COEFFICIENTS] {
    std::array::from_fn(|n| (n..COEFFICIENTS).rev().map(|k| TO_NEWTON[n][k] * powers[k]).sum())
}

/// Divided difference that makes Newton's form pass through `change` (the acceleration less that at the beginning) at a node: the coefficient of
/// the product that vanishes at all earlier nodes.
pub(super) fn divided_difference(node: usize, change: f64, newton: &[f64; COEFFICIENTS]) -> f64 {
    let mut value = change / NODES[node];
    for earlier in 1..node {
        value = (value - newton[earlier - 1]) / (NODES[node] - NODES[earlier]);
    }
    value
}

/// Coefficients of the same polynomial over the next step, which is `ratio` times as long and begins at the end of this one.
pub(super) fn continued(powers: &[f64; COEFFICIENTS], ratio: f64) -> [f64; COEFFICIENTS] {
    let mut scale = 1.0;
    std::array::from_fn(|k| {
        scale *= ratio;
        // Σ over j ≥ k of the binomial coefficient of j + 1 over k + 1, times bⱼ.
        let (mut binomial, mut sum) = (1.0, 0.0);
        for (j, power) in powers.iter().enumerate().skip(k) {
            sum += binomial * power;
            binomial *= (j + 2) as f64 / (j + 1 - k) as f64;
        }
        scale * sum
    })
}

/// Sum of two numbers, and its rounding error (Knuth).
pub(super) fn two_sum(a: f64, b: f64) -> [f64; 2] {
    let sum = a + b;
    let second = sum - a;
    [sum, (a - (sum - second)) + (b - second)]
}

/// Mean of the acceleration over a part `s` of a step of length `h`, with its low part; and its double integral.
pub(super) fn integrals(start: f64, powers: &[f64; COEFFICIENTS], s: f64, h: f64) -> ([f64; 2], f64) {
    let (mut once, mut twice) = (0.0, 0.0);
    for (k, power) in powers.iter().enumerate().rev() {
        let order = (k + 2) as f64;
        once = s * (once + power / order);
        twice = s * (twice + power / (order * (order + 1.0)));
    }
    (two_sum(start, once), h * h * s * s * (0.5 * start + twice))
}

#[cfg(test)]
mod tests {
    use super::*;

    const POWERS: [f64; COEFFICIENTS] = [0.7, -1.3, 0.4, 2.1, -0.6, 1.7, -0.9];

    fn value(powers: &[f64; COEFFICIENTS], s: f64) -> f64 {
        powers.iter().rev().fold(0.0, |sum, power| s * (sum + power))
    }

    /// The nodes integrate all polynomials of degree 14 exactly: each power of s gives 1/(k + 1).
    #[test]
    fn nodes_integrate_fourteen_powers_exactly() {
        // Weights from the integrals of Lagrange's polynomials, by Gauss elimination of the first eight moments.
        let mut rows: Vec<Vec<f64>> = (0..8)
            .map(|k: i32| NODES.iter().map(|h| h.powi(k)).chain([1.0 / f64::from(k + 1)]).collect())
            .collect();
        for pivot in 0..8 {
            let best = (pivot..8).max_by(|&a, &b| rows[a][pivot].abs().total_cmp(&rows[b][pivot].abs()));
            rows.swap(pivot, best.unwrap());
            for row in (0..8).filter(|&row| row != pivot) {
                let factor = rows[row][pivot] / rows[pivot][pivot];
                let of_pivot = rows[pivot].clone();
                rows[row].iter_mut().zip(&of_pivot).for_each(|(value, of)| *value -= factor * of);
            }
        }
        for k in 0..15 {
            let sum: f64 = (0..8).map(|n| rows[n][8] / rows[n][n] * NODES[n].powi(k)).sum();
            assert!((sum - 1.0 / f64::from(k + 1)).abs() < 1e-13, "{k}: {sum}");
        }
    }

    /// Newton's form and the powers are the same polynomial, by direct products.
    #[test]
    fn both_forms_are_one_polynomial() {
        let newton = newton_of(&POWERS);
        for s in [0.0, 0.2, 0.5, 0.9, 1.0] {
            let (mut product, mut sum) = (1.0, 0.0);
            for n in 0..COEFFICIENTS {
                product *= s - NODES[n];
                sum += newton[n] * product;
            }
            assert!((sum - value(&POWERS, s)).abs() < 1e-14, "{s}: {sum}");
        }
        for (again, power) in powers_of(&newton).iter().zip(POWERS) {
            assert!((again - power).abs() < 1e-14);
        }
        for node in 1..=COEFFICIENTS {
            let found = divided_difference(node, value(&POWERS, NODES[node]), &newton);
            assert!((found - newton[node - 1]).abs() < 2e-12, "{node}: {found}");
        }
    }

    #[test]
    fn continued_polynomials_agree_beyond_the_step() {
        let next = continued(&POWERS, 0.5);
        for s in [0.3, 1.0] {
            let change = value(&POWERS, 1.0 + 0.5 * s) - value(&POWERS, 1.0);
            assert!((value(&next, s) - change).abs() < 1e-12, "{s}");
        }
    }

    /// By hand: a = 3 + 4 s over a step of 2 has the mean 3 + 2 s and the double integral 4 (3/2 s² + 2/3 s³).
    #[test]
    fn integrals_match_a_hand_sum() {
        let linear = [4.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let ([mean, _], twice) = integrals(3.0, &linear, 0.5, 2.0);
        assert!((mean - 4.0).abs() < 1e-15 && (twice - 4.0 * (0.375 + 1.0 / 12.0)).abs() < 1e-15);
    }
}
