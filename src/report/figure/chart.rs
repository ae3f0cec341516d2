//! Charts: curves and points over two axes.

use serde::Deserialize;

/// Chart. The coordinates of all points must be finite, and positive on a logarithmic axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    pub(crate) x: ChartAxis,
    pub(crate) y: ChartAxis,
    /// In the order of the legend.
    pub(crate) series: Vec<Series>,
    /// Marked parts of the plane.
    pub(crate) bands: Vec<ChartBand>,
}

impl Chart {
    /// Makes an empty chart over two axes.
    pub fn of(x: ChartAxis, y: ChartAxis) -> Chart {
        Chart { x, y, series: vec![], bands: vec![] }
    }

    /// Axis along which the spreads of points extend.
    pub(super) fn spreads_along(&self) -> (&ChartAxis, AxisDirection) {
        if matches!(self.y.scale, Scale::Names(_)) {
            (&self.x, AxisDirection::X)
        } else {
            (&self.y, AxisDirection::Y)
        }
    }

    /// Adds a series.
    pub fn series(
        self,
        name: impl Into<String>,
        style: Style,
        hue: usize,
        points: impl IntoIterator<Item = impl Into<SeriesPoint>>,
    ) -> Chart {
        self.with([Series::new(name, style, hue, points)])
    }

    /// Adds further series.
    pub(crate) fn with(mut self, series: impl IntoIterator<Item = Series>) -> Chart {
        self.series.extend(series);
        self
    }

    /// Marks a part of the plane.
    pub(crate) fn band(mut self, band: ChartBand) -> Chart {
        self.bands.push(band);
        self
    }
}

/// Axis. Without limits it is fitted to the data.
#[derive(Clone, Debug, PartialEq)]
pub struct ChartAxis {
    pub(crate) label: String,
    pub(crate) unit: Option<String>,
    pub(crate) scale: Scale,
    pub(crate) limits: Option<[f64; 2]>,
}

impl ChartAxis {
    /// Makes a linear axis. Counts and ratios have no unit.
    pub(crate) fn linear(label: &str, unit: Option<&str>) -> ChartAxis {
        ChartAxis {
            label: label.to_owned(),
            unit: unit.map(str::to_owned),
            scale: Scale::Linear,
            limits: None,
        }
    }

    /// Makes a logarithmic axis.
    pub fn logarithmic(label: &str, unit: Option<&str>) -> ChartAxis {
        ChartAxis { scale: Scale::Logarithmic, ..ChartAxis::linear(label, unit) }
    }

    /// Makes an axis of names; number 0 represents the first.
    pub fn names(label: &str, names: impl IntoIterator<Item = impl Into<String>>) -> ChartAxis {
        ChartAxis {
            scale: Scale::Names(names.into_iter().map(Into::into).collect()),
            ..ChartAxis::linear(label, None)
        }
    }

    /// Sets the limits.
    pub(crate) fn between(self, ends: [f64; 2]) -> ChartAxis {
        ChartAxis { limits: Some(ends), ..self }
    }

    /// Returns label and unit as one text.
    pub(crate) fn heading(&self) -> String {
        self.unit.iter().fold(self.label.clone(), |label, unit| format!("{label} ({unit})"))
    }
}

/// Scale of an axis.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Scale {
    Linear,
    Logarithmic,
    /// Names at the numbers 0, 1, 2 and so on.
    Names(Vec<String>),
}

/// Named set of points.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Series {
    /// Name in the legend; empty for no entry.
    pub name: String,
    pub(crate) style: Style,
    /// Index of a colour in the palette; related series share a hue.
    pub(crate) hue: usize,
    /// Points, by increasing x if they are joined.
    pub(crate) points: Vec<SeriesPoint>,
}

impl Series {
    /// Makes a series of points.
    pub(crate) fn new(
        name: impl Into<String>,
        style: Style,
        hue: usize,
        points: impl IntoIterator<Item = impl Into<SeriesPoint>>,
    ) -> Series {
        Series { name: name.into(), style, hue, points: points.into_iter().map(Into::into).collect() }
    }
}

/// Look of a series.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum Style {
    /// A line, for a model.
    Line,
    /// A dashed line, for a comparison or a limit.
    Dashed,
    /// Points alone, for measurements.
    Points,
    /// Large points, to highlight a few on curves.
    Marks,
    /// Points joined by a line.
    Joined,
    /// A dashed line on a shaded area between the ends of the spreads: a mean with its error.
    Ribbon,
}

/// Point of a series. Its spread is the lowest and highest observed or credible value of y, or of x if the y axis has names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeriesPoint {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) spread: Option<[f64; 2]>,
}

impl SeriesPoint {
    /// Makes a point without spread.
    pub fn at(x: f64, y: f64) -> SeriesPoint {
        SeriesPoint { x, y, spread: None }
    }
}

impl From<(f64, f64)> for SeriesPoint {
    fn from((x, y): (f64, f64)) -> SeriesPoint {
        SeriesPoint::at(x, y)
    }
}

impl From<(f64, f64, [f64; 2])> for SeriesPoint {
    fn from((x, y, spread): (f64, f64, [f64; 2])) -> SeriesPoint {
        SeriesPoint { x, y, spread: Some(spread) }
    }
}

/// Marked part of the plane: the area between two values, or a line at one value.
///
/// Bands between values of x are grey, for instance unreachable densities; bands between values of y are light, for instance acceptable
/// errors.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ChartBand {
    pub(crate) label: String,
    /// Ends of the band; equal ends make a line.
    pub(crate) ends: [f64; 2],
    pub(crate) along: AxisDirection,
}

impl ChartBand {
    /// Marks the plane between two values of x.
    pub(crate) fn of_x(label: &str, ends: [f64; 2]) -> ChartBand {
        ChartBand { label: label.to_owned(), ends, along: AxisDirection::X }
    }

    /// Marks the plane between two values of y.
    pub(crate) fn of_y(label: &str, ends: [f64; 2]) -> ChartBand {
        ChartBand { along: AxisDirection::Y, ..ChartBand::of_x(label, ends) }
    }

    /// Returns true if the band is a line.
    pub(super) fn is_line(&self) -> bool {
        self.ends[0] == self.ends[1]
    }
}

/// One of two axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AxisDirection {
    X,
    Y,
}
