//! Picture of a vector in strips, with the instructions of a strip beside it.

use super::runs::{VectorFile, emitted};
use crate::console::CommandFailure;
use crate::report::figure::{Drawing, DrawnShape, Picture, Tint};

/// Elements of a box, and instructions in the picture.
const BOX: usize = 8;
const SHOWN: usize = 14;
/// Height of a line of text, and of a strip with its gap (widths of an element).
const LINE: f64 = 2.2;
const STRIP: f64 = 5.4;

/// Draws the vectors of the longest program of the first scene in strips of 64 elements, and the first instructions that run for each strip.
///
/// # Errors
/// As [`emitted`].
pub(super) fn strip_picture(count: usize) -> Result<Picture, CommandFailure> {
    let file = VectorFile::CRAY;
    let scene = emitted(0, count, file.size)?;
    let mut shapes = vec![];
    // The program with most instructions: the forces.
    let Some(it) = scene.programs.iter().max_by_key(|it| it.kernel.lines.len()) else {
        return Ok(drawing(shapes, 0.0));
    };
    let elements = file.elements();
    for strip in 0..file.strips(it.n) as usize {
        let length = elements.min(it.n - strip * elements);
        let low = -(strip as f64) * STRIP;
        for first in (0..length).step_by(BOX) {
            let [left, right] = [first, (first + BOX).min(length)].map(|at| at as f64);
            shapes.push(DrawnShape::Rectangle {
                corners: [[left, low], [right - 0.3, low + 1.6]],
                tint: Tint::Still,
            });
        }
        shapes.push(text([elements as f64 / 2.0, low + 3.0], format!("strip {}: vl = {length}", strip + 1)));
    }
    for (at, line) in it.kernel.lines.iter().skip(it.kernel.start).take(SHOWN).enumerate() {
        shapes.push(text([elements as f64 + 22.0, 1.0 - LINE * at as f64], line.code.clone()));
    }
    let bottom = (STRIP * file.strips(it.n) as f64).max(LINE * SHOWN as f64);
    Ok(drawing(shapes, -bottom))
}

fn text(centre: [f64; 2], words: String) -> DrawnShape {
    DrawnShape::Text { centre, height: 1.4, words }
}

fn drawing(shapes: Vec<DrawnShape>, bottom: f64) -> Picture {
    Picture::Drawing(Drawing {
        window: [[-1.0, bottom], [VectorFile::CRAY.elements() as f64 + 44.0, 4.0]],
        width: 860.0,
        shapes,
        shades: None,
        guide: None,
    })
}
