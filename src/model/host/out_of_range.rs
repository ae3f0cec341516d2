//! What a host model cannot say.

/// Why there is no prediction.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OutOfRange {
    /// Vectors longer or shorter than those that were measured.
    #[error(
        "vectors of {n} elements lie outside the calibrated range of {shortest} to {longest}: calibrate on them, or ask \
         for another number of particles"
    )]
    Length {
        /// Elements asked for.
        n: usize,
        /// Shortest vectors.
        shortest: usize,
        /// Longest vectors.
        longest: usize,
    },
    /// More or fewer discs, or another density, than those that were measured.
    #[error(
        "{value} {what} lie outside the calibrated range of {} to {}: ask for another number of particles, or another density",
        ends[0],
        ends[1]
    )]
    Discs {
        /// What is counted.
        what: &'static str,
        /// How many are asked for.
        value: f64,
        /// Fewest and most.
        ends: [f64; 2],
    },
    /// An execution, precision or program that was not measured.
    #[error("{0} was not calibrated")]
    NotMeasured(String),
}
