//! Counter-based random numbers: functions of where they are used, independent of the order of computation, threads and vector
//! width.

mod drawing;

pub use drawing::draw;

use std::convert::Infallible;

/// Purpose of a random number: equal counters of different purposes are unrelated.
///
/// This table lists every random number that a run draws. Numbers of a stream are counted within it, separately from single
/// draws.
///
/// | purpose | id | step | draws |
/// |---|---|---|---|
/// | `Placement` | 0 | stream | positions on a mesh, shifts on a hexagonal lattice |
/// | `Placement` | disc's id | stream | radius and position of a disc |
/// | `Placement` | disc's id | 1 | velocity of a disc |
/// | `Placement` | disc's id | 2 | velocity while a dense start is compressed |
/// | `Placement` | body's number + 1 | stream | position and velocity of a body, counted through all clusters |
/// | `Placement` | body's number + 1 | 2³² + 1, 2³² + 2 | random velocity of a body in a sphere or shell |
/// | `Thermostat` | particle's id | step of the run | noise of the bath |
/// | `Wall` | disc's number | twice the disc's events, and one more | velocity off a thermal wall |
/// | `Test` | any | any | tests |
///
/// A start that is listed or read from a file has no seed of its own: its bath and its walls use [`seed_of_state`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum RandomPurpose {
    /// Positions and velocities of a start.
    Placement = 1,
    /// Noise of a thermostat.
    Thermostat = 2,
    /// Random cases of tests.
    Test = 3,
    /// Velocities off thermal walls.
    Wall = 4,
}

/// Random numbers of a run, and their combination into those of a step.
///
/// A run with steps of h and `parts` p > 1 follows the Brownian path of a run with steps of h/p and one part: each of its normal
/// numbers is a sum of the p that the other run draws in the same time, with the weights of the scheme.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoiseSource {
    /// The seed.
    pub seed: u64,
    /// Number of normal numbers combined into one, at least 1.
    pub parts: u32,
}

impl NoiseSource {
    /// Source with one number per step.
    pub fn new(seed: u64) -> NoiseSource {
        NoiseSource { seed, parts: 1 }
    }
}

/// Seed derived from another seed and a state, so that a continued run does not repeat its noise. Each 128 bits of the state are
/// a counter of Philox whose key is the seed so far.
pub fn seed_of_state(seed: u64, state: impl IntoIterator<Item = [u64; 2]>) -> u64 {
    let halves = |word: u64| [word as u32, (word >> 32) as u32];
    state.into_iter().fold(seed, |seed, [a, b]| {
        let ([a, b], [c, d]) = (halves(a), halves(b));
        let [low, high, ..] = philox4x32([a, b, c, d], halves(seed));
        u64::from(low) | u64::from(high) << 32
    })
}

/// Philox 4x32 with ten rounds (Salmon et al., SC11): four random words from a counter of four and a key of two.
#[inline(always)]
pub(crate) fn philox4x32(mut counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    for _ in 0..10 {
        let product = |multiplier: u64, word: u32| multiplier * u64::from(word);
        let (even, odd) = (product(0xD251_1F53, counter[0]), product(0xCD9E_8D57, counter[2]));
        counter = [
            (odd >> 32) as u32 ^ counter[1] ^ key[0],
            odd as u32,
            (even >> 32) as u32 ^ counter[3] ^ key[1],
            even as u32,
        ];
        key = [key[0].wrapping_add(0x9E37_79B9), key[1].wrapping_add(0xBB67_AE85)];
    }
    counter
}

/// Fourth word of a counter: the top byte separates purposes, the two bytes below blocks; 40 bits count steps.
#[inline(always)]
fn top_word(purpose: RandomPurpose, step: u64, block: u16) -> u32 {
    debug_assert!(
        step < 1 << 40,
        "step {step} cannot be counted: random numbers exist for fewer than 2^40 steps"
    );
    (purpose as u32) << 24 | u32::from(block) << 8 | (step >> 32) as u32 & 0xFF
}

/// Random words of (seed, purpose, id, step) in block number `block`.
#[inline]
fn words(seed: u64, purpose: RandomPurpose, id: u32, step: u64, block: u16) -> [u32; 4] {
    philox4x32([id, step as u32, 0, top_word(purpose, step, block)], [seed as u32, (seed >> 32) as u32])
}

/// A uniform number in (0, 1), of 53 random bits; never 0, so that its logarithm exists.
#[inline]
fn uniform(high: u32, low: u32) -> f64 {
    let bits = (u64::from(high) << 32 | u64::from(low)) >> 11;
    (bits as f64 + 0.5) * (1.0 / (1u64 << 53) as f64)
}

/// Returns two independent standard normal numbers of (seed, purpose, id, step) (Box and Muller).
///
/// Logarithm, cosine and sine come from the portable `libm`, so that the bits are the same on every platform.
#[inline]
pub fn normals(seed: u64, purpose: RandomPurpose, id: u32, step: u64) -> [f64; 2] {
    let word = words(seed, purpose, id, step, 0);
    let radius = (-2.0 * libm::log(uniform(word[0], word[1]))).sqrt();
    let angle = std::f64::consts::TAU * uniform(word[2], word[3]);
    [radius * libm::cos(angle), radius * libm::sin(angle)]
}

/// A stream of random words for one (seed, purpose, id), with the traits of the crate `rand`.
#[derive(Clone, Debug)]
pub struct Stream {
    seed: u64,
    purpose: RandomPurpose,
    id: u32,
    drawn: u64,
}

impl Stream {
    /// Stream from its beginning.
    #[inline]
    pub fn new(seed: u64, purpose: RandomPurpose, id: u32) -> Self {
        Stream { seed, purpose, id, drawn: 0 }
    }

    #[inline]
    fn word(&mut self) -> u32 {
        let (step, word) = (self.drawn / 4, (self.drawn % 4) as usize);
        self.drawn += 1;
        words(self.seed, self.purpose, self.id, step, u16::MAX)[word]
    }
}

impl rand::TryRng for Stream {
    type Error = Infallible;
    #[inline]
    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        Ok(self.word())
    }
    #[inline]
    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        Ok(u64::from(self.word()) | u64::from(self.word()) << 32)
    }
    #[inline]
    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        for chunk in bytes.chunks_mut(4) {
            chunk.copy_from_slice(&self.word().to_le_bytes()[..chunk.len()]);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;

    /// Known answers for philox4x32-10, published by the authors of Random123.
    #[test]
    fn philox_gives_the_published_answers() {
        assert_eq!(philox4x32([0; 4], [0; 2]), [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]);
        assert_eq!(philox4x32([!0; 4], [!0; 2]), [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]);
        assert_eq!(
            philox4x32([0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344], [0xa409_3822, 0x299f_31d0]),
            [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1]
        );
    }

    /// Moments of 10⁵ pairs are within five standard errors, and the two of a pair are uncorrelated.
    #[test]
    fn normals_are_normal() {
        let n = 100_000u32;
        let (mut mean, mut square, mut fourth, mut cross) = (0.0, 0.0, 0.0, 0.0);
        for id in 0..n {
            let [a, b] = normals(7, RandomPurpose::Test, id, u64::from(id % 17));
            mean += a + b;
            square += a * a + b * b;
            fourth += a.powi(4) + b.powi(4);
            cross += a * b;
        }
        let m = 2.0 * f64::from(n);
        assert!((mean / m).abs() < 5.0 / m.sqrt());
        assert!((square / m - 1.0).abs() < 5.0 * (2.0 / m).sqrt());
        assert!((fourth / m - 3.0).abs() < 5.0 * (96.0 / m).sqrt());
        assert!((cross / f64::from(n)).abs() < 5.0 / f64::from(n).sqrt());
    }

    #[test]
    fn seed_purpose_id_and_step_all_matter() {
        let base = normals(1, RandomPurpose::Test, 2, 3);
        assert_eq!(base.map(f64::to_bits), normals(1, RandomPurpose::Test, 2, 3).map(f64::to_bits));
        for other in [
            normals(2, RandomPurpose::Test, 2, 3),
            normals(1, RandomPurpose::Thermostat, 2, 3),
            normals(1, RandomPurpose::Test, 3, 3),
            normals(1, RandomPurpose::Test, 2, 4),
            normals(1, RandomPurpose::Test, 2, 3 + (1 << 32)),
        ] {
            assert_ne!(base, other);
        }
    }

    /// For seeds one apart and all uses of the table in [`RandomPurpose`], no two draws have a word pair in common. (64 bits of some
    /// 10⁵ draws coincide by chance once in 10⁹ cases.)
    #[test]
    fn purposes_and_seeds_share_no_numbers() {
        let (ids, steps, most) = (0..40_u32, 0..40_u64, 1 << 32);
        let mut drawn = vec![];
        for seed in
            [0, 1, 2, 3, seed_of_state(1, [[1, 2]]), seed_of_state(1, [[1, 3]]), seed_of_state(2, [[1, 2]])]
        {
            for id in ids.clone() {
                let mut stream = Stream::new(seed, RandomPurpose::Placement, id);
                drawn.extend(steps.clone().map(|_| stream.next_u64()));
                let single =
                    [1, 2, most + 1, most + 2].map(|step| (RandomPurpose::Placement, step)).into_iter();
                let walls = steps.clone().map(|step| (RandomPurpose::Wall, step));
                let bath = steps.clone().map(|step| (RandomPurpose::Thermostat, step));
                let bath =
                    bath.chain([(RandomPurpose::Thermostat, most), (RandomPurpose::Thermostat, most + 1)]);
                for (purpose, step) in single.chain(walls).chain(bath) {
                    let [a, b, c, d] = words(seed, purpose, id, step, 0);
                    drawn.extend([[a, b], [c, d]].map(|[low, high]| u64::from(low) | u64::from(high) << 32));
                }
            }
        }
        let all = drawn.len();
        drawn.sort_unstable();
        drawn.dedup();
        assert_eq!(drawn.len(), all);
    }

    /// Philox of counter 0 and key 0 is published (see above); a second state is drawn with that as the key.
    #[test]
    fn states_give_distinct_seeds() {
        assert_eq!(seed_of_state(7, []), 7);
        assert_eq!(seed_of_state(0, [[0, 0]]), 0xe169_c58d_6627_e8d5);
        assert_eq!(seed_of_state(!0, [[!0, !0]]), 0x41c8_3b0e_408f_276d);
        assert_eq!(seed_of_state(0, [[0, 0], [3, 4]]), seed_of_state(0xe169_c58d_6627_e8d5, [[3, 4]]));
    }

    #[test]
    fn streams_repeat_and_implement_rand_traits() {
        let mut a = Stream::new(5, RandomPurpose::Test, 0);
        let mut b = a.clone();
        let first: Vec<u64> = (0..9).map(|_| a.next_u64()).collect();
        assert!(first.iter().all(|&word| word == b.next_u64()));
        let mut distinct = first.clone();
        distinct.sort_unstable();
        distinct.dedup();
        assert_eq!(distinct.len(), first.len());
        let mut bytes = [0; 7];
        Stream::new(5, RandomPurpose::Test, 0).fill_bytes(&mut bytes);
        assert_eq!(bytes[..4], (first[0] as u32).to_le_bytes());
    }
}
