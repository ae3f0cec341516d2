//! Charts.

use super::super::look::looks;
use super::super::style::{self, Colour};
use super::super::{Along, Band, Chart, Fault, Scale};
use super::axis::Span;
use super::frame::{Frame, colour};
use super::legend::Legend;
use super::series;
use kuva::plot::LinePlot;
use kuva::prelude::Plot;
use kuva::render::layout::ComputedLayout;
use kuva::render::render::{Primitive, Scene};

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
    let curves = drawn().filter_map(|(series, look)| series::curve(look, series, &x, &y));
    // The library opens the window between the axes' ends for plots only.
    let curves = std::iter::once(Plot::Line(LinePlot::new())).chain(curves).collect();
    let frame = Frame { title, x: &x, y: &y, right: Some(legend.width()), height: legend.height() };
    let mut picture = frame.draw(curves, |asked| asked);
    let areas = chart.bands.iter().zip(grounds(chart));
    let areas = areas.filter_map(|(band, ground)| area(band, ground, &x, &y, &picture.places)).collect();
    picture.behind(areas);
    let of = |(series, look)| series::points(look, series, &x, &y, &picture.places);
    let points = drawn().flat_map(of).collect();
    picture.in_front(points);
    let places = &picture.places;
    legend.add_to(&mut picture.scene, [places.width - places.margin_right, places.margin_top]);
    Ok(picture.scene)
}

/// The colours of a chart's bands: of those along y, one upon another, the first is the lightest; those along x are grey.
pub fn grounds(chart: &Chart) -> impl Iterator<Item = Colour> {
    let mut before = 0;
    chart.bands.iter().map(move |band| match band.along {
        Along::X => style::STILL,
        Along::Y => {
            let colour = style::GROUNDS[before.min(style::GROUNDS.len() - 1)];
            before += 1;
            colour
        }
    })
}

/// What of a band can be seen.
fn area(band: &Band, ground: Colour, x: &Span, y: &Span, places: &ComputedLayout) -> Option<Primitive> {
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
    (width > 0.0 && height > 0.0).then(|| Primitive::Rect {
        x: left,
        y: top,
        width,
        height,
        fill: colour(ground),
        stroke: None,
        stroke_width: None,
        opacity: None,
    })
}
