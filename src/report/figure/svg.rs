//! A figure as a vector picture that says what it shows, is the same from run to run, and is small enough to stand in a page:
//! lines of one look are one path, words of one look one group, and numbers end where nothing more can be seen.
//!
//! What names a series, a band or a cell is a `<title>` about it, and the plane between the axes says in `data-x` and `data-y`
//! where numbers lie on it: a reader of the picture finds the values there.

use super::xml::{escaped, tenths};
use super::{Fault, Figure, FigureError, Picture, draw, style};
use kuva::render::color::Color;
use kuva::render::render::{PathData, Primitive, Scene, TextAnchor};
use std::fmt::Write;

/// Draws a figure as SVG.
///
/// # Errors
/// When the figure cannot be drawn.
pub fn svg(figure: &Figure) -> Result<String, FigureError> {
    if let Picture::Drawn { svg, .. } = &figure.picture {
        return Ok(svg.clone());
    }
    written(figure, &draw::scene(figure)?)
}

/// A scene as the picture of a figure.
pub(super) fn written(figure: &Figure, scene: &Scene) -> Result<String, FigureError> {
    let (width, height) = (scene.width.ceil(), scene.height.ceil());
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         role=\"img\" font-family=\"{}\" fill=\"{}\" stroke-linejoin=\"round\">\n\
         <style>@media (prefers-color-scheme:dark){{{}}}</style>\n<title>{}</title>\n<desc>{}</desc>\n",
        style::FONTS,
        style::INK,
        style::dark_rules(""),
        escaped(&figure.title),
        escaped(&figure.caption)
    );
    if !scene.defs.is_empty() {
        let _ = writeln!(text, "<defs>\n{}\n</defs>", scene.defs.join("\n"));
    }
    let _ = writeln!(text, "<rect width=\"{width}\" height=\"{height}\" fill=\"{}\"/>", style::PAPER);
    let marks = |it: &Primitive| matches!(it, Primitive::Line { .. } | Primitive::Text { .. });
    for alike in scene.elements.chunk_by(|a, b| marks(a) && marks(b)) {
        if marks(&alike[0]) {
            lines(&mut text, alike);
            words(&mut text, alike);
        } else {
            element(&mut text, &alike[0]).map_err(|fault| fault.of(&figure.name))?;
        }
    }
    text.push_str("</svg>\n");
    Ok(text)
}

/// The lines among axes' marks, those of one look as one path.
fn lines(text: &mut String, marks: &[Primitive]) {
    let mut paths: Vec<(String, String)> = vec![];
    for mark in marks {
        let Primitive::Line { x1, y1, x2, y2, stroke, stroke_width, stroke_dasharray } = mark else {
            continue;
        };
        let look = outline(stroke, *stroke_width, stroke_dasharray.as_deref());
        let [x1, y1, x2, y2] = [x1, y1, x2, y2].map(|end| tenths(*end));
        let to = match (x1 == x2, y1 == y2) {
            (true, _) => format!("V{y2}"),
            (_, true) => format!("H{x2}"),
            _ => format!("L{x2} {y2}"),
        };
        let line = format!("M{x1} {y1}{to}");
        match paths.iter_mut().find(|(known, _)| *known == look) {
            Some((_, path)) => path.push_str(&line),
            None => paths.push((look, line)),
        }
    }
    for (look, path) in paths {
        let _ = writeln!(text, "<path{look} d=\"{path}\"/>");
    }
}

/// The words among axes' marks, those of one look that follow each other as one group.
fn words(text: &mut String, marks: &[Primitive]) {
    let mut before = String::new();
    for mark in marks {
        let Primitive::Text { x, y, content, size, anchor, rotate, color, .. } = mark else { continue };
        // A mark of an axis without a number.
        if content.is_empty() {
            continue;
        }
        let mut look = format!(" font-size=\"{size}\"");
        match anchor {
            TextAnchor::Start => {}
            TextAnchor::Middle => look.push_str(" text-anchor=\"middle\""),
            TextAnchor::End => look.push_str(" text-anchor=\"end\""),
        }
        if let Some(colour) = color {
            let _ = write!(look, " fill=\"{}\"", colour.to_svg_string());
        }
        if look != before {
            text.push_str(if before.is_empty() { "" } else { "</g>\n" });
            let _ = writeln!(text, "<g{look}>");
            before = look;
        }
        let [x, y] = [x, y].map(|at| tenths(*at));
        let turned = rotate.map_or(String::new(), |angle| format!(" transform=\"rotate({angle} {x} {y})\""));
        let _ = writeln!(text, "<text x=\"{x}\" y=\"{y}\"{turned}>{}</text>", escaped(content));
    }
    text.push_str(if before.is_empty() { "" } else { "</g>\n" });
}

/// Anything else.
fn element(text: &mut String, it: &Primitive) -> Result<(), Fault> {
    let filled = |fill: &Color| format!(" fill=\"{}\"", fill.to_svg_string());
    let edge = |stroke: &Option<Color>, width: &Option<f64>| match (stroke, width) {
        (Some(stroke), Some(width)) => outline(stroke, *width, None),
        _ => String::new(),
    };
    let attribute = |name: &str, value: &Option<String>| {
        value.as_ref().map_or(String::new(), |value| format!(" {name}=\"{value}\""))
    };
    let _ = match it {
        Primitive::Circle { cx, cy, r, fill, stroke, stroke_width, .. } => {
            let [cx, cy, r] = [cx, cy, r].map(|at| tenths(*at));
            let look = filled(fill) + &edge(stroke, stroke_width);
            writeln!(text, "<circle cx=\"{cx}\" cy=\"{cy}\" r=\"{r}\"{look}/>")
        }
        Primitive::Rect { x, y, width, height, fill, stroke, stroke_width, .. } => {
            let look = filled(fill) + &edge(stroke, stroke_width);
            writeln!(text, "<rect{}{look}/>", at([*x, *y, *width, *height]))
        }
        Primitive::RectBatch { x, y, w, h, fills } => (0..fills.len())
            .try_for_each(|i| writeln!(text, "<rect{}{}/>", at([x[i], y[i], w[i], h[i]]), filled(&fills[i]))),
        Primitive::Path(path) => {
            let PathData { d, fill, stroke, stroke_width, opacity, stroke_dasharray } = &**path;
            // Without a filling of its own it has that of what it stands in: none on the plane of a chart; and a straight line has none.
            let through = opacity.map_or(String::new(), |part| format!(" fill-opacity=\"{part}\""));
            let look = fill.as_ref().map_or(String::new(), filled)
                + &through
                + &outline(stroke, *stroke_width, stroke_dasharray.as_deref());
            writeln!(text, "<path{look} d=\"{d}\"/>")
        }
        Primitive::GroupStart { transform, title, extra_attrs } => {
            let more = extra_attrs.as_ref().map_or(String::new(), |more| format!(" {more}"));
            let title = title.as_ref().map_or(String::new(), |it| format!("<title>{}</title>", escaped(it)));
            writeln!(text, "<g{}{more}>{title}", attribute("transform", transform))
        }
        // A window within the picture cuts off what reaches beyond it, and needs no name.
        Primitive::ClipStart { x, y, width, height, .. } => {
            let [left, top, across, down] = [x, y, width, height].map(|side| tenths(*side));
            let view = format!(" viewBox=\"{left} {top} {across} {down}\"");
            writeln!(text, "<svg{}{view}>", at([*x, *y, *width, *height]))
        }
        Primitive::GroupEnd => writeln!(text, "</g>"),
        Primitive::ClipEnd => writeln!(text, "</svg>"),
        other => {
            let problem = format!("nothing is known of {:?}", std::mem::discriminant(other));
            return Err(Fault::Drawing { problem });
        }
    };
    Ok(())
}

/// A line's look as attributes. Without a filling, as all lines here are.
fn outline(stroke: &Color, width: f64, dash: Option<&str>) -> String {
    if matches!(stroke, Color::None) {
        return String::new();
    }
    let dash = dash.map_or(String::new(), |dash| format!(" stroke-dasharray=\"{dash}\""));
    let width = if width == 1.0 { String::new() } else { format!(" stroke-width=\"{}\"", tenths(width)) };
    format!(" stroke=\"{}\"{width}{dash}", stroke.to_svg_string())
}

fn at(place: [f64; 4]) -> String {
    let [x, y, width, height] = place.map(tenths);
    format!(" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"")
}

#[cfg(test)]
mod tests {
    use super::super::samples;
    use super::*;

    #[test]
    fn the_same_figure_gives_the_same_bytes() {
        for figure in samples::all() {
            assert_eq!(svg(&figure).unwrap(), svg(&figure.clone()).unwrap());
        }
    }

    #[test]
    fn words_cannot_break_out() {
        let mut figure = samples::linear();
        figure.title = "</text><script>1 & 2\u{1}".into();
        let text = svg(&figure).unwrap();
        assert!(!text.contains("<script>") && text.contains("&lt;script&gt;1 &amp; 2"));
    }
}
