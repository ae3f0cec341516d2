//! Charts.

use super::super::look::{grounds, looks};
use super::super::style::Colour;
use super::super::{Along, Band, Chart, Fault, Scale};
use super::axis::Span;
use super::frame::{Frame, colour};
use super::legend::Legend;
use super::{marker, series};
use kuva::plot::LinePlot;
use kuva::prelude::Plot;
use kuva::render::layout::ComputedLayout;
use kuva::render::render::{Primitive, Scene};
use std::collections::BTreeSet;

/// Draws a chart.
pub fn scene(title: &str, chart: &Chart) -> Result<Scene, Fault> {
    let points = || chart.series.iter().flat_map(|series| &series.points);
    let edges = |along: Along, scale: Scale| {
        let of = chart.bands.iter().filter(move |band| band.along == along).flat_map(|band| band.ends);
        of.filter(move |&end| end.is_finite() && (scale == Scale::Linear || end > 0.0))
    };
    let x = Span::new(&chart.x, points().map(|point| point.x).chain(edges(Along::X, chart.x.scale)))?;
    let heights = points().flat_map(|point| point.spread.into_iter().flatten().chain([point.y]));
    let y = Span::new(&chart.y, heights.chain(edges(Along::Y, chart.y.scale)))?;

    let legend = Legend::new(chart);
    let looks = looks(chart);
    let drawn = || chart.series.iter().zip(&looks);
    let frame = Frame { title, x: &x, y: &y, right: Some(legend.width()), height: legend.height() };
    // The library opens the window between the axes' ends for plots only.
    let mut picture = frame.draw(vec![Plot::Line(LinePlot::new())], |asked| asked);
    let places = &picture.places;
    let areas = chart.bands.iter().zip(grounds(chart));
    let areas = areas.flat_map(|(band, ground)| area(band, ground, &x, &y, places));
    // Grounds below, then curves, markers on top, whichever series they belong to.
    let grounds = drawn().filter_map(|(series, look)| series::ground(look, series, &x, &y, places));
    let curves = drawn().flat_map(|(series, look)| series::curve(look, series, &x, &y, places));
    let points = drawn().flat_map(|(series, look)| series::points(look, series, &x, &y, places));
    let things = areas.chain(grounds).chain(curves).chain(points).collect();
    picture.fill(&x, &y, "", things);
    let markers: BTreeSet<String> = looks.iter().map(marker::definition).collect();
    picture.scene.defs.extend(markers);
    let places = &picture.places;
    legend.add_to(&mut picture.scene, [places.width - places.margin_right, places.margin_top]);
    Ok(picture.scene)
}

/// What of a band can be seen, with its meaning.
fn area(band: &Band, ground: Colour, x: &Span, y: &Span, places: &ComputedLayout) -> Vec<Primitive> {
    let [left, right] = [places.margin_left, places.width - places.margin_right];
    let [top, bottom] = [places.margin_top, places.height - places.margin_bottom];
    // What a logarithmic axis has no place for lies beyond its lower end.
    let along =
        |span: &Span, ends: [f64; 2]| ends.map(|end| span.number(end).clamp(span.ends[0], span.ends[1]));
    let ([left, right], [top, bottom]) = match band.along {
        Along::X => (along(x, band.ends).map(|end| places.map_x(end)), [top, bottom]),
        Along::Y => {
            let [low, high] = along(y, band.ends).map(|end| places.map_y(end));
            ([left, right], [high, low])
        }
    };
    let (width, height) = (right - left, bottom - top);
    if width <= 0.0 || height <= 0.0 {
        return vec![];
    }
    let (fill, x, y) = (colour(ground), left, top);
    let ground =
        Primitive::Rect { x, y, width, height, fill, stroke: None, stroke_width: None, opacity: None };
    series::group(Some(band.label.clone()), None, vec![ground])
}
