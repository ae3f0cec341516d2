//! The neighbourhood as the source draws it.

use crate::report::figure::{Drawing, Figure, Picture, Shape, Tint};
use crate::report::{Rows, Section, Table, Verdict};
use std::f64::consts::SQRT_2;
use stripmine_kernels::mask::Mask;

/// Figure 2 and the wider mask, with what each can see.
pub fn section() -> Section {
    let [small, large] = [2, 3].map(Mask::square);
    Section::new("mask", "The mask (figure 2)")
        .asks("Which places around a disc can hold what touches it?")
        .expects("BP93, figure 2, numbers 24 places; every contact of a disc lies in one of them if the cells are at least as wide as the \
                  largest radius.")
        .answers(format!(
            "{} places in the source's order, and {} in the wider mask for larger differences in size.",
            small.offsets().len(),
            large.offsets().len()
        ))
        .verdict(if small.offsets().len() == 24 { Verdict::Reproduced } else { Verdict::NotReproduced })
        .figures([drawing("mask_5x5", "The 24 places of the mask", &small)])
        .tables([reaches(&[("5×5", 2.0), ("7×7", 3.0)])])
}

fn drawing(name: &str, title: &str, mask: &Mask) -> Figure {
    let half = mask.offsets().iter().map(|offset| offset.columns.abs()).max().unwrap_or(0);
    let rim = f64::from(half) + 0.5;
    let cell = |columns: i32, rows: i32, words: String, tint| {
        let [x, y] = [columns, rows].map(f64::from);
        // In the corner that is the farthest from the middle, where the circle does not cross it.
        let right = if columns > 0 { 0.3 } else { -0.3 };
        let up = if rows < 0 { -0.33 } else { 0.33 };
        [
            Shape::Rectangle { corners: [[x - 0.5, y - 0.5], [x + 0.5, y + 0.5]], tint, outlined: true },
            Shape::Text { centre: [x + right, y + up], height: 0.16, words },
        ]
    };
    let mut shapes = Vec::from(cell(0, 0, "0".into(), Tint::Still));
    for (number, offset) in mask.offsets().iter().enumerate() {
        shapes.extend(cell(offset.columns, offset.rows, (number + 1).to_string(), Tint::Clear));
    }
    // The largest disc that these cells allow, in the middle of its cell, and what touches it.
    shapes.push(Shape::Disc { centre: [0.0, 0.0], radius: f64::from(half) / 2.0, tint: Tint::Clear });
    Picture::Drawing(Drawing {
        window: [[-rim - 0.1, -rim - 0.1], [rim + 0.1, rim + 0.1]],
        width: 480.0,
        shapes,
        shades: None,
        guide: None,
    })
    .figure(name, title)
    .caption("Cell 0 holds the disc whose force is summed; its neighbours are met in the order of the numbers. The circle is the largest disc \
              that cells of this width allow.")
}

/// What sizes a mask of half-width h allows: cells of 2R_max/h see every contact, cells of d_min/√2 hold one disc.
fn reaches(masks: &[(&str, f64)]) -> Table {
    let ratio = |half: f64, penetration: f64| half * (1.0 - penetration) / SQRT_2;
    Rows::of(masks)
        .text("mask", |(name, _)| *name)
        .number("narrowest cell (R_max)", 3, |(_, half)| 2.0 / half)
        .number("largest R_max/R_min, discs just touching", 3, |(_, half)| ratio(*half, 0.0))
        .number("largest R_max/R_min, penetration up to 0.1", 3, |(_, half)| ratio(*half, 0.1))
        .table("reach", "What a mask can see")
}
