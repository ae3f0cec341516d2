//! What is measured of particles in a bath beside a run: each study a file, its section of the report in `sections`.

pub mod accuracy;
pub mod diffusion;
pub mod losses;
pub mod sectors;

use serde::Serialize;

/// Parts of a run, each a measurement; their scatter gives the error.
const PARTS: usize = 20;
/// Student's t of 19 degrees of freedom, for 95 of 100.
const STUDENT: f64 = 2.093;

/// A mean with half the width of the interval that holds it in 95 of 100 studies.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Mean {
    /// The mean.
    pub value: f64,
    /// Half the width.
    pub bar: f64,
}

impl Mean {
    /// Of parts of a run.
    fn of(parts: &[f64]) -> Mean {
        let count = parts.len() as f64;
        let value = parts.iter().sum::<f64>() / count;
        let square = parts.iter().map(|it| (it - value).powi(2)).sum::<f64>() / (count - 1.0);
        Mean { value, bar: STUDENT * (square / count).sqrt() }
    }
}
