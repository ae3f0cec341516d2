//! Maps: the library's axes and colour bar, and cells that are merged where neighbours have one colour.

use super::super::xml::escaped;
use super::super::{Fault, Map, style};
use super::axis::Span;
use super::colours::Shades;
use super::frame::{Frame, colour};
use super::series::group;
use super::words;
use kuva::plot::Heatmap;
use kuva::prelude::Plot;
use kuva::render::layout::ComputedLayout;
use kuva::render::render::{PathData, Primitive, Scene, TextAnchor};
use std::fmt::Write;
use stripmine_physics::number::significant;

/// From the colour bar's heading to the bar (pixels).
const TO_BAR: f64 = 9.0;

/// Draws a map.
pub fn scene(title: &str, map: &Map) -> Result<Scene, Fault> {
    let x = Span::exact(&map.x, std::iter::empty())?;
    let y = Span::exact(&map.y, std::iter::empty())?;
    let shades = Shades::new(&map.value, map.rows.iter().flatten().copied())?;
    // The library reckons its colour bar from two cells, which are left away.
    let bar = Heatmap::new().with_data([shades.ends]).with_color_map(shades.map());
    let heading = map.value.heading();
    let frame = Frame { title, x: &x, y: &y, right: None, height: style::PLOT_HEIGHT };
    let mut drawn = frame.draw(vec![Plot::Heatmap(bar)], |asked| {
        let mut asked = asked.with_colorbar_tick_format(shades.format());
        asked.show_grid = false;
        asked
    });
    drawn.scene.elements.retain(|it| !matches!(it, Primitive::RectBatch { .. }));
    let cells = cells(map, &shades, &drawn.places);
    drawn.fill(&x, &y, &format!(" data-value=\"{}\"", escaped(&heading)), cells);
    let (x, y) = (drawn.places.width - drawn.places.colorbar_x_inset - TO_BAR, drawn.places.margin_top);
    let mut heading =
        words::line([x, y + drawn.places.plot_height() / 2.0], TextAnchor::Middle, style::LABEL, &heading);
    if let Primitive::Text { rotate, .. } = &mut heading {
        *rotate = Some(-90.0);
    }
    drawn.scene.add(heading);
    Ok(drawn.scene)
}

/// Cells of one colour are one path, neighbours in a row one line of it, as wide as a cell is high; in units of cells. Columns are
/// equally wide and rows equally high on every axis; no edge is softened, which would show as a seam.
fn cells(map: &Map, shades: &Shades, places: &ComputedLayout) -> Vec<Primitive> {
    let mut paths = vec![(String::new(), [0, 0]); 1 + usize::from(*style::levels(true).end())];
    for (j, row) in (0..).zip(map.rows.iter().rev()) {
        let levels: Vec<_> = row.iter().map(|&value| shades.level(value)).collect();
        let mut i = 0;
        for run in levels.chunk_by(|a, b| a == b) {
            let (path, at) = &mut paths[usize::from(run[0])];
            let start = if path.is_empty() { 'M' } else { 'm' };
            let _ = write!(path, "{start}{} {}h{}", i - at[0], j - at[1], run.len());
            i += run.len() as i64;
            *at = [i, j];
        }
    }
    let (columns, rows) = (map.rows[0].len() as f64, map.rows.len() as f64);
    let [across, down] = [places.plot_width() / columns, places.plot_height() / rows];
    // Lines run along the middle of their row.
    let [x, y] = [places.margin_left, places.margin_top + 0.5 * down];
    let transform = format!("translate({x:.2} {y:.2}) scale({across:.6} {down:.6})");
    let crisp = Some("shape-rendering=\"crispEdges\"".to_owned());
    let start = Primitive::GroupStart { transform: Some(transform), title: None, extra_attrs: crisp };
    let levels = 0..=*style::levels(true).end();
    let painted = levels.zip(paths).filter(|(_, (path, _))| !path.is_empty()).flat_map(|(level, (d, _))| {
        let stroke = colour(style::shade(level));
        let path =
            PathData { d, fill: None, stroke, stroke_width: 1.0, opacity: None, stroke_dasharray: None };
        group(Some(significant(shades.value(level), 3)), None, vec![Primitive::Path(Box::new(path))])
    });
    std::iter::once(start).chain(painted).chain([Primitive::GroupEnd]).collect()
}
