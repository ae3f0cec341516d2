//! Series over two axes: curves by the library, bars and markers in front of them.

use super::super::look::Look;
use super::super::style;
use super::super::{Series, Style};
use super::axis::Span;
use super::frame::colour;
use super::marker::markers;
use kuva::plot::LinePlot;
use kuva::plot::line::LineStyle;
use kuva::prelude::Plot;
use kuva::render::layout::ComputedLayout;
use kuva::render::render::{PathData, Primitive};
use std::fmt::Write;

/// Half the width of the ends of an error bar (pixels).
const CAP: f64 = 4.5;

/// The curve of a series, if it has one.
pub fn curve(look: &Look, series: &Series, x: &Span, y: &Span) -> Option<Plot> {
    let places: Vec<_> = series.points.iter().map(|point| (x.number(point.x), y.number(point.y))).collect();
    if look.style == Style::Points || places.len() < 2 {
        return None;
    }
    let places = if look.style == Style::Steps { steps(&places) } else { places };
    let line =
        LinePlot::new().with_data(places).with_color(look.colour.to_string()).with_stroke_width(width(look));
    Some(Plot::Line(match dash(look) {
        Some(dash) => line.with_line_style(LineStyle::Custom(dash)),
        None => line,
    }))
}

/// The bars and markers of a series.
pub fn points(look: &Look, series: &Series, x: &Span, y: &Span, places: &ComputedLayout) -> Vec<Primitive> {
    let place = |across: f64, up: f64| [places.map_x(x.number(across)), places.map_y(y.number(up))];
    let mut bars = String::new();
    for (point, ends) in series.points.iter().filter_map(|point| Some((point, point.spread?))) {
        let [[middle, low], [_, high]] = ends.map(|end| place(point.x, end));
        let [left, cap] = [middle - CAP, 2.0 * CAP];
        let _ = write!(
            bars,
            "M{left:.1} {low:.1}h{cap}M{left:.1} {high:.1}h{cap}M{middle:.1} {low:.1}V{high:.1}"
        );
    }
    let mut all = Vec::new();
    if !bars.is_empty() {
        all.push(path(bars, look, 0.7 * style::CURVE, None));
    }
    // One point is no line, but it must be seen.
    if look.has_markers() || series.points.len() == 1 {
        let within = |ends: [f64; 2], number: f64| (ends[0]..=ends[1]).contains(&number);
        let shown = series.points.iter();
        let shown = shown.filter(|it| within(x.ends, x.number(it.x)) && within(y.ends, y.number(it.y)));
        all.extend(markers(look, &shown.map(|it| place(it.x, it.y)).collect::<Vec<_>>()));
    }
    all
}

/// A sample for a legend, from a place to the right.
pub fn sample(look: &Look, [left, y]: [f64; 2], length: f64) -> Vec<Primitive> {
    let mut all = Vec::new();
    if look.style != Style::Points {
        all.push(path(format!("M{left:.1} {y:.1}h{length}"), look, width(look), dash(look)));
    }
    if look.has_markers() {
        all.extend(markers(look, &[[left + length / 2.0, y]]));
    }
    all
}

fn path(d: String, look: &Look, stroke_width: f64, stroke_dasharray: Option<String>) -> Primitive {
    let stroke = colour(look.colour);
    Primitive::Path(Box::new(PathData {
        d,
        fill: None,
        stroke,
        stroke_width,
        opacity: None,
        stroke_dasharray,
    }))
}

fn width(look: &Look) -> f64 {
    if look.style == Style::Joined { 0.6 * style::CURVE } else { style::CURVE }
}

fn dash(look: &Look) -> Option<String> {
    let parts: Vec<_> = look.dash.iter().map(f64::to_string).collect();
    (!parts.is_empty()).then(|| parts.join(" "))
}

/// The outline of a histogram whose bins have these middles: each bin reaches halfway to its neighbours, the outermost are
/// as wide on the outside as on the inside.
fn steps(middles: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let edges: Vec<f64> = middles.windows(2).map(|pair| 0.5 * (pair[0].0 + pair[1].0)).collect();
    let beyond = |inside: f64, middle: f64| 2.0 * middle - inside;
    let outline = middles.iter().enumerate().flat_map(|(i, &(x, y))| {
        let [before, after] = [i.checked_sub(1), Some(i)].map(|i| i.and_then(|i| edges.get(i)).copied());
        let left = before.or(after.map(|edge| beyond(edge, x))).unwrap_or(x);
        let right = after.or(before.map(|edge| beyond(edge, x))).unwrap_or(x);
        [(left, y), (right, y)]
    });
    outline.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_reach_halfway_to_their_neighbours() {
        let outline = steps(&[(0.0, 1.0), (2.0, 3.0), (4.0, 2.0)]);
        assert_eq!(outline, [(-1.0, 1.0), (1.0, 1.0), (1.0, 3.0), (3.0, 3.0), (3.0, 2.0), (5.0, 2.0)]);
        assert_eq!(steps(&[(1.0, 2.0)]), [(1.0, 2.0), (1.0, 2.0)]);
    }
}
