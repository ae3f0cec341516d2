//! The prescribed motion of walls.

/// How the wall discs move.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum WallMotion {
    /// Not at all.
    #[default]
    Fixed,
    /// To and fro around where they start, all together: r(t) = r(0) + a sin(2π f t).
    Oscillating {
        /// a (length).
        amplitude: [f64; 2],
        /// f (1/time).
        frequency: f64,
    },
}

impl WallMotion {
    /// Displacement (length) and velocity (length/time) at a time.
    pub fn at(self, time: f64) -> ([f64; 2], [f64; 2]) {
        match self {
            WallMotion::Fixed => ([0.0; 2], [0.0; 2]),
            WallMotion::Oscillating { amplitude, frequency } => {
                let rate = std::f64::consts::TAU * frequency;
                // The portable sine and cosine: the same bits on every platform.
                let (sine, cosine) = (libm::sin(rate * time), libm::cos(rate * time));
                (amplitude.map(|a| a * sine), amplitude.map(|a| a * rate * cosine))
            }
        }
    }
}
