//! Neighbourhood of BP93's figure 2, and the range of disc sizes that a mask covers.

use crate::console::CommandFailure;
use crate::frame::FrameBuilder;
use crate::report::figure::{Drawing, DrawnShape, Picture, Tint};
use crate::results::{FinishedItem, StudyEnvironment, StudySize};
use std::f64::consts::SQRT_2;
use stripmine_kernels::mask::{Mask, Offset};

/// Draws figure 2 and lists its offsets in order and the reach of both masks.
pub(crate) fn reproduce(_: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let (mask, wider) = (Mask::square(2), Mask::square(3));
    let offsets = mask.offsets();
    // A mask of half-width h covers every contact on cells of 2R_max/h; cells of d_min/√2 hold one disc.
    let ratio = |half: f64, penetration: f64| half * (1.0 - penetration) / SQRT_2;
    Ok(FinishedItem::of([
        FrameBuilder::of([("5×5", 2.0), ("7×7", 3.0)])
            .text("mask", |(name, _)| *name)
            .number("narrowest cell (R_max)", 3, |(_, half)| 2.0 / half)
            .number("largest R_max/R_min, discs just touching", 3, |(_, half)| ratio(*half, 0.0))
            .number("largest R_max/R_min, penetration up to 0.1", 3, |(_, half)| ratio(*half, 0.1))
            .frame("reach", "Sizes of discs that a mask serves"),
        FrameBuilder::of(offsets.iter().zip(1_u64..))
            .count("number", |(_, number)| *number)
            .number("column", 0, |(offset, _)| f64::from(offset.columns))
            .number("row", 0, |(offset, _)| f64::from(offset.rows))
            .number("offset", 0, |(offset, _)| f64::from(offset.columns + 5 * offset.rows))
            .frame("places", "Places of the mask in the order of visit"),
        FrameBuilder::of([()])
            .count("places of the wider mask", |()| wider.offsets().len())
            .frame("summary", "Masks"),
    ])
    .with_picture("mask_5x5", Picture::Drawing(drawing(offsets))))
}

fn drawing(offsets: &[Offset]) -> Drawing {
    let cell = |columns: i32, rows: i32, words: String, tint| {
        let [x, y] = [columns, rows].map(f64::from);
        // In the corner farthest from the middle, so that the circle does not cross the number.
        let right = if columns > 0 { 0.3 } else { -0.3 };
        let up = if rows < 0 { -0.33 } else { 0.33 };
        [
            DrawnShape::Rectangle { corners: [[x - 0.5, y - 0.5], [x + 0.5, y + 0.5]], tint },
            DrawnShape::Text { centre: [x + right, y + up], height: 0.16, words },
        ]
    };
    let mut shapes = Vec::from(cell(0, 0, "0".into(), Tint::Still));
    for (offset, number) in offsets.iter().zip(1_usize..) {
        shapes.extend(cell(offset.columns, offset.rows, number.to_string(), Tint::Clear));
    }
    // Largest disc that these cells allow, in the middle of its cell.
    shapes.push(DrawnShape::Disc { centre: [0.0, 0.0], radius: 1.0, tint: Tint::Clear });
    Drawing { window: [[-2.6, -2.6], [2.6, 2.6]], width: 480.0, shapes, shades: None, guide: None }
}
