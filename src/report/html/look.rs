//! How the series of a chart look and where its axes end, by the rules of the pictures in SVG.

use super::quantised;
use crate::report::figure::style::{self, Marker};
use crate::report::figure::{Axis, Chart, Scale, Series, Style};
use serde::Serialize;

/// How a series looks.
#[derive(Debug, PartialEq, Serialize)]
pub struct Look {
    colour: String,
    /// Lengths of dashes and gaps, empty for an unbroken line; none without a line.
    dash: Option<&'static [f64]>,
    /// The scripts' name of the marker; none without markers.
    marker: Option<&'static str>,
    /// Whether the markers are outlines.
    hollow: bool,
}

/// The looks of a chart's series: lines of one hue differ by their dashes, markers of one hue are full, hollow, and
/// then of another shape.
pub fn looks(chart: &Chart) -> Vec<Look> {
    let look = |(i, series): (usize, &Series)| {
        let marked = has_markers(series.style);
        let twin = |other: &&Series| other.hue == series.hue && has_markers(other.style) == marked;
        let twins = chart.series[..i].iter().filter(twin).count();
        Look {
            colour: style::hue(series.hue).to_string(),
            dash: match series.style {
                Style::Line => Some(style::line_dash(series.hue + twins)),
                Style::Dashed => Some(style::short_dash(series.hue + twins)),
                Style::Joined => Some(&[]),
                Style::Points => None,
            },
            marker: marked.then(|| name(style::marker(series.hue + twins / 2))),
            hollow: marked && twins % 2 == 1,
        }
    };
    chart.series.iter().enumerate().map(look).collect()
}

fn has_markers(style: Style) -> bool {
    matches!(style, Style::Points | Style::Joined)
}

/// A marker's name in the scripts.
fn name(marker: Marker) -> &'static str {
    match marker {
        Marker::Disc => "disc",
        Marker::Square => "square",
        Marker::Triangle => "triangle",
        Marker::Diamond => "diamond",
        Marker::Cross => "cross",
        Marker::Wedge => "wedge",
        Marker::Plus => "plus",
        Marker::Star => "star",
    }
}

/// The ends of an axis: its limits, or those of the data and a little more. Without data, any.
pub fn ends(axis: &Axis, data: impl Iterator<Item = f64>) -> [f64; 2] {
    /// Part of the data's extent that is left free at each end.
    const FREE: f64 = 0.04;
    if let Some(limits) = axis.limits {
        return limits;
    }
    // Room is reckoned in logarithms on a logarithmic axis.
    let measure = |value: f64| if axis.scale == Scale::Logarithmic { libm::log10(value) } else { value };
    let value =
        |measure: f64| if axis.scale == Scale::Logarithmic { libm::pow(10.0, measure) } else { measure };
    let [low, high] = quantised::ends(data.map(measure)).unwrap_or([0.0, 1.0]);
    let free = match axis.scale {
        _ if high > low => FREE * (high - low),
        Scale::Logarithmic => libm::log10(2.0),
        Scale::Linear if low == 0.0 => 1.0,
        Scale::Linear => 0.1 * low.abs(),
    };
    // A quantity that is positive keeps a positive axis.
    let positive = axis.scale == Scale::Linear && low > 0.0;
    [if positive { (low - free).max(0.0) } else { low - free }, high + free].map(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(style: Style, hue: usize) -> Series {
        Series { name: String::new(), style, hue, points: vec![] }
    }

    #[test]
    fn series_of_one_hue_differ() {
        let axis = Axis::linear("x", None);
        let all = [Style::Joined, Style::Points, Style::Points, Style::Line, Style::Line, Style::Dashed];
        let series = all.map(|style| series(style, 3)).to_vec();
        let looks = looks(&Chart { x: axis.clone(), y: axis, series, bands: vec![] });
        for (i, look) in looks.iter().enumerate() {
            assert!(looks[..i].iter().all(|other| other != look), "{look:?}");
        }
        assert_eq!((looks[1].marker, looks[1].hollow), (looks[0].marker, true));
    }

    #[test]
    fn ends_leave_some_room_but_never_go_below_zero_for_nothing() {
        let of = |axis: Axis, data: &[f64]| ends(&axis, data.iter().copied());
        assert_eq!(of(Axis::linear("x", None), &[-50.0, 50.0]), [-54.0, 54.0]);
        assert_eq!(of(Axis::linear("x", None), &[1.0, 101.0]), [0.0, 105.0]);
        assert_eq!(of(Axis::linear("x", None), &[0.0]), [-1.0, 1.0]);
        let [low, high] = of(Axis::logarithmic("x", None), &[1.0, 1e10]);
        assert!(0.1 < low && low < 1.0 && 1e10 < high && high < 1e11);
        assert_eq!(of(Axis { limits: Some([2.0, 3.0]), ..Axis::linear("x", None) }, &[9.0]), [2.0, 3.0]);
    }
}
