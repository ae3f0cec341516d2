//! Drawings: shapes with a scale bar, the direction of gravity and a colour bar below them.

use super::axis::AxisRange;
use super::style::{self, Colour, LINE};
use super::writer::{END, MIDDLE, Svg, box_attributes, stroke, tenths};
use super::{Drawing, DrawnShape, Guide, Scale, Tint, font, map};
use std::collections::BTreeMap;
use stripmine_physics::number::significant;

/// Width of a disc's outline in radii, and its bounds in pixels.
const RIM: f64 = 0.08;
const RIMS: [f64; 2] = [0.4, 1.2];
/// Maximum radius of discs without an outline (pixels).
const SMALL: f64 = 2.5;
/// Height of the rows for sorting dots (tenths of a pixel).
const ROW: i64 = 120;

/// Draws shapes. In a wide drawing, which is shown at a smaller scale, words and lines are enlarged.
pub(crate) fn draw(title: &str, drawing: &Drawing) -> Svg {
    let zoom = (drawing.width / style::ZOOMED).max(1.0);
    let margin = style::MARGIN * zoom;
    let [[left, low], [right, high]] = drawing.window;
    let width = drawing.width - 2.0 * margin;
    let scale = width / (right - left);
    let height = (high - low) * scale;
    let mut svg = Svg::new(title, drawing.width, zoom);
    let top = svg.size[1];
    let is_signed = drawing.shades.as_ref().is_some_and(|&(low, high, _)| style::is_signed([low, high]));
    let view = DrawingView { drawing, corner: [margin, top + height], scale, zoom, is_signed };
    // Outlines at the edges are not cut off.
    let (corner, size) =
        ([margin, top].map(|it| it - 0.5 * LINE * zoom), [width, height].map(|it| it + LINE * zoom));
    svg.window(corner, size);
    view.shapes(&mut svg);
    svg.add("</svg>");
    svg.size[1] = top + height + margin;
    if let Some(guide) = &drawing.guide {
        view.guide(&mut svg, guide);
    }
    if let Some((lowest, highest, what)) = &drawing.shades {
        let (heading, ends) = (what.clone(), [*lowest, *highest]);
        svg.size[1] -= 0.5 * margin;
        map::add_colour_bar(&mut svg, &AxisRange { heading, scale: Scale::Linear, ends }, zoom);
    }
    svg
}

/// View of a drawing on a picture.
struct DrawingView<'a> {
    drawing: &'a Drawing,
    /// Position of the window's lower left corner.
    corner: [f64; 2],
    /// Pixels per unit of the drawing.
    scale: f64,
    zoom: f64,
    /// True if shades show a sign.
    is_signed: bool,
}

impl DrawingView<'_> {
    /// Adds the shapes from back to front; consecutive filled discs are drawn together.
    fn shapes(&self, svg: &mut Svg) {
        let is_dot =
            |shape: &DrawnShape| matches!(shape, DrawnShape::Disc { tint, .. } if *tint != Tint::Clear);
        let mut before = 0;
        for alike in self.drawing.shapes.chunk_by(|a, b| is_dot(a) && is_dot(b)) {
            match &alike[0] {
                dot if is_dot(dot) => self.dots(svg, alike),
                shape => self.shape(svg, shape, &self.drawing.shapes[..before]),
            }
            before += alike.len();
        }
    }

    fn ink(&self) -> String {
        stroke(style::INK, LINE * self.zoom)
    }

    fn shape(&self, svg: &mut Svg, shape: &DrawnShape, below: &[DrawnShape]) {
        match shape {
            DrawnShape::Disc { centre, radius, .. } => {
                let ([x, y], radius) = (self.place(*centre).map(tenths), radius.abs() * self.scale);
                let (r, stroke) = (tenths(radius), stroke(style::INK, self.rim(radius)));
                svg.add(format_args!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\" fill=\"none\"{stroke}/>"));
            }
            DrawnShape::Rectangle { corners, tint } => {
                let [[left, bottom], [right, top]] = corners.map(|corner| self.place(corner));
                let place = box_attributes([left, top], [right - left, bottom - top]);
                let fill = self.colour(*tint).map_or("none".to_owned(), |colour| colour.to_string());
                svg.add(format_args!("<rect{place} fill=\"{fill}\"{}/>", self.ink()));
            }
            DrawnShape::Line { ends } => {
                let [[x1, y1], [x2, y2]] = ends.map(|end| self.place(end).map(tenths));
                svg.path(&self.ink(), &format!("M{x1} {y1}L{x2} {y2}"));
            }
            DrawnShape::Text { centre, height, words } => {
                let covers = |[low, high]: [[f64; 2]; 2]| {
                    (0..2).all(|side| (low[side]..=high[side]).contains(&centre[side]))
                };
                let covering = below.iter().rev().filter(|shape| covers(shape.extent()));
                let ground = covering.filter_map(|shape| self.filling(shape)).next().unwrap_or(style::PAPER);
                let ([x, y], height) = (self.place(*centre), height.abs() * self.scale);
                let look = format!("{MIDDLE} fill=\"{}\"", style::ink_on(ground));
                if height > 0.0 {
                    svg.words([x, y + 0.5 * height], height / font::CAPITAL, &look, words);
                }
            }
        }
    }

    /// Adds filled discs, whose order does not matter. Discs of one colour and size are drawn as very short lines with round ends, in a sixth
    /// of the bytes of circles; outlines are larger discs behind all of them.
    fn dots(&self, svg: &mut Svg, discs: &[DrawnShape]) {
        // Centres (tenths of a pixel) by layer, colour and diameter; outlines first.
        let mut alike: BTreeMap<(bool, Colour, i64), Vec<[i64; 2]>> = BTreeMap::new();
        let tenths = |pixels: f64| (10.0 * pixels).round() as i64;
        for shape in discs {
            let DrawnShape::Disc { centre, radius, tint } = shape else { continue };
            let (Some(fill), radius) = (self.colour(*tint), radius.abs() * self.scale) else { continue };
            let middle = self.place(*centre).map(tenths);
            let mut dot = |is_front, colour, diameter: f64| {
                alike.entry((is_front, colour, tenths(diameter))).or_default().push(middle);
            };
            // An outline would hide a small disc.
            let rim = if radius > SMALL * self.zoom { self.rim(radius) } else { 0.0 };
            if rim > 0.0 {
                dot(false, style::INK, 2.0 * radius + rim);
            }
            dot(true, fill, 2.0 * radius - rim);
        }
        svg.add("<g transform=\"scale(.1)\" stroke-linecap=\"round\">");
        for ((_, colour, diameter), mut middles) in alike {
            // Nearby discs are consecutive, which keeps the steps short.
            middles.sort_by_key(|[x, y]| (y.div_euclid(ROW), *x));
            let (mut d, mut at) = (String::new(), [0, 0]);
            for [x, y] in middles {
                let start = if d.is_empty() { 'M' } else { 'm' };
                // Some viewers do not show lines of zero length.
                d += &format!("{start}{} {}h1", x - at[0], y - at[1]);
                at = [x + 1, y];
            }
            svg.path(&stroke(colour, diameter as f64), &d);
        }
        svg.add("</g>");
    }

    /// Adds a scale bar of a round length and the direction of gravity below the window.
    fn guide(&self, svg: &mut Svg, guide: &Guide) {
        let (zoom, size, margin) = (self.zoom, style::LABEL * self.zoom, self.corner[0]);
        let middle = svg.size[1] + 0.5 * size;
        let (base, right) = (middle + 0.5 * size * font::CAPITAL, self.drawing.width - margin);
        let mut d = String::new();
        let mut line = |[x1, y1]: [f64; 2], [x2, y2]: [f64; 2]| {
            d += &format!("M{} {}L{} {}", tenths(x1), tenths(y1), tenths(x2), tenths(y2));
        };
        if let Some([x, y]) = guide.gravity {
            let centre = margin + font::width("gravity", size) + 24.0 * zoom;
            // Arrow in coordinates along gravity and across it; y increases downwards.
            let [x, y] = [x, -y].map(|part| part / x.hypot(y) * zoom);
            let place = |along, across| [centre + along * x - across * y, middle + along * y + across * x];
            line(place(-14.0, 0.0), place(14.0, 0.0));
            [-1.0, 1.0].into_iter().for_each(|side| line(place(14.0, 0.0), place(6.5, 4.5 * side)));
            svg.words([margin, base], size, "", "gravity");
        }
        let length = round(0.25 * (right - margin) / self.scale);
        let left = right - length * self.scale;
        line([left, middle], [right, middle]);
        [left, right].into_iter().for_each(|x| line([x, middle - 6.0 * zoom], [x, middle + 6.0 * zoom]));
        svg.path(&format!(" fill=\"none\"{}", self.ink()), &d);
        let words = format!("{} {}", significant(length, 3), guide.unit);
        svg.words([left - 8.0 * zoom, base], size, END, words.trim_end());
        svg.size[1] = middle + 0.5 * size + margin;
    }

    fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [[left, low], _] = self.drawing.window;
        [self.corner[0] + (x - left) * self.scale, self.corner[1] - (y - low) * self.scale]
    }

    fn rim(&self, radius: f64) -> f64 {
        let [least, most] = RIMS.map(|width| width * self.zoom);
        (RIM * radius).clamp(least, most)
    }

    fn colour(&self, tint: Tint) -> Option<Colour> {
        match tint {
            Tint::Clear => None,
            Tint::Still => Some(style::STILL),
            Tint::Hue(index) => Some(style::hue(index)),
            Tint::Shade(part) => Some(style::shade(style::level(part, self.is_signed))),
        }
    }

    fn filling(&self, shape: &DrawnShape) -> Option<Colour> {
        match shape {
            DrawnShape::Disc { tint, .. } | DrawnShape::Rectangle { tint, .. } => self.colour(*tint),
            _ => None,
        }
    }
}

/// Returns the largest number of the form 1, 2 or 5 times a power of ten that is at most `most`.
fn round(most: f64) -> f64 {
    let power = libm::pow(10.0, libm::log10(most).floor());
    [5.0, 2.0, 1.0].into_iter().map(|factor| factor * power).find(|it| *it <= most).unwrap_or(power)
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
