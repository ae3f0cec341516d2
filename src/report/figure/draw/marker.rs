//! Markers: eight shapes, full or hollow, with rims. The library's have no rims, and only its discs can be hollow.

use super::super::look::Look;
use super::super::style::{self, Marker};
use std::f64::consts::FRAC_1_SQRT_2;
use std::fmt::Write;

/// The marker of a look among the definitions of a picture. Its name says how it looks: pictures on one page that use a name mean
/// the same marker. A hollow one distinguishes series of the same hue; both have a rim, so that markers upon each other can be
/// counted.
pub fn definition(look: &Look) -> String {
    let [fill, rim] = if look.hollow { [style::PAPER, look.colour] } else { [look.colour, style::PAPER] };
    let width = if look.hollow { 2.0 } else { 0.8 };
    let mut d = String::new();
    let corners = corners(look.marker);
    if corners.is_empty() {
        let r = style::MARKER;
        let _ = write!(d, "M-{r} 0a{r} {r} 0 1 0 {} 0a{r} {r} 0 1 0 -{} 0z", 2.0 * r, 2.0 * r);
    } else {
        for (i, corner) in corners.iter().enumerate() {
            let [right, below] = corner.map(|reach| reach * style::MARKER);
            let _ = write!(d, "{}{right:.1} {below:.1}", if i == 0 { "M" } else { "L" });
        }
        d.push('z');
    }
    format!(
        "<marker id=\"{}\" markerUnits=\"userSpaceOnUse\" overflow=\"visible\"><path fill=\"{fill}\" stroke=\"{rim}\" \
         stroke-width=\"{width}\" d=\"{d}\"/></marker>",
        name(look)
    )
}

/// The name of a look's marker.
pub fn name(look: &Look) -> String {
    let hollow = if look.hollow { "-hollow" } else { "" };
    format!("m{}-{}{hollow}", look.marker as u8, look.colour.to_string().trim_start_matches('#'))
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
