//! Charts, one or several side by side.

use super::axis::AxisRange;
use super::plane::{self, Plane, PlaneHead};
use super::style::{self, Colour, SeriesLook};
use super::writer::{Svg, box_attributes};
use super::{AxisDirection, Chart, ChartAxis, ChartBand, Scale, Series, font, series};

/// Width of a line marking a value (pixels).
const LINE: f64 = 1.6;
/// Width of a legend sample, distance to its words, and distance from the words to the next sample (pixels).
const LENGTH: f64 = 40.0;
const TO_WORDS: f64 = 8.0;
const BESIDE: f64 = 18.0;
/// Vertical distance between legend entries, and from the picture to the first entry (pixels).
const BETWEEN: f64 = 9.0;

/// Draws charts with the axes of the first and one legend.
pub(crate) fn draw(title: &str, panels: &[(String, Chart)]) -> Result<Svg, String> {
    let charts = || panels.iter().map(|panel| &panel.1);
    // Values along an axis: points, their spreads and the ends of bands.
    let values = |along: AxisDirection, axis: &ChartAxis| {
        let mut all = vec![];
        for chart in charts() {
            let spreads = chart.spreads_along().1 == along;
            for point in chart.series.iter().flat_map(|series| &series.points) {
                all.push(if along == AxisDirection::X { point.x } else { point.y });
                all.extend(point.spread.filter(|_| spreads).into_iter().flatten());
            }
            let ends = chart.bands.iter().filter(|band| band.along == along).flat_map(|band| band.ends);
            all.extend(
                ends.filter(|end| end.is_finite() && (*end > 0.0 || axis.scale != Scale::Logarithmic)),
            );
        }
        all.into_iter()
    };
    let [x, y] = panels.first().map(|(_, chart)| [&chart.x, &chart.y]).ok_or("there are no panels")?;
    let (x, y) =
        (AxisRange::new(x, values(AxisDirection::X, x))?, AxisRange::new(y, values(AxisDirection::Y, y))?);

    // A series in several panels has one look and one legend entry.
    let (mut all, mut of_panels) = (Vec::<&Series>::new(), vec![]);
    for chart in charts() {
        let before = all.len();
        let is_same = |a: &Series, b: &Series| (&a.name, a.style, a.hue) == (&b.name, b.style, b.hue);
        let seen = chart.series.iter().filter(|series| !series.points.is_empty()).map(|series| {
            let index = all[..before].iter().position(|it| is_same(it, series)).unwrap_or(all.len());
            all.extend((index == all.len()).then_some(series));
            (index, series)
        });
        of_panels.push(seen.collect::<Vec<_>>());
    }
    let looks = style::looks(&all);
    let mut svg = Svg::new(title, style::WIDTH, 1.0);
    let heads: Vec<PlaneHead> =
        panels.iter().map(|(name, chart)| (name.as_str(), line_labels(chart, &x))).collect();
    let planes = plane::draw(&mut svg, &x, &y, &heads);
    for ((plane, chart), seen) in planes.iter().zip(charts()).zip(&of_panels) {
        plane.fill(&mut svg, "", |svg| {
            bands(chart).for_each(|(band, colour)| add_band(svg, plane, band, colour));
            // Shaded areas of all series at the bottom, then curves, markers on top.
            for add in [series::add_ribbon, series::add_curve, series::add_points] {
                seen.iter().for_each(|&(index, series)| add(svg, plane, &looks[index], series));
            }
        });
    }
    let of_series = all.iter().zip(looks).map(|(series, look)| (&series.name, LegendSample::Series(look)));
    let mut entries: Vec<(&String, LegendSample)> = of_series.collect();
    for (band, colour) in charts().flat_map(bands) {
        let has_label = band.is_line() && band.along == AxisDirection::X;
        if !has_label && !entries.iter().any(|(words, _)| **words == band.label) {
            entries.push((
                &band.label,
                LegendSample::Ground(colour, if band.is_line() { LINE } else { series::GROUND }),
            ));
        }
    }
    entries.retain(|(words, _)| !words.is_empty());
    add_legend(&mut svg, &entries);
    svg.size[1] += style::MARGIN;
    Ok(svg)
}

/// Returns the labels of a chart's vertical lines with their positions, from the left.
fn line_labels<'a>(chart: &'a Chart, x: &AxisRange) -> Vec<(f64, &'a str)> {
    let lines = chart.bands.iter().filter(|band| band.along == AxisDirection::X && band.is_line());
    let placed = lines.map(|band| (x.fraction_of(band.ends[0]), band.label.as_str()));
    let mut labels: Vec<_> = placed.filter(|(part, _)| (0.0..=1.0).contains(part)).collect();
    labels.sort_by(|a, b| a.0.total_cmp(&b.0));
    labels
}

/// Returns the bands of a chart with their colours. Bands along y overlap, and the first is the lightest.
fn bands(chart: &Chart) -> impl Iterator<Item = (&ChartBand, Colour)> {
    let mut before = 0;
    chart.bands.iter().map(move |band| match band.along {
        _ if band.is_line() => (band, style::MARK),
        AxisDirection::X => (band, style::STILL),
        AxisDirection::Y => {
            before += 1;
            (band, style::GROUNDS[(before - 1).min(style::GROUNDS.len() - 1)])
        }
    })
}

/// Adds the visible part of a band, with its label.
fn add_band(svg: &mut Svg, plane: &Plane, band: &ChartBand, colour: Colour) {
    let axis = if band.along == AxisDirection::X { &plane.x } else { &plane.y };
    let ([left, top], [width, height]) = (plane.corner, plane.size);
    let length = if band.along == AxisDirection::X { width } else { height };
    let mut ends = band.ends.map(|end| axis.fraction_of(end) * length);
    if band.is_line() {
        ends = [ends[0] - 0.5 * LINE, ends[0] + 0.5 * LINE];
    }
    let [from, to] = ends.map(|end| end.clamp(0.0, length));
    let (corner, size) = match band.along {
        AxisDirection::X => ([left + from, top], [to - from, height]),
        AxisDirection::Y => ([left, top + height - to], [width, to - from]),
    };
    if from < to {
        svg.named(&band.label, |svg| {
            svg.add(format_args!("<rect{} fill=\"{colour}\"/>", box_attributes(corner, size)))
        });
    }
}

/// Legend sample.
enum LegendSample {
    /// Curve or markers.
    Series(SeriesLook),
    /// Shaded area of a height (pixels).
    Ground(Colour, f64),
}

/// Adds a legend below a picture, in as many columns as the words allow.
fn add_legend(svg: &mut Svg, entries: &[(&String, LegendSample)]) {
    let width = svg.size[0] - 2.0 * style::MARGIN + BESIDE;
    let wrapped = |columns: usize| {
        let most = width / columns as f64 - LENGTH - TO_WORDS - BESIDE;
        let all = entries.iter().map(|entry| font::wrap(entry.0, style::LABEL, most)).collect::<Vec<_>>();
        let most_lines = [1, 9, 2, 1, 1][columns];
        let has_room =
            |lines: &Vec<String>| lines.len() <= most_lines && font::widest(lines, style::LABEL) <= most;
        (columns == 1 || all.iter().all(has_room)).then_some((columns, all))
    };
    let Some((columns, all)) = (1..=4.min(entries.len())).rev().find_map(wrapped) else { return };
    let mut words = vec![];
    svg.size[1] += BETWEEN;
    for (row, entries) in all.chunks(columns).zip(entries.chunks(columns)) {
        let top = svg.size[1] + BETWEEN;
        let height = row.iter().map(|lines| font::height(lines.len(), style::LABEL)).fold(0.0, f64::max);
        for (i, (lines, entry)) in row.iter().zip(entries).enumerate() {
            let left = style::MARGIN + width / columns as f64 * i as f64;
            let middle = top + 0.5 * style::LABEL * font::CAPITAL;
            match &entry.1 {
                LegendSample::Series(look) => series::add_legend_sample(svg, look, [left, middle], LENGTH),
                LegendSample::Ground(colour, height) => {
                    let place = box_attributes([left, middle - 0.5 * height], [LENGTH, *height]);
                    svg.add(format_args!("<rect{place} fill=\"{colour}\"/>"));
                }
            }
            words.push((lines, [left + LENGTH + TO_WORDS, top]));
        }
        svg.size[1] = top + height;
    }
    for (lines, at) in words {
        svg.block(lines, at, style::LABEL, "");
    }
}
