//! Pictures with their names, titles and captions.

use super::chart::{Chart, ChartAxis};

/// Picture with a name for files, a title and a caption.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    pub(crate) name: String,
    pub(crate) title: String,
    pub(crate) caption: String,
    pub(crate) picture: Picture,
}

/// Content of a figure.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Picture {
    /// Curves and points over two axes: one chart without a name, or several side by side with the same axes and one legend.
    Charts(Vec<(String, Chart)>),
    /// Heat map: a colour for the value of each cell of a grid.
    Map(HeatMap),
    /// Drawing of discs, cells and words.
    Drawing(Drawing),
    /// Picture read from a file.
    Drawn {
        /// Contents of the file.
        svg: String,
        /// True if the item has a table of its data.
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

    /// Returns true if there is anything to draw; false for a chart without points.
    pub(crate) fn has_points(&self) -> bool {
        let has = |chart: &Chart| chart.series.iter().any(|series| !series.points.is_empty());
        match &self.picture {
            Picture::Charts(panels) => panels.iter().any(|(_, chart)| has(chart)),
            Picture::Map(_) | Picture::Drawing(_) | Picture::Drawn { .. } => true,
        }
    }

    /// Entries of the legend.
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

/// Heat map, such as the density by position and time.
///
/// The limits of its axes are the outer edges of the outermost cells; an axis of names needs no limits.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct HeatMap {
    pub(crate) x: ChartAxis,
    pub(crate) y: ChartAxis,
    /// Quantity shown by colours.
    pub(crate) value: ChartAxis,
    /// `rows[j][i]`: value in row j (from the bottom) and column i. All rows have the same length. NaN leaves a cell empty.
    pub(crate) rows: Vec<Vec<f64>>,
}

/// Drawing in its own coordinates: x to the right, y upwards.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Drawing {
    /// Lower left and upper right corner of the visible part.
    pub(crate) window: [[f64; 2]; 2],
    /// Width of the picture (pixels); its height follows from the window.
    pub(crate) width: f64,
    /// Shapes from back to front. An item stores the picture, not the shapes.
    pub(crate) shapes: Vec<DrawnShape>,
    /// Lowest and highest value of the shades, and their quantity with its unit; `None` if shades have no meaning.
    pub(crate) shades: Option<(f64, f64, String)>,
    /// Scale bar and gravity below the drawing; `None` if the coordinates have no unit.
    pub(crate) guide: Option<Guide>,
}

/// Unit of length, and direction of gravity in a drawing's coordinates.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Guide {
    pub unit: String,
    pub gravity: Option<[f64; 2]>,
}

/// Shape of a drawing.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum DrawnShape {
    Disc {
        centre: [f64; 2],
        radius: f64,
        tint: Tint,
    },
    /// Outlined box, from its lower left to its upper right corner.
    Rectangle {
        corners: [[f64; 2]; 2],
        tint: Tint,
    },
    Line {
        ends: [[f64; 2]; 2],
    },
    /// Words whose capitals have a given height in the drawing's coordinates.
    Text {
        centre: [f64; 2],
        height: f64,
        words: String,
    },
}

impl DrawnShape {
    /// Opposite corners of the bounding box.
    pub(super) fn extent(&self) -> [[f64; 2]; 2] {
        match *self {
            DrawnShape::Disc { centre: [x, y], radius: most, .. }
            | DrawnShape::Text { centre: [x, y], height: most, .. } => {
                [[x - most, y - most], [x + most, y + most]]
            }
            DrawnShape::Rectangle { corners: ends, .. } | DrawnShape::Line { ends } => ends,
        }
    }
}

/// Fill of a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Tint {
    Clear,
    /// Light grey, for fixed parts.
    Still,
    /// Index of a colour in the palette.
    Hue(usize),
    /// Fraction between the lowest (0) and the highest shade (1).
    Shade(f64),
}
