//! How series look, as the scripts read it.

use crate::report::figure::Chart;
use crate::report::figure::Style;
use crate::report::figure::look::{self, Look};
use crate::report::figure::style::Marker;
use serde::Serialize;

/// How a series looks, in the words of the scripts.
#[derive(Debug, PartialEq, Serialize)]
pub struct SeriesLook {
    colour: String,
    /// Lengths of dashes and gaps, empty for an unbroken line; none without a line.
    dash: Option<&'static [f64]>,
    /// The name of the marker; none without markers.
    marker: Option<&'static str>,
    /// Whether the markers are outlines.
    hollow: bool,
    /// Whether it is a histogram, whose points are the middles of bins.
    steps: bool,
}

/// The looks of a chart's series, as in the pictures.
pub fn looks(chart: &Chart) -> Vec<SeriesLook> {
    let written = |look: Look| SeriesLook {
        colour: look.colour.to_string(),
        dash: (look.style != Style::Points).then_some(look.dash),
        marker: look.has_markers().then(|| name(look.marker)),
        hollow: look.has_markers() && look.hollow,
        steps: look.style == Style::Steps,
    };
    look::looks(chart).into_iter().map(written).collect()
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
