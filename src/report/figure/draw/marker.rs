//! Markers: eight shapes, full or hollow, with rims. The library's have no rims, and only its discs can be hollow.

use super::super::look::Look;
use super::super::style::{self, Marker};
use super::frame::colour;
use kuva::render::render::{PathData, Primitive};
use std::f64::consts::FRAC_1_SQRT_2;
use std::fmt::Write;

/// Markers at places (pixels), one upon another. A hollow one distinguishes series of the same hue; both have a rim, so that markers
/// upon each other can be counted.
pub fn markers(look: &Look, places: &[[f64; 2]]) -> impl Iterator<Item = Primitive> {
    let [fill, rim] = if look.hollow { [style::PAPER, look.colour] } else { [look.colour, style::PAPER] };
    let width = if look.hollow { 2.0 } else { 0.8 };
    let (fill, stroke, corners) = (colour(fill), colour(rim), corners(look.marker));
    places.iter().map(move |&[x, y]| {
        let mut d = String::new();
        if corners.is_empty() {
            let r = style::MARKER;
            let _ =
                write!(d, "M{:.1} {y:.1}a{r} {r} 0 1 0 {} 0a{r} {r} 0 1 0 {} 0z", x - r, 2.0 * r, -2.0 * r);
        }
        for (i, [right, below]) in corners.iter().enumerate() {
            let [x, y] = [x + right * style::MARKER, y + below * style::MARKER];
            let _ = write!(d, "{}{x:.1} {y:.1}", if i == 0 { "M" } else { "L" });
        }
        d.push('z');
        let (fill, stroke, stroke_width) = (Some(fill.clone()), stroke.clone(), width);
        Primitive::Path(Box::new(PathData {
            d,
            fill,
            stroke,
            stroke_width,
            opacity: None,
            stroke_dasharray: None,
        }))
    })
}

/// The corners of a shape about a point, for a marker of radius one; none for the disc. They look equally large.
fn corners(shape: Marker) -> Vec<[f64; 2]> {
    let corners: &[[f64; 2]] = match shape {
        Marker::Disc => return Vec::new(),
        Marker::Square => &[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]],
        Marker::Triangle => &[[0.0, -1.2], [1.13, 0.76], [-1.13, 0.76]],
        Marker::Wedge => &[[0.0, 1.2], [-1.13, -0.76], [1.13, -0.76]],
        Marker::Diamond => &[[0.0, -1.25], [1.25, 0.0], [0.0, 1.25], [-1.25, 0.0]],
        Marker::Plus | Marker::Cross => &[
            [-0.42, -1.25],
            [0.42, -1.25],
            [0.42, -0.42],
            [1.25, -0.42],
            [1.25, 0.42],
            [0.42, 0.42],
            [0.42, 1.25],
            [-0.42, 1.25],
            [-0.42, 0.42],
            [-1.25, 0.42],
            [-1.25, -0.42],
            [-0.42, -0.42],
        ],
        Marker::Star => &[
            [0.0, -1.4],
            [0.35, -0.49],
            [1.33, -0.43],
            [0.57, 0.19],
            [0.82, 1.13],
            [0.0, 0.6],
            [-0.82, 1.13],
            [-0.57, 0.19],
            [-1.33, -0.43],
            [-0.35, -0.49],
        ],
    };
    let turned = |&[x, y]: &[f64; 2]| [(x - y) * FRAC_1_SQRT_2, (x + y) * FRAC_1_SQRT_2];
    if shape == Marker::Cross { corners.iter().map(turned).collect() } else { corners.to_vec() }
}
