//! Things where they are, which the library has no plot for.

use super::super::style::{self, Colour};
use super::super::{Drawing, Shape, Tint, font};
use super::colours::{Way, shades};
use super::frame::{colour as paint, theme};
use super::guide;
use super::words::{self, Title};
use kuva::render::color::Color;
use kuva::render::render::{PathData, Primitive, Scene, TextAnchor};
use std::collections::BTreeMap;
use std::fmt::Write;
use stripmine_physics::number::significant;

/// Most width of a colour bar, its thickness, and what is free above it.
const BAR: f64 = 440.0;
const THICKNESS: f64 = 22.0;
const GAP: f64 = 24.0;
/// Width of outlines and lines.
const LINE: f64 = 1.3;
/// Width of a disc's outline, in radii; and its bounds in pixels.
const RIM: f64 = 0.08;
const RIMS: [f64; 2] = [0.4, 1.2];
/// Discs of no more than this radius have no outline (pixels).
const SMALL: f64 = 2.4;
/// Height of the rows in which dots are put in order (tenths of a pixel).
const ROW: i64 = 120;

/// Draws things. Words and lines grow with a drawing that is wider than usual: it will be seen scaled down.
pub fn scene(title: &str, drawing: &Drawing) -> Scene {
    let zoom = (drawing.width / style::WIDTH).max(1.0);
    let margin = style::MARGIN * zoom;
    let title = Title::new(title, drawing.width, zoom);
    let [[left, low], [right, high]] = drawing.window;
    let width = drawing.width - 2.0 * margin;
    let scale = width / (right - left);
    let height = (high - low) * scale;
    let signed = drawing.shades.as_ref().is_some_and(|&(low, high, _)| style::is_signed([low, high]));
    let view = View { drawing, corner: [margin, title.bottom() + height], scale, zoom, signed };

    let mut scene = Scene::new(drawing.width.max(title.width()), title.bottom() + height + margin);
    scene.background_color = Some(theme().background);
    scene.text_color = Some(theme().text_color);
    scene.font_family = Some(style::FONTS.to_owned());
    title.primitives().for_each(|line| scene.add(line));
    let rim = zoom * LINE / 2.0;
    scene.add(Primitive::ClipStart {
        x: margin - rim,
        y: title.bottom() - rim,
        width: width + 2.0 * rim,
        height: height + 2.0 * rim,
        id: "window".to_owned(),
    });
    view.shapes(&mut scene);
    scene.add(Primitive::ClipEnd);
    let mut bottom = view.corner[1];
    if let Some(guide) = &drawing.guide {
        bottom = guide::add_to(&mut scene, guide, scale, zoom, [margin, margin + width], bottom);
        scene.height = bottom + 0.5 * margin;
    }
    if let Some((lowest, highest, what)) = &drawing.shades {
        let gap = if drawing.guide.is_some() { 0.25 } else { 0.75 };
        let below = colour_bar(&mut scene, [*lowest, *highest], what, zoom, bottom + gap * zoom * GAP);
        scene.height = below + margin;
    }
    scene
}

/// A bar with all shades, its ends and its middle marked. Returns where it ends.
fn colour_bar(scene: &mut Scene, ends: [f64; 2], what: &str, zoom: f64, top: f64) -> f64 {
    // Numbers at the bar's ends stand out.
    let width = (scene.width - 2.0 * zoom * (style::MARGIN + GAP)).min(BAR * zoom);
    let left = (scene.width - width) / 2.0;
    let height = THICKNESS * zoom;
    let shades = shades(style::is_signed(ends), Way::Right);
    scene.defs.push(shades.definition);
    let (fill, stroke, stroke_width) = (shades.fill, Some(paint(style::INK)), Some(LINE * zoom));
    scene.add(Primitive::Rect { x: left, y: top, width, height, fill, stroke, stroke_width, opacity: None });
    let size = style::LABEL * zoom;
    let numbers = top + height + size * 1.2;
    for part in [0.0, 0.5, 1.0] {
        let number = significant(ends[0] + part * (ends[1] - ends[0]), 3).replace('-', "−");
        scene.add(words::line([left + part * width, numbers], TextAnchor::Middle, size, &number));
    }
    let size = style::HEADING * zoom;
    let lines = font::wrap(what, size, scene.width - 2.0 * zoom * style::MARGIN);
    for (i, line) in lines.iter().enumerate() {
        let base = numbers + size * style::LINE_SPACING * (1 + i) as f64;
        scene.add(words::line([left + width / 2.0, base], TextAnchor::Middle, size, line));
    }
    numbers + size * (style::LINE_SPACING * lines.len() as f64 + font::DESCENT)
}

/// Dots that are drawn together: whether they are in front, their colour and their diameter (tenths of a pixel).
type Dots = (bool, [u8; 3], i64);

/// A drawing on its picture.
struct View<'a> {
    drawing: &'a Drawing,
    /// Where the window's lower left corner is.
    corner: [f64; 2],
    /// Pixels to a unit of the drawing.
    scale: f64,
    zoom: f64,
    /// Whether shades show a sign.
    signed: bool,
}

impl View<'_> {
    /// Shapes from back to front; filled discs that follow each other are drawn together.
    fn shapes(&self, scene: &mut Scene) {
        let shapes: Vec<_> = self.drawing.shapes.iter().enumerate().collect();
        let dot = |shape: &Shape| matches!(shape, Shape::Disc { tint, .. } if *tint != Tint::Clear);
        for alike in shapes.chunk_by(|a, b| dot(a.1) && dot(b.1)) {
            if dot(alike[0].1) {
                self.dots(scene, alike.iter().map(|(_, shape)| *shape));
            } else {
                scene.elements.extend(self.shape(alike[0].0, alike[0].1));
            }
        }
    }

    fn shape(&self, index: usize, shape: &Shape) -> Option<Primitive> {
        match shape {
            Shape::Disc { centre, radius, .. } => {
                let ([cx, cy], r) = (self.place(*centre), radius.abs() * self.scale);
                let (stroke, stroke_width) = (Some(paint(style::INK)), Some(self.rim(r)));
                Some(Primitive::Circle {
                    cx,
                    cy,
                    r,
                    fill: Color::None,
                    fill_opacity: None,
                    stroke,
                    stroke_width,
                })
            }
            Shape::Rectangle { corners, tint, outlined } => {
                let [[left, bottom], [right, top]] = corners.map(|corner| self.place(corner));
                let line = outlined.then_some(LINE * self.zoom);
                Some(rectangle([left, top], [right - left, bottom - top], self.colour(*tint), line))
            }
            Shape::Line { ends } => {
                let [[x1, y1], [x2, y2]] = ends.map(|end| self.place(end));
                let (stroke, stroke_width) = (paint(style::INK), LINE * self.zoom);
                Some(Primitive::Line { x1, y1, x2, y2, stroke, stroke_width, stroke_dasharray: None })
            }
            Shape::Text { centre, height, words } => {
                let [x, y] = self.place(*centre);
                let height = height.abs() * self.scale;
                let below = self.drawing.shapes[..index].iter().rev().filter(|shape| covers(shape, *centre));
                let ground = below.filter_map(|shape| self.filling(shape)).next().unwrap_or(style::PAPER);
                let ink = if ground.lightness() < 130.0 { style::PAPER } else { style::INK };
                let at = [x, y + height / 2.0];
                let mut line = words::line(at, TextAnchor::Middle, height / font::CAPITAL, words);
                if let Primitive::Text { color, .. } = &mut line {
                    *color = Some(paint(ink));
                }
                (height > 0.0).then_some(line)
            }
        }
    }

    /// Filled discs; which of them is in front makes no difference. Those of one colour and size are the round ends of the
    /// shortest lines of that width, a sixth of what circles take; outlines are larger discs behind all of them.
    fn dots<'b>(&self, scene: &mut Scene, discs: impl Iterator<Item = &'b Shape>) {
        // Their middles (tenths of a pixel); outlines first.
        let mut alike: BTreeMap<Dots, Vec<[i64; 2]>> = BTreeMap::new();
        let tenths = |pixels: f64| (10.0 * pixels).round() as i64;
        for shape in discs {
            let Shape::Disc { centre, radius, tint } = shape else { continue };
            let (Some(fill), radius) = (self.colour(*tint), radius.abs() * self.scale) else { continue };
            let middle = self.place(*centre).map(tenths);
            let mut dot = |front: bool, Colour(red, green, blue): Colour, diameter: f64| {
                alike.entry((front, [red, green, blue], tenths(diameter))).or_default().push(middle);
            };
            // An outline would hide a disc of a few pixels.
            let rim = if radius > SMALL * self.zoom { self.rim(radius) } else { 0.0 };
            if rim > 0.0 {
                dot(false, style::INK, 2.0 * radius + rim);
            }
            dot(true, fill, 2.0 * radius - rim);
        }
        let round = Some("stroke-linecap=\"round\"".to_owned());
        let tenths = Some("scale(.1)".to_owned());
        scene.add(Primitive::GroupStart { transform: tenths, title: None, extra_attrs: round });
        for ((_, [red, green, blue], diameter), mut middles) in alike {
            // Near ones follow each other, which makes the steps between them short.
            middles.sort_by_key(|[x, y]| (y.div_euclid(ROW), *x));
            let (mut d, mut at) = (String::new(), [0, 0]);
            for [x, y] in middles {
                let start = if d.is_empty() { 'M' } else { 'm' };
                // Some viewers show nothing of a line without a length.
                let _ = write!(d, "{start}{} {}h1", x - at[0], y - at[1]);
                at = [x + 1, y];
            }
            let (stroke, stroke_width) = (Color::Rgb(red, green, blue), diameter as f64);
            let path =
                PathData { d, fill: None, stroke, stroke_width, opacity: None, stroke_dasharray: None };
            scene.add(Primitive::Path(Box::new(path)));
        }
        scene.add(Primitive::GroupEnd);
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
            Tint::Shade(place) => Some(style::shade(style::level(place, self.signed))),
        }
    }

    fn filling(&self, shape: &Shape) -> Option<Colour> {
        match shape {
            Shape::Disc { tint, .. } | Shape::Rectangle { tint, .. } => self.colour(*tint),
            Shape::Line { .. } | Shape::Text { .. } => None,
        }
    }
}

fn rectangle(
    [x, y]: [f64; 2],
    [width, height]: [f64; 2],
    fill: Option<Colour>,
    line: Option<f64>,
) -> Primitive {
    let fill = fill.map_or(Color::None, paint);
    let stroke = line.map(|_| paint(style::INK));
    Primitive::Rect { x, y, width, height, fill, stroke, stroke_width: line, opacity: None }
}

fn covers(shape: &Shape, [x, y]: [f64; 2]) -> bool {
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
