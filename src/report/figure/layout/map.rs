//! Maps on their sheet.

use super::super::sheet::{Area, Mark, Sheet};
use super::super::{Fault, Map, style};
use super::colour_bar::{ColourBar, GAP, THICKNESS};
use super::frame::{Frame, Span};
use super::ruler::{self, Ruler};
use super::title::Title;

/// Lays a map out.
pub fn lay_out(title: &str, map: &Map) -> Result<Sheet, Fault> {
    let given = |axis| ruler::ends(axis, std::iter::empty());
    let x = Span { axis: &map.x, ends: given(&map.x)? };
    let y = Span { axis: &map.y, ends: given(&map.y)? };
    let shades = shade_ends(map)?;

    let title = Title::new(title, style::WIDTH, 1.0);
    let (top, height) = (title.bottom(), style::PLOT_HEIGHT);
    let bar = |left| {
        let area = Area { left, top, width: THICKNESS, height };
        ColourBar::new(&map.value, shades, area, false, 1.0)
    };
    let beside = GAP + THICKNESS + bar(0.0).depth() + style::MARGIN;
    let frame = Frame::new(&x, &y, top, height, beside);

    let shade = Ruler::new(map.value.scale, shades, [0.0, 1.0]);
    let rows = map.rows.iter().rev();
    let signed = style::is_signed(shades);
    let levels = rows.flatten().map(|&value| style::level(shade.place(value), signed)).collect();
    let mut marks = title.marks();
    marks.push(Mark::Cells { area: frame.plot, columns: map.rows[0].len(), levels });
    marks.extend(frame.edges());
    marks.extend(bar(frame.plot.right() + GAP).marks());
    let width = (frame.plot.right() + beside).max(title.width());
    Ok(Sheet { width, height: frame.sheet_height(), marks })
}

/// The values of the darkest and the brightest shade: exactly those of the data where the map does not say.
fn shade_ends(map: &Map) -> Result<[f64; 2], Fault> {
    let [low, high] =
        map.rows.iter().flatten().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &value| {
            [low.min(value), high.max(value)]
        });
    let exact = map.value.limits.is_none() && low < high;
    let wide = ruler::ends(&map.value, [low, high].into_iter())?;
    Ok(if exact { [low, high].map(|end| ruler::measure(map.value.scale, end)) } else { wide })
}
