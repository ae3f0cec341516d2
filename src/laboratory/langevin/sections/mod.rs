//! What the studies say, as items of the report.

pub mod accuracy;
pub mod diffusion;
pub mod losses;
pub mod sectors;

use super::study::Mean;
use crate::report::figure::Point;

/// A mean with its bar, as a point.
fn point(x: f64, mean: Mean) -> Point {
    let Mean { value, bar } = mean;
    Point { x, y: value, spread: Some([value - bar, value + bar]) }
}
