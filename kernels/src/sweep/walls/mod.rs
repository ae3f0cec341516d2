//! Plane walls: segments that a disc meets as it meets a fixed disc of radius 0 at their closest point.
//!
//! ```text
//! segments    from one end to another
//! pieces      insides of segments, and corners                     pieces.rs
//! elements    pieces as seen from the cells that they can touch    elements.rs
//! forces      a vector program over the elements                   program.rs
//!             or the same law, element by element                  contact.rs
//! ```
//!
//! A disc on the joint of two segments touches one point, not two ends. So a segment counts only where the closest point is
//! inside it, and an end is a corner that counts only where no segment is nearer. Inside a corner a disc touches both segments.

mod contact;
mod elements;
mod pieces;
mod program;

pub use contact::{TouchingDisc, WallContact, touch};
pub use elements::{CellElement, ELEMENT_NUMBERS, ElementShape, WallSurface, elements};
pub use pieces::{PieceShape, WallPiece, pieces};
pub use program::{WALL_ARRAYS, WallForces};
