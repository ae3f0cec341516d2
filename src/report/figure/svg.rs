//! A figure as a vector picture that says what it shows, and is the same from run to run.

use super::{Figure, FigureError, draw};
use kuva::prelude::SvgBackend;
use kuva::render::render::{Primitive, Scene};

/// Draws a figure as SVG.
///
/// # Errors
/// When the figure cannot be drawn.
pub fn svg(figure: &Figure) -> Result<String, FigureError> {
    Ok(written(figure, &draw::scene(figure)?))
}

/// A scene as the picture of a figure.
pub(super) fn written(figure: &Figure, scene: &Scene) -> String {
    let (width, height) = (scene.width.ceil(), scene.height.ceil());
    let mut text = SvgBackend::new().render_scene(scene);
    // The library numbers windows over the whole program; here their names depend on the figure alone, which also keeps
    // them apart on a page.
    let windows = scene.elements.iter().filter_map(|it| match it {
        Primitive::ClipStart { id, .. } => Some(id),
        _ => None,
    });
    for (i, id) in windows.enumerate() {
        text = text.replace(&format!("id=\"{id}\""), &format!("id=\"{}-{i}\"", figure.name));
        text = text.replace(&format!("url(#{id})"), &format!("url(#{}-{i})", figure.name));
    }
    let opening = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         role=\"img\" font-family=\"{}\" fill=\"{}\" stroke-linejoin=\"round\">\n<title>{}</title>\n<desc>{}</desc>\n",
        super::style::FONTS,
        super::style::INK,
        escaped(&figure.title),
        escaped(&figure.caption)
    );
    // What follows the library's own opening, an element a line.
    let rest = text.split_once('>').map_or("", |(_, rest)| rest);
    format!("{opening}{}\n", rest.replace("><", ">\n<"))
}

/// Words with the signs that mean something in XML spelled out; those it has no place for are blanks.
fn escaped(words: &str) -> String {
    let mut all = String::new();
    for letter in words.chars() {
        match letter {
            '&' => all.push_str("&amp;"),
            '<' => all.push_str("&lt;"),
            '>' => all.push_str("&gt;"),
            '\u{fffe}' | '\u{ffff}' => all.push(' '),
            control if control.is_control() => all.push(' '),
            other => all.push(other),
        }
    }
    all
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
