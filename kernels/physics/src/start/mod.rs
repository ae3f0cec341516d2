//! Initial discs of a scene: created, then checked against the box and each other.

mod box_size;
mod checks;
mod completion;
mod compressing;
mod creation;
mod exact_speed;
mod filling;
mod imported;
mod meshing;
mod noise;

pub use checks::outside;
pub(crate) use checks::{deepest_overlap, disc_noun, overlaps, rounded_to_nine_digits};
pub(crate) use completion::StartCompletion;
pub(crate) use creation::radii;
pub use creation::{InitialState, create_initial_state};
pub(crate) use noise::noise_seed;

use crate::particles::Particle;
use crate::scene::{DiscStart, Key, SceneDomain, SceneValues, Spot, WallMotion};

/// Start of a scene as stated, with the locations of its keys.
#[derive(Clone, Copy, Debug)]
pub struct StatedStart<'s> {
    /// Values and their locations.
    pub values: &'s SceneValues,
    /// Box.
    pub domain: &'s SceneDomain,
    /// Initial discs.
    pub start: &'s DiscStart,
    /// Motion of wall discs.
    pub walls: WallMotion,
    /// Segments that placed discs must not cut (length).
    pub barriers: &'s [[[f64; 2]; 2]],
    /// Axes along which the method conserves momentum.
    pub conserved: [bool; 2],
    /// Function that lets grains grow.
    pub compress: CompressFunction,
}

/// Lets grains in a box grow from a scale of their radii (below 1) to the whole, with a seed; it moves them.
pub(crate) type CompressFunction =
    fn(&crate::domain::Domain, &mut [Particle], f64, u64) -> Result<(), CompressionFailure>;

/// Reason why grains did not reach their radii.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CompressionFailure {
    /// The discs jam.
    Jammed {
        /// Packing fraction reached.
        reached: f64,
    },
    /// The box is too small for discs of these radii.
    TooSmall,
}

impl StatedStart<'_> {
    fn spot(&self, key: &Key) -> Spot {
        self.values.spot(key)
    }

    fn item_spot(&self, key: &Key, item: usize) -> Spot {
        self.values.item_spot(key, item)
    }
}
