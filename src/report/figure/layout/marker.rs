//! The shapes of markers.

use super::super::sheet::{Mark, Paint, Place, Stroke};
use super::super::style::{self, Colour, Marker};
use std::f64::consts::FRAC_1_SQRT_2;

/// A marker at a place. A hollow one distinguishes series of the same hue; both have a rim, so that markers upon each
/// other can be counted.
pub fn mark(shape: Marker, centre: Place, colour: Colour, hollow: bool) -> Mark {
    let [fill, rim, width] =
        if hollow { [style::PAPER, colour, colour] } else { [colour, style::PAPER, colour] };
    let stroke = Stroke { colour: rim, width: if width == rim { 2.0 } else { 0.8 }, dash: &[] };
    let paint = Paint { fill: Some(fill), stroke: Some(stroke) };
    match outline(shape) {
        None => Mark::Disc { centre, radius: style::MARKER, paint },
        Some(corners) => {
            let piece =
                corners.iter().map(|[x, y]| [centre[0] + x * style::MARKER, centre[1] + y * style::MARKER]);
            Mark::Lines { pieces: vec![piece.collect()], closed: true, paint }
        }
    }
}

/// The corners of a shape about a point, for a marker of radius one; none for the disc. They look equally large.
fn outline(shape: Marker) -> Option<Vec<Place>> {
    let corners: &[Place] = match shape {
        Marker::Disc => return None,
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
    let turned = |&[x, y]: &Place| [(x - y) * FRAC_1_SQRT_2, (x + y) * FRAC_1_SQRT_2];
    Some(if shape == Marker::Cross { corners.iter().map(turned).collect() } else { corners.to_vec() })
}
