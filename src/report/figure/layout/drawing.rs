//! Drawings on their sheet.

use super::super::sheet::{Anchor, Area, Mark, Paint, Place, Sheet, Stroke};
use super::super::style::{self, Colour};
use super::super::{Axis, Drawing, Fault, Shape, Tint, font};
use super::colour_bar::{ColourBar, GAP, THICKNESS};
use super::title::Title;

/// Most width of a colour bar.
const BAR: f64 = 440.0;
/// Width of outlines and lines.
const LINE: f64 = 1.3;
/// Width of a disc's outline, in radii; and its bounds in pixels.
const RIM: f64 = 0.08;
const RIMS: [f64; 2] = [0.4, 1.2];

/// Lays a drawing out. Words and lines grow with a drawing that is wider than usual: it will be seen scaled down.
pub fn lay_out(title: &str, drawing: &Drawing) -> Result<Sheet, Fault> {
    let zoom = (drawing.width / style::WIDTH).max(1.0);
    let margin = style::MARGIN * zoom;
    let title = Title::new(title, drawing.width, zoom);
    let [[left, low], [right, high]] = drawing.window;
    let width = drawing.width - 2.0 * margin;
    let scale = width / (right - left);
    let window = Area { left: margin, top: title.bottom(), width, height: (high - low) * scale };
    let view = View { drawing, window, scale, zoom };

    let mut marks = title.marks();
    let shapes = (0..drawing.shapes.len()).flat_map(|i| view.marks(i)).collect();
    marks.push(Mark::Window { area: window.grown(zoom * LINE / 2.0), marks: shapes });
    let mut bottom = window.bottom();
    if let Some((lowest, highest, what)) = &drawing.shades {
        // Numbers at the bar's ends stand out.
        let length = (width - 2.0 * zoom * GAP).min(BAR * zoom);
        let left = (drawing.width - length) / 2.0;
        let top = bottom + 0.75 * zoom * GAP;
        let area = Area { left, top, width: length, height: THICKNESS * zoom };
        let bar = ColourBar::new(&Axis::linear(what, None), [*lowest, *highest], area, true, zoom);
        marks.extend(bar.marks());
        bottom = area.bottom() + bar.depth();
    }
    Ok(Sheet { width: drawing.width.max(title.width()), height: bottom + margin, marks })
}

/// A drawing seen through its window on the sheet.
struct View<'a> {
    drawing: &'a Drawing,
    window: Area,
    /// Pixels to a unit of the drawing.
    scale: f64,
    zoom: f64,
}

impl View<'_> {
    fn marks(&self, index: usize) -> Option<Mark> {
        match &self.drawing.shapes[index] {
            Shape::Disc { centre, radius, tint } => {
                let radius = radius.abs() * self.scale;
                let [least, most] = RIMS.map(|width| width * self.zoom);
                // An outline would hide a disc of a few pixels.
                let rim = radius > 4.0 * least || *tint == Tint::Clear;
                let stroke = rim.then(|| self.outline((RIM * radius).clamp(least, most)));
                Some(Mark::Disc {
                    centre: self.place(*centre),
                    radius,
                    paint: Paint { fill: colour(*tint, self.signed()), stroke },
                })
            }
            Shape::Rectangle { corners, tint, outlined } => {
                let stroke = outlined.then(|| self.outline(LINE * self.zoom));
                let [[left, bottom], [right, top]] = corners.map(|corner| self.place(corner));
                let pieces = vec![vec![[left, top], [right, top], [right, bottom], [left, bottom]]];
                Some(Mark::Lines {
                    pieces,
                    closed: true,
                    paint: Paint { fill: colour(*tint, self.signed()), stroke },
                })
            }
            Shape::Line { ends } => {
                let pieces = vec![ends.map(|end| self.place(end)).to_vec()];
                Some(Mark::Lines {
                    pieces,
                    closed: false,
                    paint: Paint::stroke(style::INK, LINE * self.zoom),
                })
            }
            Shape::Text { centre, height, words } => {
                let [x, y] = self.place(*centre);
                let height = height.abs() * self.scale;
                let below = self.drawing.shapes[..index].iter().rev();
                let ground = below
                    .filter(|shape| covers(shape, *centre))
                    .find_map(|shape| filling(shape, self.signed()))
                    .unwrap_or(style::PAPER);
                (height > 0.0).then(|| Mark::Words {
                    at: [x, y + height / 2.0],
                    anchor: Anchor::Middle,
                    upwards: false,
                    size: height / font::CAPITAL,
                    colour: if ground.lightness() < 130.0 { style::PAPER } else { style::INK },
                    words: words.clone(),
                })
            }
        }
    }

    /// Whether shades show a sign.
    fn signed(&self) -> bool {
        self.drawing.shades.as_ref().is_some_and(|&(low, high, _)| style::is_signed([low, high]))
    }

    fn place(&self, [x, y]: Place) -> Place {
        let [[left, low], _] = self.drawing.window;
        [self.window.left + (x - left) * self.scale, self.window.bottom() - (y - low) * self.scale]
    }

    fn outline(&self, width: f64) -> Stroke {
        Stroke { colour: style::INK, width, dash: &[] }
    }
}

fn colour(tint: Tint, signed: bool) -> Option<Colour> {
    match tint {
        Tint::Clear => None,
        Tint::Still => Some(style::STILL),
        Tint::Hue(index) => Some(style::hue(index)),
        Tint::Shade(place) => Some(style::shade(style::level(place, signed))),
    }
}

fn filling(shape: &Shape, signed: bool) -> Option<Colour> {
    match shape {
        Shape::Disc { tint, .. } | Shape::Rectangle { tint, .. } => colour(*tint, signed),
        Shape::Line { .. } | Shape::Text { .. } => None,
    }
}

fn covers(shape: &Shape, [x, y]: Place) -> bool {
    match shape {
        Shape::Disc { centre: [cx, cy], radius, .. } => {
            let [dx, dy] = [x - cx, y - cy];
            dx * dx + dy * dy <= radius * radius
        }
        Shape::Rectangle { corners: [[left, low], [right, high]], .. } => {
            (*left..=*right).contains(&x) && (*low..=*high).contains(&y)
        }
        Shape::Line { .. } | Shape::Text { .. } => false,
    }
}
