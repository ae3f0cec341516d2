//! What a host model cannot say.

/// Why there is no prediction.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum OutOfRange {
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
    /// More or fewer discs than those that were measured.
    #[error(
        "{discs} discs lie outside the calibrated range of {fewest} to {most}: ask for another number of particles"
    )]
    Discs {
        /// Discs asked for.
        discs: f64,
        /// Fewest discs.
        fewest: f64,
        /// Most discs.
        most: f64,
    },
    /// An execution, precision or program that was not measured.
    #[error("{0} was not calibrated")]
    NotMeasured(String),
}
