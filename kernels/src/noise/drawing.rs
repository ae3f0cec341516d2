//! Normal random numbers for many particles at once, as a thermostat draws them in every step.
//!
//! ```text
//! words       Philox of (seed, purpose, id, step)       four of 32 bits
//! uniform     the first two: u in (0, 1), of 52 bits    the third and fourth: a turn in (−1/8, 1/8), and which quarter
//! normal      √(−2 ln u) times cosine and sine of the turn (Box and Muller)
//! ```
//!
//! Each is a loop over the particles without branches, of additions, products, quotients, roots and bit operations. So the
//! compiler vectorises it for any instruction set, with the same bits. Logarithm, sine and cosine are series, accurate to one or
//! two units in the last place; radii go up to √(2 · 53 ln 2) = 8.6.

use super::{RandomPurpose, philox4x32, top_word};
use crate::isa::Element;

/// Terms of ln((1 + s)/(1 − s)) = 2 s (1 + s²/3 + s⁴/5 + …): |s| ≤ 0.172, so that the next is below 10⁻¹⁷ of the sum.
const LOGARITHM: usize = 11;
/// Coefficients of sine and cosine, up to an eighth of a turn to 5·10⁻¹⁷.
const SINE: [f64; 8] = alternating(1);
const COSINE: [f64; 9] = alternating(0);

/// (−1)^k/(2 k + first)!.
const fn alternating<const N: usize>(first: u32) -> [f64; N] {
    let mut terms = [1.0; N];
    let mut k = 1;
    while k < N {
        let last = 2.0 * k as f64 + first as f64;
        terms[k] = -terms[k - 1] / (last * (last - 1.0));
        k += 1;
    }
    terms
}

/// `Σ terms[k] z^k`.
#[inline(always)]
fn polynomial<const N: usize>(terms: [f64; N], z: f64) -> f64 {
    let mut sum = terms[N - 1];
    for k in (0..N - 1).rev() {
        sum = sum * z + terms[k];
    }
    sum
}

/// Natural logarithm of a positive normal number.
#[inline(always)]
fn logarithm(x: f64) -> f64 {
    // x = 2^k m with m between √½ and √2.
    const LOWEST: u64 = 0x3FE6_A09E_0000_0000;
    const MANTISSA: u64 = (1 << 52) - 1;
    let shifted = x.to_bits() + (1f64.to_bits() - LOWEST);
    let exponent = (shifted >> 52) as i32 - 1023;
    let m = f64::from_bits((shifted & MANTISSA) + LOWEST);
    let s = (m - 1.0) / (m + 1.0);
    const TERMS: [f64; LOGARITHM] = {
        let mut terms = [2.0; LOGARITHM];
        let mut k = 0;
        while k < LOGARITHM {
            terms[k] = 2.0 / (2 * k + 1) as f64;
            k += 1;
        }
        terms
    };
    f64::from(exponent) * std::f64::consts::LN_2 + s * polynomial(TERMS, s * s)
}

/// A number in (0, 1) from the upper 52 bits.
#[inline(always)]
fn open_unit(bits: u64) -> f64 {
    const HALF_STEP: f64 = 1.0 / (1u64 << 53) as f64;
    f64::from_bits(bits >> 12 | 1f64.to_bits()) - (1.0 - HALF_STEP)
}

/// Two independent standard normal numbers from the words of a generator.
#[inline(always)]
fn box_muller(words: [u32; 4]) -> [f64; 2] {
    let [a, b, c, d] = words.map(u64::from);
    let radius = (-2.0 * logarithm(open_unit(a << 32 | b))).sqrt();
    // The two highest bits select the quarter; the others are a turn of −1/8 to 1/8.
    let angle = (open_unit(c << 34 | d << 2) - 0.5) * std::f64::consts::FRAC_PI_2;
    let z = angle * angle;
    let (cosine, sine) = (polynomial(COSINE, z), angle * polynomial(SINE, z));
    let quarter = c >> 30;
    let is_odd = quarter & 1 == 1;
    let (x, y) = (if is_odd { sine } else { cosine }, if is_odd { cosine } else { sine });
    // Rotates by 0, 1, 2, 3 quarters: (c, s), (−s, c), (−c, −s), (s, −c).
    let turned = |value: f64, sign: u64| f64::from_bits(value.to_bits() ^ (sign << 63));
    [radius * turned(x, (quarter ^ quarter >> 1) & 1), radius * turned(y, quarter >> 1)]
}

/// Draws two independent standard normal numbers of (seed, purpose, id, step) for each id. They differ from those of
/// [`normals`](super::normals).
///
/// It must be inlined into code that is compiled for an instruction set. Outputs shorter than `ids` receive the first numbers
/// only.
#[inline(always)]
pub fn draw<S: Element>(seed: u64, purpose: RandomPurpose, step: u64, ids: &[u32], to: [&mut [S]; 2]) {
    let key = [seed as u32, (seed >> 32) as u32];
    let [across, along] = to;
    let top = top_word(purpose, step, 0);
    for ((&id, x), y) in ids.iter().zip(across).zip(along) {
        let [a, b] = box_muller(philox4x32([id, step as u32, 0, top], key));
        *x = S::from_f64(a);
        *y = S::from_f64(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::InstructionSet;
    use crate::backend::{RegisterTask, Registers, dispatch};

    struct Drawing<'a> {
        step: u64,
        ids: &'a [u32],
        to: [&'a mut [f64]; 2],
    }

    impl RegisterTask<f64> for Drawing<'_> {
        #[inline(always)]
        fn on<R: Registers<Lane = f64>>(self, _: R) {
            draw(3, RandomPurpose::Test, self.step, self.ids, self.to);
        }
    }

    fn drawn(set: InstructionSet, step: u64, ids: &[u32]) -> [Vec<f64>; 2] {
        let mut numbers = [vec![0.0; ids.len()], vec![0.0; ids.len()]];
        let [x, y] = &mut numbers;
        dispatch(set, Drawing { step, ids, to: [x, y] }).unwrap();
        numbers
    }

    /// Compares with the portable library, at both ends and in the middle of the range.
    #[test]
    fn logarithm_sine_and_cosine_match_libm() {
        let mut u = 1.0 / (1u64 << 53) as f64;
        while u < 1.0 {
            for x in [u, u * 1.000_01, u * 1.41, u * 1.42, 1.0 - 0.5 * u] {
                let expected = libm::log(x);
                assert!((logarithm(x) - expected).abs() <= 4e-16 * expected.abs(), "{x:e}");
            }
            u *= 2.0;
        }
        for at in -1000..=1000 {
            let angle = f64::from(at) / 1000.0 * std::f64::consts::FRAC_PI_4;
            let z = angle * angle;
            assert!((polynomial(COSINE, z) - libm::cos(angle)).abs() < 3e-16);
            assert!((angle * polynomial(SINE, z) - libm::sin(angle)).abs() < 3e-16);
        }
    }

    /// Checks the four quarters from given words: cosine and sine of the angle they encode.
    #[test]
    fn angles_cover_every_quarter() {
        for quarter in 0..4u32 {
            for part in [0u32, 1 << 20, 1 << 29, (1 << 30) - 1] {
                let words = [0x2000_0000, 0, quarter << 30 | part, 7];
                let [x, y] = box_muller(words);
                let turn = (f64::from(part) + 7.0 / 4_294_967_296.0) / f64::from(1 << 30);
                let angle = std::f64::consts::FRAC_PI_2 * (f64::from(quarter) + turn - 0.5);
                let radius = (-2.0 * libm::log(0.125)).sqrt();
                assert!((x - radius * libm::cos(angle)).abs() < 1e-14, "{quarter} {part}");
                assert!((y - radius * libm::sin(angle)).abs() < 1e-14, "{quarter} {part}");
            }
        }
    }

    /// Every instruction set, alignment and order gives the same numbers.
    #[test]
    fn numbers_depend_on_id_and_step_alone() {
        let ids: Vec<u32> = (0..1003).map(|i| i * 7 + 1).collect();
        let backwards: Vec<u32> = ids.iter().rev().copied().collect();
        let expected = drawn(InstructionSet::Scalar, 5, &ids);
        for set in InstructionSet::available() {
            assert!(drawn(set, 5, &ids) == expected, "{}", set.name());
            for (numbers, expected) in drawn(set, 5, &backwards).iter().zip(&expected) {
                assert!(numbers.iter().rev().eq(expected), "{}", set.name());
            }
            assert!(drawn(set, 5, &ids[11..])[0] == expected[0][11..]);
        }
        for (step, id) in [(6, 1), (5, 2), (5 + (1 << 32), 1)] {
            assert_ne!(drawn(InstructionSet::Scalar, step, &[id])[0][0], expected[0][0]);
        }
    }

    /// Four million numbers: moments up to the sixth, correlation, the distribution by Kolmogorov and Smirnov, and the counts
    /// beyond 3, 4 and 5, each within five standard errors.
    #[test]
    fn numbers_are_normal_up_to_their_tails() {
        let ids: Vec<u32> = (0..1000).collect();
        let (mut all, mut cross) = (vec![], 0.0);
        for step in 0..2000 {
            let [x, y] = drawn(InstructionSet::best(), step, &ids);
            cross += x.iter().zip(&y).map(|(x, y)| x * y).sum::<f64>();
            all.extend(x);
            all.extend(y);
        }
        let count = all.len() as f64;
        let moment = |power: i32| all.iter().map(|x| x.powi(power)).sum::<f64>() / count;
        for (power, mean, variance) in
            [(1, 0.0, 1.0), (2, 1.0, 2.0), (3, 0.0, 15.0), (4, 3.0, 96.0), (6, 15.0, 10_170.0)]
        {
            let off = (moment(power) - mean) / (variance / count).sqrt();
            assert!(off.abs() < 5.0, "moment {power}: {off} standard errors");
        }
        assert!((cross / (0.5 * count).sqrt()).abs() < 5.0);
        for limit in [3.0, 4.0, 5.0] {
            let share = libm::erfc(limit / 2f64.sqrt());
            let beyond = all.iter().filter(|x| x.abs() > limit).count() as f64;
            assert!((beyond - share * count).abs() < 5.0 * (share * count).sqrt() + 1.0, "{limit}: {beyond}");
        }
        all.sort_by(f64::total_cmp);
        let distance = all
            .iter()
            .enumerate()
            .map(|(before, &x)| (0.5 * libm::erfc(-x / 2f64.sqrt()) - (before as f64 + 0.5) / count).abs());
        // One sample in a thousand is beyond 1.95/√n.
        assert!(distance.fold(0.0, f64::max) < 1.95 / count.sqrt());
    }
}
