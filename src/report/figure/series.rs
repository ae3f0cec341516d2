//! Series on a plane: curves, error bars and markers, and their samples in a legend.

use super::plane::Plane;
use super::style::{CURVE, MARKERS, PAPER, SeriesLook, has_markers, is_scattered};
use super::writer::{Svg, path_data, simplified_line, stroke, tenths};
use super::{Scale, Series, SeriesPoint, Style};

/// Size ratio of large marks to points.
const LARGE: &str = "1.8";
/// Half the width of the caps of an error bar (pixels). The script `tips.js` uses the same value.
const CAP: f64 = 4.5;
/// Height of the legend sample of a shaded area (pixels).
pub(crate) const GROUND: f64 = 15.0;

/// Adds the shaded area between the ends of the spreads of a ribbon.
pub(crate) fn add_ribbon(svg: &mut Svg, plane: &Plane, look: &SeriesLook, series: &Series) {
    let end = |which: usize| {
        let ends = series.points.iter().filter_map(move |it| Some((it.x, it.spread?[which])));
        ends.map(|(x, y)| plane.place(x, y))
    };
    if look.style == Style::Ribbon {
        let outline: Vec<_> = end(0).chain(end(1).collect::<Vec<_>>().into_iter().rev()).collect();
        light(svg, look, &path_data(&outline));
    }
}

/// Adds the curve of a series, if it has one. The curve carries the series' name if there are no markers.
pub(crate) fn add_curve(svg: &mut Svg, plane: &Plane, look: &SeriesLook, series: &Series) {
    if is_scattered(look.style) || series.points.len() < 2 {
        return;
    }
    let places: Vec<_> = series.points.iter().map(|it| plane.place(it.x, it.y)).collect();
    let d = path_data(&simplified_line(&places));
    if has_markers(look.style) {
        line(svg, look, "", &d);
    } else {
        svg.named(&series.name, |svg| line(svg, look, "", &d));
    }
}

/// Adds the error bars and markers of a series, with its name. A single point always has a marker, and no marker is cut off.
pub(crate) fn add_points(svg: &mut Svg, plane: &Plane, look: &SeriesLook, series: &Series) {
    let mut bars = String::new();
    for &SeriesPoint { x, y, spread } in series.points.iter().filter(|_| look.style != Style::Ribbon) {
        let (Some(ends), cap) = (spread, 2.0 * CAP) else { continue };
        if matches!(plane.y.scale, Scale::Names(_)) {
            let [[left, up], [right, _]] = ends.map(|end| plane.place(end, y));
            bars += &format!("M{left:.2} {:.2}v{cap}m0-{CAP}H{right:.2}m0-{CAP}v{cap}", up - CAP);
        } else {
            let [[across, low], [_, high]] = ends.map(|end| plane.place(x, end));
            bars += &format!("M{:.2} {low:.2}h{cap}m-{CAP} 0V{high:.2}m-{CAP} 0h{cap}", across - CAP);
        }
    }
    let is_inside = |it: &&SeriesPoint| {
        [plane.x.fraction_of(it.x), plane.y.fraction_of(it.y)].iter().all(|part| (0.0..=1.0).contains(part))
    };
    let marked = series.points.iter().filter(|_| has_markers(look.style) || series.points.len() == 1);
    let places: Vec<_> = marked.filter(is_inside).map(|it| plane.place(it.x, it.y)).collect();
    if bars.is_empty() && places.is_empty() {
        return;
    }
    svg.named(&series.name, |svg| {
        if !bars.is_empty() {
            svg.path(&stroke(look.colour, 0.7 * CURVE), &bars);
        }
        if !places.is_empty() {
            let marker = marker(svg, look);
            let d = path_data(&places);
            svg.add(format_args!("<g style=\"marker:url(#{marker})\">\n<path d=\"{d}\"/>\n</g>"));
        }
    });
}

/// Adds a legend sample that extends to the right of a position.
pub(crate) fn add_legend_sample(svg: &mut Svg, look: &SeriesLook, [left, y]: [f64; 2], length: f64) {
    let [x, y, half, right] = [left, y, 0.5 * length, left + length].map(tenths);
    let d = format!("M{x} {y}h{half}h{half}");
    if look.style == Style::Ribbon {
        light(svg, look, &format!("M{x} {y}m0-{0}H{right}v{GROUND}H{x}", 0.5 * GROUND));
    }
    let marker = if has_markers(look.style) { marker(svg, look) } else { String::new() };
    let markers = if marker.is_empty() { marker } else { format!(" style=\"marker-mid:url(#{marker})\"") };
    if is_scattered(look.style) { svg.path(&markers, &d) } else { line(svg, look, &markers, &d) }
}

fn light(svg: &mut Svg, look: &SeriesLook, outline: &str) {
    svg.path(&format!(" fill=\"{}\" fill-opacity=\"0.25\"", look.colour), &format!("{outline}z"));
}

fn line(svg: &mut Svg, look: &SeriesLook, more: &str, d: &str) {
    let stroke = stroke(look.colour, if look.style == Style::Joined { 0.6 * CURVE } else { CURVE });
    let dash = format!(" stroke-dasharray=\"{}\"", look.dash);
    svg.path(&format!("{stroke}{}{more}", if look.dash.is_empty() { "" } else { &dash }), d);
}

/// Defines the marker of a look and returns its name. The name encodes the appearance, because pictures on one page share markers. Markers
/// have a rim, so that overlapping ones can be counted.
fn marker(svg: &mut Svg, look: &SeriesLook) -> String {
    let SeriesLook { colour, marker, is_hollow, .. } = *look;
    let (fill, rim, width) = if is_hollow { (PAPER, colour, 1.6) } else { (colour, PAPER, 0.7) };
    let hollow = if is_hollow { "-hollow" } else { "" };
    let (large, scaled) = match look.style {
        Style::Marks => ("-large", format!(" transform=\"scale({LARGE})\"")),
        _ => ("", String::new()),
    };
    let name = format!("m{marker}-{}{hollow}{large}", colour.to_string().trim_start_matches('#'));
    svg.define(format!(
        "<marker id=\"{name}\" markerUnits=\"userSpaceOnUse\" overflow=\"visible\"><path fill=\"{fill}\"{}{scaled} d=\"{}\"/></marker>",
        stroke(rim, width), MARKERS[marker]
    ));
    name
}
