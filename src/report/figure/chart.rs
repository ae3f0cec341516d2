//! Curves and points over two axes.

use serde::{Deserialize, Serialize};

/// A chart. A point that an axis cannot show (zero or less on a logarithmic one, not finite) must not be in it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Chart {
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// What is drawn, in the order of the legend.
    pub series: Vec<Series>,
    /// Parts of the plane that mean something.
    pub bands: Vec<Band>,
}

impl Chart {
    /// A chart over two axes, with nothing on it so far.
    pub fn of(x: Axis, y: Axis) -> Chart {
        Chart { x, y, series: vec![], bands: vec![] }
    }

    /// With a series more.
    pub fn series(
        self,
        name: impl Into<String>,
        style: Style,
        hue: usize,
        points: impl IntoIterator<Item = impl Into<Point>>,
    ) -> Chart {
        self.with([Series::new(name, style, hue, points)])
    }

    /// With further series.
    pub fn with(mut self, series: impl IntoIterator<Item = Series>) -> Chart {
        self.series.extend(series);
        self
    }

    /// With a part of the plane that means something.
    pub fn band(mut self, band: Band) -> Chart {
        self.bands.push(band);
        self
    }
}

/// An axis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    /// The quantity.
    pub label: String,
    /// Its unit; none for counts and ratios.
    pub unit: Option<String>,
    /// How numbers lie on it.
    pub scale: Scale,
    /// Its ends; none to take them from the data.
    pub limits: Option<[f64; 2]>,
}

impl Axis {
    /// A linear axis that fits its data.
    pub fn linear(label: &str, unit: Option<&str>) -> Axis {
        Axis { label: label.to_owned(), unit: unit.map(str::to_owned), scale: Scale::Linear, limits: None }
    }

    /// A logarithmic axis that fits its data.
    pub fn logarithmic(label: &str, unit: Option<&str>) -> Axis {
        Axis { scale: Scale::Logarithmic, ..Axis::linear(label, unit) }
    }

    /// With these ends, whatever its data.
    pub fn between(self, ends: [f64; 2]) -> Axis {
        Axis { limits: Some(ends), ..self }
    }

    /// Label and unit as one text.
    pub fn heading(&self) -> String {
        match &self.unit {
            Some(unit) => format!("{} ({unit})", self.label),
            None => self.label.clone(),
        }
    }
}

/// How numbers lie on an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Scale {
    /// Equal differences.
    Linear,
    /// Equal ratios, decades marked.
    Logarithmic,
}

/// A named set of points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Series {
    /// Its name in the legend.
    pub name: String,
    /// How it is drawn.
    pub style: Style,
    /// Which colour of the palette; series that belong together share one.
    pub hue: usize,
    /// The points, by increasing x where they are joined.
    pub points: Vec<Point>,
}

impl Series {
    /// A series of points.
    pub fn new(
        name: impl Into<String>,
        style: Style,
        hue: usize,
        points: impl IntoIterator<Item = impl Into<Point>>,
    ) -> Series {
        Series { name: name.into(), style, hue, points: points.into_iter().map(Into::into).collect() }
    }

    /// A series for each name that points bear, in the order in which names occur.
    pub fn by_name(
        style: Style,
        points: impl IntoIterator<Item = (impl Into<String>, impl Into<Point>)>,
    ) -> Vec<Series> {
        let mut all: Vec<Series> = vec![];
        for (name, point) in points {
            let (name, hue) = (name.into(), all.len());
            match all.iter_mut().find(|known| known.name == name) {
                Some(known) => known.points.push(point.into()),
                None => all.push(Series::new(name, style, hue, [point])),
            }
        }
        all
    }
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Style {
    /// A line: what a model says.
    Line,
    /// A dashed line: a rival, or what cannot be reached.
    Dashed,
    /// Points alone: what was measured.
    Points,
    /// Points joined by a line.
    Joined,
    /// Steps of a histogram: each point is the middle of a bin.
    Steps,
    /// A dashed line within the ground between the ends of the spreads: a mean with its error.
    Ribbon,
}

/// A point of a series.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// On the horizontal axis.
    pub x: f64,
    /// On the vertical axis.
    pub y: f64,
    /// Lowest and highest value of y that was seen or is believable.
    pub spread: Option<[f64; 2]>,
}

impl Point {
    /// A point without spread.
    pub fn at(x: f64, y: f64) -> Point {
        Point { x, y, spread: None }
    }
}

impl From<(f64, f64)> for Point {
    fn from((x, y): (f64, f64)) -> Point {
        Point::at(x, y)
    }
}

/// With its spread.
impl From<(f64, f64, [f64; 2])> for Point {
    fn from((x, y, spread): (f64, f64, [f64; 2])) -> Point {
        Point { x, y, spread: Some(spread) }
    }
}

/// A part of the plane that means something.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Band {
    /// What it means.
    pub label: String,
    /// Where it begins and ends.
    pub ends: [f64; 2],
    /// Between two values of x it is hatched, such as densities that no configuration has; between two values of y it is a
    /// light ground, such as errors that are small enough.
    pub along: Along,
}

impl Band {
    /// Between two values of x.
    pub fn of_x(label: &str, ends: [f64; 2]) -> Band {
        Band { label: label.to_owned(), ends, along: Along::X }
    }

    /// Between two values of y.
    pub fn of_y(label: &str, ends: [f64; 2]) -> Band {
        Band { label: label.to_owned(), ends, along: Along::Y }
    }
}

/// An axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Along {
    /// The horizontal one.
    X,
    /// The vertical one.
    Y,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_a_name_are_one_series() {
        let series =
            Series::by_name(Style::Points, [("b", (0.0, 1.0)), ("a", (1.0, 2.0)), ("b", (2.0, 3.0))]);
        let [b, a] = series.as_slice() else { panic!("{series:?}") };
        assert_eq!((b.name.as_str(), b.hue, a.name.as_str(), a.hue), ("b", 0, "a", 1));
        assert_eq!(b.points, [Point::at(0.0, 1.0), Point::at(2.0, 3.0)]);
    }
}
