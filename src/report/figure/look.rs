//! How the series and bands of a chart look, on it and in its legend.

use super::style::{self, Colour, Marker};
use super::{Along, Chart, Series, Style};

/// How a series looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// How it is drawn.
    pub style: Style,
    /// Its colour.
    pub colour: Colour,
    /// Its marker, where it has markers.
    pub marker: Marker,
    /// Lengths of dashes and gaps (pixels), empty for an unbroken line.
    pub dash: &'static [f64],
    /// Whether the markers are outlines.
    pub hollow: bool,
}

impl Look {
    /// Whether points have markers.
    pub fn has_markers(&self) -> bool {
        has_markers(self.style)
    }
}

/// The looks of a chart's series, all of them different: lines of one hue differ by their dashes, markers of one hue are
/// full, hollow, and then of another shape.
pub fn looks(chart: &Chart) -> Vec<Look> {
    let look = |(i, series): (usize, &Series)| {
        let alike = |other: &Series| {
            other.style == series.style || (has_markers(other.style) && has_markers(series.style))
        };
        let twins = chart.series[..i].iter().filter(|other| other.hue == series.hue && alike(other)).count();
        // Beyond the palette's end colours begin again.
        let colour = |series: &Series| style::hue(series.hue);
        let before = chart.series[..i]
            .iter()
            .filter(|other| other.style == series.style && colour(other) == colour(series))
            .count();
        Look {
            style: series.style,
            colour: style::hue(series.hue),
            marker: style::marker(series.hue + twins / 2),
            dash: match series.style {
                Style::Line => style::line_dash(series.hue + twins),
                Style::Dashed => style::short_dash(series.hue + twins),
                Style::Joined | Style::Steps => style::line_dash(before),
                Style::Ribbon => style::short_dash(before),
                Style::Points => &[],
            },
            hollow: twins % 2 == 1,
        }
    };
    chart.series.iter().enumerate().map(look).collect()
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

fn has_markers(style: Style) -> bool {
    matches!(style, Style::Points | Style::Joined)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::figure::Axis;

    #[test]
    fn no_two_lines_have_one_colour_and_dash() {
        for style in [Style::Line, Style::Dashed, Style::Joined, Style::Steps, Style::Ribbon] {
            let axis = Axis::linear("x", None);
            let series =
                (0..14).map(|hue| Series { name: String::new(), style, hue, points: vec![] }).collect();
            let looks = looks(&Chart { x: axis.clone(), y: axis, series, bands: vec![] });
            for (i, look) in looks.iter().enumerate() {
                let same =
                    looks[..i].iter().any(|other| (other.colour, other.dash) == (look.colour, look.dash));
                assert!(!same, "{style:?}, series {i}");
            }
        }
    }

    #[test]
    fn series_of_one_hue_differ() {
        let axis = Axis::linear("x", None);
        let all = [Style::Joined, Style::Points, Style::Points, Style::Line, Style::Line, Style::Dashed];
        let series = all.map(|style| Series { name: String::new(), style, hue: 3, points: vec![] }).to_vec();
        let looks = looks(&Chart { x: axis.clone(), y: axis, series, bands: vec![] });
        for (i, look) in looks.iter().enumerate() {
            assert!(looks[..i].iter().all(|other| other != look), "{look:?}");
        }
        assert_eq!((looks[1].marker, looks[1].hollow), (looks[0].marker, true));
    }
}
