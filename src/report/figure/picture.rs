//! Pictures and the words beside them.

use super::chart::{Axis, Chart};

/// A picture with a name for files, one line that says what it shows, and further notes for the reader.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    pub(crate) name: String,
    pub(crate) title: String,
    pub(crate) caption: String,
    pub(crate) picture: Picture,
}

/// The content of a figure.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Picture {
    /// Curves and points over two axes: a chart without a name, or several beside each other, on the same axes and with one legend.
    Charts(Vec<(String, Chart)>),
    /// A number for each place of a grid, as a colour.
    Map(Map),
    /// Discs, cells and words at their places.
    Drawing(Drawing),
    /// A picture that was drawn before and is read from its file.
    Drawn {
        /// The file's text.
        svg: String,
        /// Set if a table of its data lies beside the file.
        has_data: bool,
    },
}

impl Picture {
    /// Returns the figure of this picture, without a caption.
    pub(crate) fn figure(self, name: impl Into<String>, title: impl Into<String>) -> Figure {
        Figure { name: name.into(), title: title.into(), caption: String::new(), picture: self }
    }
}

impl Chart {
    /// Returns the figure of this chart, without a caption.
    pub fn figure(self, name: impl Into<String>, title: impl Into<String>) -> Figure {
        Picture::Charts(vec![(String::new(), self)]).figure(name, title)
    }
}

impl Figure {
    /// Sets the caption.
    pub(crate) fn caption(self, caption: impl Into<String>) -> Figure {
        Figure { caption: caption.into(), ..self }
    }

    /// Returns whether there is anything to see: a chart without a point is none.
    pub(crate) fn has_points(&self) -> bool {
        let has = |chart: &Chart| chart.series.iter().any(|series| !series.points.is_empty());
        match &self.picture {
            Picture::Charts(panels) => panels.iter().any(|(_, chart)| has(chart)),
            Picture::Map(_) | Picture::Drawing(_) | Picture::Drawn { .. } => true,
        }
    }

    /// Names in the legend of a chart.
    pub fn legend(&self) -> Vec<&str> {
        let charts: Vec<&Chart> = match &self.picture {
            Picture::Charts(panels) => panels.iter().map(|(_, chart)| chart).collect(),
            Picture::Map(_) | Picture::Drawing(_) | Picture::Drawn { .. } => vec![],
        };
        let mut names: Vec<&str> = vec![];
        for chart in charts {
            let all = chart.series.iter().map(|it| &it.name).chain(chart.bands.iter().map(|it| &it.label));
            let new = all.map(String::as_str).filter(|name| !name.is_empty());
            for name in new {
                if !names.contains(&name) {
                    names.push(name);
                }
            }
        }
        names
    }
}

/// A heat map, such as the density over place and time.
///
/// The limits of its axes are the outer edges of the outermost cells; an axis of names needs none.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Map {
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    /// The quantity that colours show.
    pub(crate) value: Axis,
    /// `rows[j][i]`: the value at row j (from the bottom) and column i. All rows are equally long. NaN leaves a cell empty.
    pub(crate) rows: Vec<Vec<f64>>,
}

/// A drawing in its own coordinates: x to the right, y upwards.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Drawing {
    /// Lower left and upper right corner of the visible part.
    pub(crate) window: [[f64; 2]; 2],
    /// Width of the picture (pixels); its height follows from the window.
    pub(crate) width: f64,
    /// Shapes from back to front. They are not stored with a section: its picture is.
    pub(crate) shapes: Vec<Shape>,
    /// Lowest and highest value of the shades, and their quantity with its unit; none where shades mean nothing.
    pub(crate) shades: Option<(f64, f64, String)>,
    /// Scale bar and gravity below the drawing; none where the coordinates mean nothing.
    pub(crate) guide: Option<Guide>,
}

/// Unit and direction of gravity in a drawing's coordinates.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Guide {
    pub unit: String,
    pub gravity: Option<[f64; 2]>,
}

/// A shape of a drawing.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Shape {
    Disc {
        centre: [f64; 2],
        radius: f64,
        tint: Tint,
    },
    /// A box with an outline, from its lower left to its upper right corner.
    Rectangle {
        corners: [[f64; 2]; 2],
        tint: Tint,
    },
    Line {
        ends: [[f64; 2]; 2],
    },
    /// Words with capitals of a height, in the drawing's coordinates.
    Text {
        centre: [f64; 2],
        height: f64,
        words: String,
    },
}

impl Shape {
    /// Opposite corners of the box around it.
    pub(super) fn extent(&self) -> [[f64; 2]; 2] {
        match *self {
            Shape::Disc { centre: [x, y], radius: most, .. }
            | Shape::Text { centre: [x, y], height: most, .. } => {
                [[x - most, y - most], [x + most, y + most]]
            }
            Shape::Rectangle { corners: ends, .. } | Shape::Line { ends } => ends,
        }
    }
}

/// A filling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Tint {
    Clear,
    /// Light grey, for parts that do not move.
    Still,
    /// Index of a colour in the palette.
    Hue(usize),
    /// A part of the way from the lowest (0) to the highest shade (1).
    Shade(f64),
}
