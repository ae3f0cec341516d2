//! A figure as a picture of dots, for papers and slides.

use super::sheet::{Area, Mark, Paint, Place, Sheet};
use super::style::{self, Colour};
use super::{Fault, Figure, FigureError, font, layout};
use tiny_skia::{FillRule, LineJoin, Mask, Path, PathBuilder, Pixmap, StrokeDash, Transform};
use ttf_parser::OutlineBuilder;

/// Most dots of a picture: as many as fit in 400 MB.
const MOST_DOTS: f64 = 1e8;

/// Draws a figure as PNG, with [`style::DOTS`] dots to a pixel.
///
/// # Errors
/// When the figure cannot be drawn, or has too many dots.
pub fn png(figure: &Figure) -> Result<Vec<u8>, FigureError> {
    let Sheet { width, height, marks } = layout::sheet(figure)?;
    let too_large = || Fault::Size { width, height }.of(&figure.name);
    let [across, down] = [width, height].map(|side| (side * style::DOTS).ceil());
    if across * down > MOST_DOTS {
        return Err(too_large());
    }
    let mut picture = Pixmap::new(across as u32, down as u32).ok_or_else(too_large)?;
    picture.fill(opaque(style::PAPER));
    for mark in &marks {
        paint_mark(&mut picture, mark, None);
    }
    picture.encode_png().map_err(|_| too_large())
}

fn paint_mark(picture: &mut Pixmap, mark: &Mark, window: Option<&Mask>) {
    match mark {
        Mark::Lines { pieces, closed, paint } => {
            if let Some(path) = lines(pieces, *closed) {
                paint_path(picture, &path, *paint, window);
            }
        }
        Mark::Disc { centre: [x, y], radius, paint } => {
            if let Some(path) = PathBuilder::from_circle(*x as f32, *y as f32, *radius as f32) {
                paint_path(picture, &path, *paint, window);
            }
        }
        Mark::Words { at, anchor, upwards, size, colour, words } => {
            let before = anchor.part_before() * font::width(words, *size);
            let letters = font::outline(words, *size, |right, scale| Pen {
                path: PathBuilder::new(),
                at: *at,
                right: right - before,
                scale,
                upwards: *upwards,
            });
            for path in letters.into_iter().filter_map(|pen| pen.path.finish()) {
                paint_path(picture, &path, Paint::fill(*colour), window);
            }
        }
        Mark::Cells { area, columns, levels } => paint_cells(picture, *area, *columns, levels),
        Mark::Window { area, marks } => {
            let path = lines(&[area.corners()], true);
            let Some((mut mask, path)) = Mask::new(picture.width(), picture.height()).zip(path) else {
                return;
            };
            mask.fill_path(&path, FillRule::Winding, true, to_dots());
            for mark in marks {
                paint_mark(picture, mark, Some(&mask));
            }
        }
    }
}

fn paint_path(picture: &mut Pixmap, path: &Path, paint: Paint, window: Option<&Mask>) {
    if let Some(colour) = paint.fill {
        picture.fill_path(path, &solid(colour), FillRule::Winding, to_dots(), window);
    }
    if let Some(stroke) = paint.stroke {
        let dash = stroke.dash.iter().map(|&part| part as f32).collect();
        let look = tiny_skia::Stroke {
            width: stroke.width as f32,
            line_join: LineJoin::Round,
            dash: StrokeDash::new(dash, 0.0),
            ..tiny_skia::Stroke::default()
        };
        picture.stroke_path(path, &solid(stroke.colour), &look, to_dots(), window);
    }
}

/// Fills whole dots, so that no seam shows between cells.
fn paint_cells(picture: &mut Pixmap, area: Area, columns: usize, levels: &[u8]) {
    let rows = levels.len() / columns;
    let edge = |start: f64, length: f64, i: usize, n: usize| {
        ((start + length * i as f64 / n as f64) * style::DOTS).round() as f32
    };
    for (j, row) in levels.chunks(columns).enumerate() {
        let [top, bottom] = [j, j + 1].map(|j| edge(area.top, area.height, j, rows));
        let mut i = 0;
        for run in row.chunk_by(|a, b| a == b) {
            let [left, right] = [i, i + run.len()].map(|i| edge(area.left, area.width, i, columns));
            if let Some(cell) = tiny_skia::Rect::from_ltrb(left, top, right, bottom) {
                let mut paint = solid(style::shade(run[0]));
                paint.anti_alias = false;
                picture.fill_rect(cell, &paint, Transform::identity(), None);
            }
            i += run.len();
        }
    }
}

fn lines(pieces: &[Vec<Place>], closed: bool) -> Option<Path> {
    let mut path = PathBuilder::new();
    for piece in pieces {
        for (i, &[x, y]) in piece.iter().enumerate() {
            let (x, y) = (x as f32, y as f32);
            if i == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
        }
        if closed {
            path.close();
        }
    }
    path.finish()
}

fn to_dots() -> Transform {
    Transform::from_scale(style::DOTS as f32, style::DOTS as f32)
}

fn opaque(Colour(red, green, blue): Colour) -> tiny_skia::Color {
    tiny_skia::Color::from_rgba8(red, green, blue, 255)
}

fn solid(colour: Colour) -> tiny_skia::Paint<'static> {
    let mut paint = tiny_skia::Paint::default();
    paint.set_color(opaque(colour));
    paint
}

/// Draws a letter of the font where it belongs on the sheet.
struct Pen {
    path: PathBuilder,
    /// Where the words stand.
    at: Place,
    /// How far along the line the letter begins.
    right: f64,
    /// Pixels to a unit of the font.
    scale: f64,
    upwards: bool,
}

impl Pen {
    fn on_sheet(&self, x: f32, y: f32) -> (f32, f32) {
        let along = self.right + f64::from(x) * self.scale;
        let above = f64::from(y) * self.scale;
        let [dx, dy] = if self.upwards { [-above, -along] } else { [along, -above] };
        ((self.at[0] + dx) as f32, (self.at[1] + dy) as f32)
    }
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.on_sheet(x, y);
        self.path.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.on_sheet(x, y);
        self.path.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ((x1, y1), (x, y)) = (self.on_sheet(x1, y1), self.on_sheet(x, y));
        self.path.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ((x1, y1), (x2, y2), (x, y)) =
            (self.on_sheet(x1, y1), self.on_sheet(x2, y2), self.on_sheet(x, y));
        self.path.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

#[cfg(test)]
mod tests {
    use super::super::samples;
    use super::*;

    fn dot(picture: &Pixmap, [x, y]: [u32; 2]) -> Colour {
        let dot = picture.pixel(x, y).unwrap();
        Colour(dot.red(), dot.green(), dot.blue())
    }

    fn painted(mark: Mark) -> Pixmap {
        let mut picture = Pixmap::new(40, 40).unwrap();
        picture.fill(opaque(style::PAPER));
        paint_mark(&mut picture, &mark, None);
        picture
    }

    #[test]
    fn the_same_figure_gives_the_same_bytes() {
        let figure = samples::logarithmic();
        assert_eq!(png(&figure).unwrap(), png(&figure).unwrap());
    }

    #[test]
    fn cells_and_windows_are_where_they_must_be() {
        let area = Area { left: 0.0, top: 0.0, width: 20.0, height: 20.0 };
        let picture = painted(Mark::Cells { area, columns: 2, levels: vec![0, 127, 64, 0] });
        assert_eq!(dot(&picture, [1, 1]), style::shade(0));
        assert_eq!(dot(&picture, [38, 1]), style::shade(127));
        assert_eq!(dot(&picture, [1, 38]), style::shade(64));

        let disc = Mark::Disc { centre: [10.0, 10.0], radius: 9.0, paint: Paint::fill(Colour(0, 0, 0)) };
        let half = Area { left: 0.0, top: 0.0, width: 10.0, height: 20.0 };
        let picture = painted(Mark::Window { area: half, marks: vec![disc] });
        assert_eq!(dot(&picture, [10, 20]), Colour(0, 0, 0));
        assert_eq!(dot(&picture, [30, 20]), style::PAPER);
    }

    #[test]
    fn a_picture_with_too_many_dots_is_an_error() {
        let mut figure = samples::pipe();
        if let super::super::Picture::Drawing(drawing) = &mut figure.picture {
            drawing.width = 49_000.0;
        }
        assert!(matches!(png(&figure), Err(FigureError { fault: Fault::Size { .. }, .. })));
    }
}
