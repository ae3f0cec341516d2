//! A number for each place of a grid, as a colour.

use super::Axis;
use serde::{Deserialize, Serialize};

/// A map, such as the density over place and time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Map {
    /// The horizontal axis; its limits are the outer edges of the first and last column, and must be given.
    pub x: Axis,
    /// The vertical axis; its limits are the outer edges of the first and last row, and must be given.
    pub y: Axis,
    /// What the colour says.
    pub value: Axis,
    /// `rows[j][i]`: the value at row j (from the bottom) and column i. All rows are equally long.
    pub rows: Vec<Vec<f64>>,
}
