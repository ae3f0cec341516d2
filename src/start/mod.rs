//! The discs at the start: made as the scene states, and held against the box and each other.

mod checks;
mod making;

pub use checks::{noun, outside, overlaps, readable};
pub use making::{Made, make, radii};

use crate::scene::{Domain, Key, Spot, Start, Values, WallMotion};

/// What a scene states of its start, with the places where it does.
#[derive(Clone, Copy, Debug)]
pub struct Stated<'s> {
    /// The values and their places.
    pub values: &'s Values,
    /// The box.
    pub domain: &'s Domain,
    /// The discs.
    pub start: &'s Start,
    /// The motion of wall discs.
    pub walls: WallMotion,
}

impl Stated<'_> {
    fn spot(&self, key: &Key) -> Spot {
        self.values.spot(key)
    }

    fn item_spot(&self, key: &Key, item: usize) -> Spot {
        self.values.item_spot(key, item)
    }
}
