//! Below a drawing: a bar of a round length, and the way gravity pulls.

use super::super::{Guide, style};
use super::frame::colour;
use super::words;
use kuva::render::render::{Primitive, Scene, TextAnchor};
use stripmine_physics::number::significant;

/// Height of the row, length of the arrow, of the wings of its head and of the ends of the bar (pixels).
const ROW: f64 = 44.0;
const ARROW: f64 = 30.0;
const WING: f64 = 6.0;
/// Width of lines (pixels).
const LINE: f64 = 1.6;
/// The bar is at most this part of the window's width.
const MOST: f64 = 0.25;

/// Adds the guide of a drawing between two edges, below `top`. Returns where it ends.
pub fn add_to(
    scene: &mut Scene,
    guide: &Guide,
    scale: f64,
    zoom: f64,
    [left, right]: [f64; 2],
    top: f64,
) -> f64 {
    let middle = top + 0.5 * ROW * zoom;
    let size = style::LABEL * zoom;
    let base = middle + 0.35 * size;
    if let Some(gravity) = guide.gravity {
        scene.add(words::line([left, base], TextAnchor::Start, size, "gravity"));
        let length = gravity[0].hypot(gravity[1]);
        // Upwards places fall.
        let along = [gravity[0] / length, -gravity[1] / length].map(|part| part * ARROW * zoom);
        let centre = [left + 78.0 * zoom + 0.5 * ARROW * zoom, middle];
        let end = |part: f64| [centre[0] + part * along[0], centre[1] + part * along[1]];
        let (from, to) = (end(-0.5), end(0.5));
        scene.add(line(from, to, zoom));
        let [x, y] = along.map(|part| part / ARROW * WING);
        for side in [-1.0, 1.0] {
            let wing = [to[0] - 1.4 * x - side * 0.8 * y, to[1] - 1.4 * y + side * 0.8 * x];
            scene.add(line(to, wing, zoom));
        }
    }
    let length = round(MOST * (right - left) / scale);
    let begin = right - length * scale;
    scene.add(line([begin, middle], [right, middle], zoom));
    for x in [begin, right] {
        scene.add(line([x, middle - WING * zoom], [x, middle + WING * zoom], zoom));
    }
    let words = format!("{} {}", significant(length, 3), guide.unit);
    scene.add(words::line([begin - 10.0 * zoom, base], TextAnchor::End, size, words.trim_end()));
    top + ROW * zoom
}

/// The largest of 1, 2 and 5 times a power of ten that is not above a number.
fn round(most: f64) -> f64 {
    let power = libm::pow(10.0, libm::log10(most).floor());
    [5.0, 2.0, 1.0].into_iter().map(|factor| factor * power).find(|it| *it <= most).unwrap_or(power)
}

fn line([x1, y1]: [f64; 2], [x2, y2]: [f64; 2], zoom: f64) -> Primitive {
    let stroke = colour(style::INK);
    Primitive::Line { x1, y1, x2, y2, stroke, stroke_width: LINE * zoom, stroke_dasharray: None }
}

#[cfg(test)]
mod tests {
    use super::round;

    #[test]
    fn bars_have_round_lengths() {
        for (most, length) in [(1.0, 1.0), (0.3, 0.2), (7.3, 5.0), (49.0, 20.0), (0.0199, 0.01)] {
            assert!((round(most) - length).abs() < 1e-12, "{most}");
        }
    }
}
