//! Series over two axes: curves, bars and markers.

use super::super::look::Look;
use super::super::style::{self, Colour};
use super::super::xml::{bends, through};
use super::super::{Point, Series, Style};
use super::axis::Span;
use super::frame::colour;
use super::marker;
use kuva::render::color::Color;
use kuva::render::layout::ComputedLayout;
use kuva::render::render::{PathData, Primitive};
use std::fmt::Write;

/// Half the width of the ends of an error bar (pixels).
const CAP: f64 = 4.5;

/// How much of its colour a ground has, and how high its sample is in a legend (pixels).
const LIGHT: f64 = 0.25;
const GROUND: f64 = 18.0;

/// The curve of a series, if it has one. It bears the series' name where no markers do.
pub fn curve(look: &Look, series: &Series, x: &Span, y: &Span, places: &ComputedLayout) -> Vec<Primitive> {
    if look.style == Style::Points || series.points.len() < 2 {
        return vec![];
    }
    let mut middles = middles(&series.points, x, y, places);
    if look.style == Style::Steps {
        middles = steps(&middles);
    }
    let title = (!look.has_markers()).then(|| series.name.clone());
    group(title, None, vec![path(through(&bends(&middles)), look.colour, width(look), dash(look))])
}

/// The ground between the ends of the spreads of a ribbon.
pub fn ground(
    look: &Look,
    series: &Series,
    x: &Span,
    y: &Span,
    places: &ComputedLayout,
) -> Option<Primitive> {
    if look.style != Style::Ribbon {
        return None;
    }
    let end = |which: usize| {
        let ends = series.points.iter().filter_map(move |it| Some((it.x, it.spread?[which])));
        ends.map(|(across, up)| [places.map_x(x.number(across)), places.map_y(y.number(up))])
    };
    let outline: Vec<[f64; 2]> = end(0).chain(end(1).collect::<Vec<_>>().into_iter().rev()).collect();
    Some(filled(format!("{}z", through(&outline)), look.colour))
}

/// The bars and markers of a series, with its name.
pub fn points(look: &Look, series: &Series, x: &Span, y: &Span, places: &ComputedLayout) -> Vec<Primitive> {
    let mut bars = String::new();
    let barred = if look.style == Style::Ribbon { &[][..] } else { &series.points };
    for (point, ends) in barred.iter().filter_map(|point| Some((point, point.spread?))) {
        let [low, high] = ends.map(|end| places.map_y(y.number(end)));
        let (left, cap) = (places.map_x(x.number(point.x)) - CAP, 2.0 * CAP);
        // The page's script reads both ends here.
        let _ = write!(bars, "M{left:.2} {low:.2}h{cap}m-{CAP} 0V{high:.2}m-{CAP} 0h{cap}");
    }
    let mut all = Vec::new();
    if !bars.is_empty() {
        all.push(path(bars, look.colour, 0.7 * style::CURVE, None));
    }
    // One point is no line, but it must be seen.
    if look.has_markers() || series.points.len() == 1 {
        let within = |ends: [f64; 2], number: f64| (ends[0]..=ends[1]).contains(&number);
        let shown = |it: &&Point| within(x.ends, x.number(it.x)) && within(y.ends, y.number(it.y));
        let shown: Vec<Point> = series.points.iter().filter(shown).copied().collect();
        if !shown.is_empty() {
            all.extend(marked("marker", look, unseen(through(&middles(&shown, x, y, places)))));
        }
    }
    if all.is_empty() { all } else { group(Some(series.name.clone()), None, all) }
}

/// A sample for a legend, from a place to the right.
pub fn sample(look: &Look, [left, y]: [f64; 2], length: f64) -> Vec<Primitive> {
    let half = length / 2.0;
    let d = format!("M{left:.1} {y:.1}h{half}h{half}");
    let line = match look.style {
        Style::Points => unseen(d),
        Style::Ribbon => {
            let (top, right, high) = (y - 0.5 * GROUND, left + length, GROUND);
            let around = format!("M{left:.1} {top:.1}H{right:.1}v{high}H{left:.1}z");
            return vec![filled(around, look.colour), path(d, look.colour, width(look), dash(look))];
        }
        _ => path(d, look.colour, width(look), dash(look)),
    };
    if look.has_markers() { marked("marker-mid", look, line) } else { vec![line] }
}

fn middles(points: &[Point], x: &Span, y: &Span, places: &ComputedLayout) -> Vec<[f64; 2]> {
    points.iter().map(|it| [places.map_x(x.number(it.x)), places.map_y(y.number(it.y))]).collect()
}

/// Things that belong together, with a name for who points at them.
pub fn group(title: Option<String>, extra_attrs: Option<String>, of: Vec<Primitive>) -> Vec<Primitive> {
    if title.is_none() && extra_attrs.is_none() {
        return of;
    }
    let start = Primitive::GroupStart { transform: None, title, extra_attrs };
    std::iter::once(start).chain(of).chain([Primitive::GroupEnd]).collect()
}

/// A line whose corners, or those in its middle alone, have markers.
fn marked(property: &str, look: &Look, line: Primitive) -> Vec<Primitive> {
    group(None, Some(format!("style=\"{property}:url(#{})\"", marker::name(look))), vec![line])
}

/// A line of which only the markers are seen.
fn unseen(d: String) -> Primitive {
    stroke(d, Color::None, 0.0, None)
}

/// A light ground.
fn filled(d: String, of: Colour) -> Primitive {
    let (fill, opacity) = (Some(colour(of)), Some(LIGHT));
    let (stroke, stroke_width, stroke_dasharray) = (Color::None, 0.0, None);
    Primitive::Path(Box::new(PathData { d, fill, stroke, stroke_width, opacity, stroke_dasharray }))
}

fn path(d: String, of: Colour, width: f64, dash: Option<String>) -> Primitive {
    stroke(d, colour(of), width, dash)
}

fn stroke(d: String, stroke: Color, stroke_width: f64, stroke_dasharray: Option<String>) -> Primitive {
    let path = PathData { d, fill: None, stroke, stroke_width, opacity: None, stroke_dasharray };
    Primitive::Path(Box::new(path))
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
fn steps(middles: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let edges: Vec<f64> = middles.windows(2).map(|pair| 0.5 * (pair[0][0] + pair[1][0])).collect();
    let beyond = |inside: f64, middle: f64| 2.0 * middle - inside;
    let outline = middles.iter().enumerate().flat_map(|(i, &[x, y])| {
        let [before, after] = [i.checked_sub(1), Some(i)].map(|i| i.and_then(|i| edges.get(i)).copied());
        let left = before.or(after.map(|edge| beyond(edge, x))).unwrap_or(x);
        let right = after.or(before.map(|edge| beyond(edge, x))).unwrap_or(x);
        [[left, y], [right, y]]
    });
    outline.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_reach_halfway_to_their_neighbours() {
        let outline = steps(&[[0.0, 1.0], [2.0, 3.0], [4.0, 2.0]]);
        assert_eq!(outline, [[-1.0, 1.0], [1.0, 1.0], [1.0, 3.0], [3.0, 3.0], [3.0, 2.0], [5.0, 2.0]]);
        assert_eq!(steps(&[[1.0, 2.0]]), [[1.0, 2.0], [1.0, 2.0]]);
    }
}
