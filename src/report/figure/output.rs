//! SVG and PNG of a figure. The PNG, for papers and slides, is the SVG rendered by `resvg`.

use super::check::check;
use super::{Figure, FigureError, Picture, drawing, map, plot};
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb::Database};
use std::sync::{Arc, LazyLock};

/// Dots of a PNG per pixel.
const DOTS: f64 = 2.0;
/// Maximum dots of a picture, which take 400 MB.
const MOST_DOTS: f64 = 1e8;

/// Font embedded in the program, so that pictures do not depend on the fonts of a machine.
static FONTS: LazyLock<Arc<Database>> = LazyLock::new(|| {
    let mut fonts = Database::new();
    fonts.load_font_data(dejavu::sans::regular().to_vec());
    Arc::new(fonts)
});

/// Draws a figure as SVG.
///
/// # Errors
/// [`FigureError`] if the figure cannot be drawn.
pub fn svg(figure: &Figure) -> Result<String, FigureError> {
    let failed = |problem| FigureError { figure: figure.name.clone(), problem };
    check(&figure.picture).map_err(failed)?;
    let drawn = match &figure.picture {
        Picture::Charts(panels) => plot::draw(&figure.title, panels),
        Picture::Map(map) => map::draw(&figure.title, map),
        Picture::Drawing(drawing) => Ok(drawing::draw(&figure.title, drawing)),
        Picture::Drawn { svg, .. } => return Ok(svg.clone()),
    };
    Ok(drawn.map_err(failed)?.finish(figure))
}

/// Draws a figure as PNG, with two dots per pixel.
///
/// # Errors
/// [`FigureError`] if the figure cannot be drawn or has too many dots.
pub(crate) fn png(figure: &Figure) -> Result<Vec<u8>, FigureError> {
    let failed = |problem: String| FigureError { figure: figure.name.clone(), problem };
    let tree = tree(&svg(figure)?).map_err(failed)?;
    let size = tree.size();
    let [across, down] = [size.width(), size.height()].map(|side| (f64::from(side) * DOTS).ceil());
    let picture = if across * down > MOST_DOTS { None } else { Pixmap::new(across as u32, down as u32) };
    let mut picture = picture.ok_or_else(|| {
        failed(format!("a picture of {across} by {down} dots is too large; the maximum is {MOST_DOTS} dots"))
    })?;
    let dots = DOTS as f32;
    resvg::render(&tree, Transform::from_scale(dots, dots), &mut picture.as_mut());
    picture.encode_png().map_err(|error| failed(error.to_string()))
}

/// Parses an SVG picture.
pub(super) fn tree(text: &str) -> Result<Tree, String> {
    let options = Options { fontdb: FONTS.clone(), ..Options::default() };
    Tree::from_str(text, &options).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::super::tests::samples;
    use super::super::{Picture, style};
    use super::*;

    #[test]
    fn png_is_reproducible() {
        let figure = samples::logarithmic();
        assert_eq!(png(&figure).unwrap(), png(&figure).unwrap());
    }

    #[test]
    fn a_map_has_the_colours_of_its_values() {
        let figure = samples::map();
        let Picture::Map(map) = &figure.picture else { unreachable!() };
        let picture = Pixmap::decode_png(&png(&figure).unwrap()).unwrap();
        let seen: std::collections::BTreeSet<_> =
            picture.pixels().iter().map(|dot| [dot.red(), dot.green(), dot.blue()]).collect();
        let expected = [0, style::SHADES / 2, style::SHADES - 1].map(style::shade);
        assert!(map.rows.len() > 1 && expected.iter().all(|it| seen.contains(&it.channels())));
    }

    #[test]
    fn too_many_dots_are_an_error() {
        let mut figure = samples::pipe();
        if let Picture::Drawing(drawing) = &mut figure.picture {
            drawing.width = 49_000.0;
        }
        let error = png(&figure).unwrap_err();
        assert!(error.problem.contains("98000 by") && error.figure == "pipe", "{error}");
    }
}
