//! Charts on their sheet.

use super::super::look::looks;
use super::super::sheet::{Area, Sheet};
use super::super::style;
use super::super::{Band, Chart, Fault};
use super::band::band;
use super::frame::{Frame, Span};
use super::legend::Legend;
use super::ruler;
use super::title::Title;

/// Lays a chart out.
pub fn lay_out(title: &str, chart: &Chart) -> Result<Sheet, Fault> {
    let points = || chart.series.iter().flat_map(|series| &series.points);
    let edges =
        chart.bands.iter().flat_map(|band| band.x).filter(|x| ruler::measure(chart.x.scale, *x).is_finite());
    let x = Span { axis: &chart.x, ends: ruler::ends(&chart.x, points().map(|point| point.x).chain(edges))? };
    let heights = points().flat_map(|point| point.spread.into_iter().flatten().chain([point.y]));
    let y = Span { axis: &chart.y, ends: ruler::ends(&chart.y, heights)? };

    let title = Title::new(title, style::WIDTH, 1.0);
    let legend = Legend::new(chart);
    let height = legend.height().max(style::PLOT_HEIGHT);
    let frame = Frame::new(&x, &y, title.bottom(), height, legend.width());

    let mut marks = title.marks();
    marks.push(frame.grid());
    marks.extend(chart.bands.iter().filter_map(|part| band_area(&frame, part)).flat_map(|area| band(&area)));
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
    let Area { left, top, height, .. } = frame.plot;
    // What a logarithmic axis has no place for lies beyond its lower end.
    let [start, end] = band.x.map(|x| {
        let place = frame.place(x, 1.0)[0];
        if place.is_nan() { left } else { place.clamp(left, frame.plot.right()) }
    });
    (end > start).then_some(Area { left: start, top, width: end - start, height })
}
