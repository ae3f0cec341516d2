//! The discs at the start: made as the scene states, and held against the box and each other.

mod checks;
mod compressing;
mod filling;
mod making;
mod meshing;
mod noise;

pub use checks::outside;
pub(crate) use checks::{deepest_overlap, noun, overlaps, readable};
pub(crate) use making::radii;
pub use making::{Made, make};
pub(crate) use noise::noise_seed;

use crate::particles::Particle;
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
    /// What lets grains grow.
    pub compress: Compress,
}

/// Lets grains in a box grow from a scale of their radii (below 1) to the whole, with a seed; their places change.
pub(crate) type Compress = fn(&crate::domain::Domain, &mut [Particle], f64, u64) -> Result<(), Uncompressed>;

/// Why grains did not come to their radii.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Uncompressed {
    /// They leave each other no more room.
    Jammed {
        /// The packing fraction that was reached.
        reached: f64,
    },
    /// The box is too small for so large ones.
    TooSmall,
}

impl Stated<'_> {
    fn spot(&self, key: &Key) -> Spot {
        self.values.spot(key)
    }

    fn item_spot(&self, key: &Key, item: usize) -> Spot {
        self.values.item_spot(key, item)
    }
}
