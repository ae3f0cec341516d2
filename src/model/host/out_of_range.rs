//! Predictions outside the measurements of a host model.

/// Reason why there is no prediction.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum OutOfRange {
    /// Vectors longer or shorter than those measured.
    #[error(
        "vectors of {n} elements are outside the calibrated range of {shortest} to {longest}: calibrate on them, or choose \
         another number of particles"
    )]
    Length {
        n: usize,
        /// Shortest vectors measured.
        shortest: usize,
        /// Longest vectors measured.
        longest: usize,
    },
    /// More or fewer discs than those measured.
    #[error(
        "{discs} discs are outside the calibrated range of {fewest} to {most}: choose another number of particles"
    )]
    Discs {
        discs: f64,
        /// Fewest discs measured.
        fewest: f64,
        /// Most discs measured.
        most: f64,
    },
    /// An execution, precision or program that was not measured.
    #[error("{0} was not calibrated")]
    NotMeasured(String),
}
