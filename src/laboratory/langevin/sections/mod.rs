//! What the studies say, as items of the report.

pub mod accuracy;
pub mod diffusion;
pub mod losses;
pub mod sectors;

use super::study::Mean;

/// A mean with its bar, as a point.
fn point(x: f64, mean: Mean) -> (f64, f64, [f64; 2]) {
    let Mean { value, bar } = mean;
    (x, value, [value - bar, value + bar])
}
