//! Series with known correlations, for tests.

/// Normal numbers from a seed: a counter through a mixing function, and the Box-Muller transform.
pub(super) struct Noise(u64);

impl Noise {
    pub(super) fn new(seed: u64) -> Noise {
        Noise(seed << 32)
    }

    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * libm::log(1.0 - self.uniform())).sqrt();
        radius * libm::cos(std::f64::consts::TAU * self.uniform())
    }

    /// Series x' = φ x + √(1 − φ²) times a normal number: mean 0, variance 1 and g = (1 + φ)/(1 − φ).
    pub(super) fn series(&mut self, length: usize, memory: f64) -> Vec<f64> {
        let mut x = self.normal();
        let mut next = || {
            x = memory * x + (1.0 - memory * memory).sqrt() * self.normal();
            x
        };
        (0..length).map(|_| next()).collect()
    }

    /// Series with a transient of some height and duration.
    pub(super) fn relaxing(&mut self, length: usize, memory: f64, height: f64, duration: f64) -> Vec<f64> {
        let series = self.series(length, memory).into_iter().zip(0u32..);
        series.map(|(x, at)| x + height * libm::exp(-f64::from(at) / duration)).collect()
    }
}
