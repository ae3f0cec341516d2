//! Charts on their sheet.

use super::super::look::{Look, looks};
use super::super::sheet::{Area, Mark, Paint, Place, Sheet, Stroke};
use super::super::style;
use super::super::{Band, Chart, Fault, Series, Style};
use super::frame::{Frame, Span};
use super::legend::Legend;
use super::title::Title;
use super::{clip, marker, ruler};

/// Distance of the hatching's lines.
const HATCHING: f64 = 9.0;
/// Half the width of the ends of an error bar.
const CAP: f64 = 4.5;

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

impl Look {
    fn curve(&self, frame: &Frame, series: &Series) -> Option<Mark> {
        let places: Vec<Place> = series.points.iter().map(|point| frame.place(point.x, point.y)).collect();
        self.line(clip::line(&frame.plot, &places))
    }

    fn line(&self, pieces: Vec<Vec<Place>>) -> Option<Mark> {
        if self.style == Style::Points || pieces.is_empty() {
            return None;
        }
        let width = if self.style == Style::Joined { 0.6 * style::CURVE } else { style::CURVE };
        let stroke = Stroke { colour: self.colour, width, dash: self.dash };
        Some(Mark::Lines { pieces, closed: false, paint: Paint { fill: None, stroke: Some(stroke) } })
    }

    fn spreads(&self, frame: &Frame, series: &Series) -> Option<Mark> {
        let bars = series.points.iter().filter_map(|point| Some((point.x, point.spread?)));
        let lines = bars.flat_map(|(x, ends)| {
            let [[x, low], [_, high]] = ends.map(|y| frame.place(x, y));
            let cap = |y: f64| vec![[x - CAP, y], [x + CAP, y]];
            [vec![[x, low], [x, high]], cap(low), cap(high)]
        });
        let pieces: Vec<_> = lines.flat_map(|piece| clip::line(&frame.plot, &piece)).collect();
        let paint = Paint::stroke(self.colour, 0.7 * style::CURVE);
        (!pieces.is_empty()).then_some(Mark::Lines { pieces, closed: false, paint })
    }

    fn markers(&self, frame: &Frame, series: &Series) -> Vec<Mark> {
        // One point is no line, but it must be seen.
        if !self.has_markers() && series.points.len() > 1 {
            return Vec::new();
        }
        let places = series.points.iter().map(|point| frame.place(point.x, point.y));
        places.filter(|&place| frame.plot.contains(place)).map(|place| self.marker(place)).collect()
    }

    fn marker(&self, place: Place) -> Mark {
        marker::mark(self.marker, place, self.colour, self.hollow)
    }

    /// A sample for the legend, from a place to the right.
    pub fn sample(&self, [left, y]: Place, width: f64) -> Vec<Mark> {
        let line = self.line(vec![vec![[left, y], [left + width, y]]]);
        let marker = self.has_markers().then(|| self.marker([left + width / 2.0, y]));
        line.into_iter().chain(marker).collect()
    }
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

/// A hatched part of the plane.
pub fn band(area: &Area) -> [Mark; 2] {
    let lines = clip::hatching(area, HATCHING);
    let sides = [area.left, area.right()].map(|x| vec![[x, area.top], [x, area.bottom()]]);
    [(lines, 1.0), (sides.into(), 1.4)].map(|(pieces, width)| Mark::Lines {
        pieces,
        closed: false,
        paint: Paint::stroke(style::HATCHING, width),
    })
}
