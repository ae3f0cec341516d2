//! Boxes in which a number of discs have a packing fraction.

use super::StatedStart;
use crate::domain::Domain;
use crate::scene::{Amount, DiscStart, GeneratedDiscs, WallMotion};
use std::f64::consts::PI;

/// Box for the number and packing fraction of a scene that states no sides: a square; a pipe with its wall discs inside; a box that ends one disc
/// above its fill height. None if the scene does not state both.
pub(super) fn box_for_count(stated: &StatedStart<'_>) -> Option<Domain> {
    let open_area = |amount: &Amount, grains: &GeneratedDiscs| match *amount {
        Amount::Both(count, fraction) => {
            Some(count as f64 * PI * grains.second.mean_square(grains.radius) / fraction)
        }
        Amount::Count(_) | Amount::PackingFraction(_) => None,
    };
    let sides = match stated.start {
        DiscStart::Random { amount, grains }
        | DiscStart::Compressed { amount, grains }
        | DiscStart::Mesh { amount, grains, .. } => [open_area(amount, grains)?.sqrt(); 2],
        DiscStart::Pipe { amount, grains, lining, clear_width } => {
            [open_area(amount, grains)? / clear_width, clear_width + 4.0 * lining.radius]
        }
        DiscStart::Box { amount, grains, lining, fill_height } => {
            let swing = match stated.walls {
                WallMotion::Fixed => 0.0,
                WallMotion::Oscillating { amplitude, .. } => 2.0 * amplitude[1].abs(),
            };
            let height =
                fill_height + 2.0 * lining.radius + swing + 2.0 * grains.second.largest(grains.radius);
            [open_area(amount, grains)? / fill_height, height]
        }
        DiscStart::Hexagonal { .. } | DiscStart::List(_) | DiscStart::File(_) => return None,
    };
    Some(Domain::planar(stated.domain.origin, sides, stated.domain.periodic))
}
