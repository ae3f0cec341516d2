//! Maps: the library's axes and colour bar, and cells that are merged where neighbours have one colour.

use super::super::xml::escaped;
use super::super::{Fault, Map, style};
use super::axis::Span;
use super::colours::{self, Shades, Way};
use super::frame::{Frame, colour};
use super::series::group;
use super::words;
use kuva::plot::Heatmap;
use kuva::prelude::Plot;
use kuva::render::layout::ComputedLayout;
use kuva::render::render::{PathData, Primitive, Scene, TextAnchor};
use std::collections::BTreeSet;
use std::fmt::Write;
use stripmine_physics::number::in_tens;

/// From the colour bar's heading to the bar (pixels).
const TO_BAR: f64 = 9.0;

/// Draws a map.
pub fn scene(title: &str, map: &Map) -> Result<Scene, Fault> {
    let x = Span::exact(&map.x, std::iter::empty())?;
    let y = Span::exact(&map.y, std::iter::empty())?;
    let shades = Shades::new(&map.value, map.rows.iter().flatten().copied())?;
    // The library reckons its colour bar from two cells, which are left away.
    let bar = Heatmap::new().with_data([shades.ends]);
    let heading = map.value.heading();
    let frame = Frame { title, x: &x, y: &y, right: None, height: style::PLOT_HEIGHT };
    let mut drawn = frame.draw(vec![Plot::Heatmap(bar)], |asked| {
        let mut asked = asked.with_colorbar_tick_format(shades.format());
        asked.show_grid = false;
        asked
    });
    // Its bar is of slices in a frame; here the frame has all shades.
    drawn
        .scene
        .elements
        .retain(|it| !matches!(it, Primitive::RectBatch { .. } | Primitive::Rect { stroke: None, .. }));
    let filling = colours::shades(shades.signed(), Way::Up);
    drawn.scene.defs.push(filling.definition);
    for element in &mut drawn.scene.elements {
        if let Primitive::Rect { fill, .. } = element {
            *fill = filling.fill.clone();
        }
    }
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

/// Cells of one colour are one path, neighbours in a row one line of it, as wide as a cell is high; in units of cells. A line goes on
/// under cells of higher levels, which are painted after it: a fifth fewer lines. Columns are equally wide and rows equally high on
/// every axis; no edge is softened, which would show as a seam.
fn cells(map: &Map, shades: &Shades, places: &ComputedLayout) -> Vec<Primitive> {
    let rows: Vec<Vec<u8>> =
        map.rows.iter().rev().map(|row| row.iter().map(|&value| shades.level(value)).collect()).collect();
    let present: BTreeSet<u8> = rows.iter().flatten().copied().collect();
    let painted: Vec<Primitive> = present
        .into_iter()
        .flat_map(|level| {
            let (mut d, mut at) = (String::new(), [0, 0]);
            for (j, row) in (0..).zip(&rows) {
                let mut i = 0;
                // What lies between cells of lower levels, from its first cell of this level to its last.
                for free in row.split(|&other| other < level) {
                    let ends =
                        [free.iter().position(|&it| it == level), free.iter().rposition(|&it| it == level)];
                    if let [Some(first), Some(last)] = ends.map(|end| end.map(|end| i + end as i64)) {
                        let start = if d.is_empty() { 'M' } else { 'm' };
                        let _ = write!(d, "{start}{} {}h{}", first - at[0], j - at[1], last + 1 - first);
                        at = [last + 1, j];
                    }
                    i += free.len() as i64 + 1;
                }
            }
            let stroke = colour(style::shade(level));
            let path =
                PathData { d, fill: None, stroke, stroke_width: 1.0, opacity: None, stroke_dasharray: None };
            group(Some(in_tens(shades.value(level), 3)), None, vec![Primitive::Path(Box::new(path))])
        })
        .collect();
    let (columns, rows) = (map.rows[0].len() as f64, map.rows.len() as f64);
    let [across, down] = [places.plot_width() / columns, places.plot_height() / rows];
    // Lines run along the middle of their row.
    let [x, y] = [places.margin_left, places.margin_top + 0.5 * down];
    let transform = format!("translate({x:.2} {y:.2}) scale({across:.6} {down:.6})");
    let crisp = Some("shape-rendering=\"crispEdges\"".to_owned());
    let start = Primitive::GroupStart { transform: Some(transform), title: None, extra_attrs: crisp };
    std::iter::once(start).chain(painted).chain([Primitive::GroupEnd]).collect()
}
