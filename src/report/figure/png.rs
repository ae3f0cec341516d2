//! A figure as a picture of dots, for papers and slides: the vector picture, seen by `resvg`.

use super::{Fault, Figure, FigureError, draw, style, svg};
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb::Database};
use std::sync::{Arc, LazyLock};

/// Most dots of a picture: as many as fit in 400 MB.
const MOST_DOTS: f64 = 1e8;

/// The one font, which is part of the program: no picture depends on what a machine has installed.
static FONTS: LazyLock<Arc<Database>> = LazyLock::new(|| {
    let mut fonts = Database::new();
    fonts.load_font_data(dejavu::sans::regular().to_vec());
    Arc::new(fonts)
});

/// Draws a figure as PNG, with [`style::DOTS`] dots to a pixel.
///
/// # Errors
/// When the figure cannot be drawn, or has too many dots.
pub fn png(figure: &Figure) -> Result<Vec<u8>, FigureError> {
    let scene = draw::scene(figure)?;
    let (width, height) = (scene.width, scene.height);
    let too_large = || Fault::Size { width, height }.of(&figure.name);
    let [across, down] = [width, height].map(|side| (side * style::DOTS).ceil());
    if across * down > MOST_DOTS {
        return Err(too_large());
    }
    let drawn = |problem: String| Fault::Drawing { problem }.of(&figure.name);
    let tree = tree(&svg::written(figure, &scene)?).map_err(drawn)?;
    let mut picture = Pixmap::new(across as u32, down as u32).ok_or_else(too_large)?;
    let dots = style::DOTS as f32;
    resvg::render(&tree, Transform::from_scale(dots, dots), &mut picture.as_mut());
    picture.encode_png().map_err(|error| drawn(error.to_string()))
}

/// A vector picture, read.
pub(super) fn tree(text: &str) -> Result<Tree, String> {
    let options = Options { fontdb: FONTS.clone(), ..Options::default() };
    Tree::from_str(text, &options).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::super::{Picture, samples};
    use super::*;

    #[test]
    fn the_same_figure_gives_the_same_bytes() {
        let figure = samples::logarithmic();
        assert_eq!(png(&figure).unwrap(), png(&figure).unwrap());
    }

    #[test]
    fn a_map_has_its_colours() {
        let figure = samples::map();
        let Picture::Map(map) = &figure.picture else { unreachable!() };
        let picture = Pixmap::decode_png(&png(&figure).unwrap()).unwrap();
        let seen: std::collections::BTreeSet<_> =
            picture.pixels().iter().map(|dot| [dot.red(), dot.green(), dot.blue()]).collect();
        let expected = [0, style::SHADES / 2, style::SHADES - 1].map(style::shade);
        assert!(map.rows.len() > 1 && expected.iter().all(|it| seen.contains(&[it.0, it.1, it.2])));
    }

    #[test]
    fn a_picture_with_too_many_dots_is_an_error() {
        let mut figure = samples::pipe();
        if let Picture::Drawing(drawing) = &mut figure.picture {
            drawing.width = 49_000.0;
        }
        assert!(matches!(png(&figure), Err(FigureError { fault: Fault::Size { .. }, .. })));
    }
}
