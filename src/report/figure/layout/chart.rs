//! Charts on their sheet.

use super::super::look::looks;
use super::super::sheet::{Area, Sheet};
use super::super::style;
use super::super::{Along, Axis, Band, Chart, Fault};
use super::band::{band, ground};
use super::frame::{Frame, Span};
use super::legend::Legend;
use super::ruler;
use super::title::Title;

/// Lays a chart out.
pub fn lay_out(title: &str, chart: &Chart) -> Result<Sheet, Fault> {
    let points = || chart.series.iter().flat_map(|series| &series.points);
    let edges_along = |along: Along, axis: &'_ Axis| {
        let scale = axis.scale;
        let of = chart.bands.iter().filter(move |band| band.along == along);
        of.flat_map(|band| band.ends).filter(move |end| ruler::measure(scale, *end).is_finite())
    };
    let x = Span {
        axis: &chart.x,
        ends: ruler::ends(&chart.x, points().map(|point| point.x).chain(edges_along(Along::X, &chart.x)))?,
    };
    let heights = points().flat_map(|point| point.spread.into_iter().flatten().chain([point.y]));
    let y =
        Span { axis: &chart.y, ends: ruler::ends(&chart.y, heights.chain(edges_along(Along::Y, &chart.y)))? };

    let title = Title::new(title, style::WIDTH, 1.0);
    let legend = Legend::new(chart);
    let height = legend.height().max(style::PLOT_HEIGHT);
    let frame = Frame::new(&x, &y, title.bottom(), height, legend.width());

    let mut marks = title.marks();
    let areas = || {
        chart.bands.iter().enumerate().filter_map(|(i, part)| Some((part.along, band_area(&frame, part)?, i)))
    };
    marks.extend(areas().filter(|it| it.0 == Along::Y).map(|(_, area, i)| ground(&area, &chart.bands, i)));
    marks.push(frame.grid());
    marks.extend(areas().filter(|it| it.0 == Along::X).flat_map(|(_, area, _)| band(&area)));
    let looks = looks(chart);
    let drawn = || chart.series.iter().zip(&looks);
    marks.extend(drawn().filter_map(|(series, look)| look.curve(&frame, series)));
    marks.extend(drawn().filter_map(|(series, look)| look.spreads(&frame, series)));
    marks.extend(drawn().flat_map(|(series, look)| look.markers(&frame, series)));
    marks.extend(frame.edges());
    marks.extend(legend.marks(&frame.plot));
    let width = (frame.plot.right() + legend.width()).max(title.width());
    Ok(Sheet { width, height: frame.sheet_height(), marks })
}

/// What of a band can be seen.
fn band_area(frame: &Frame, band: &Band) -> Option<Area> {
    let Area { left, top, width, height } = frame.plot;
    if band.along == Along::Y {
        // Upwards places fall.
        let [low, high] = band.ends.map(|y| frame.place(1.0, y)[1].clamp(top, top + height));
        return (low > high).then_some(Area { left, top: high, width, height: low - high });
    }
    // What a logarithmic axis has no place for lies beyond its lower end.
    let [start, end] = band.ends.map(|x| {
        let place = frame.place(x, 1.0)[0];
        if place.is_nan() { left } else { place.clamp(left, frame.plot.right()) }
    });
    (end > start).then_some(Area { left: start, top, width: end - start, height })
}
