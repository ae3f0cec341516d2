//! A picture, and what stands beside it.

use super::chart::Chart;
use super::drawing::Drawing;
use super::map::Map;
use serde::{Deserialize, Serialize};

/// A picture with a name for files.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figure {
    /// A name for files, in lower case.
    pub name: String,
    /// What it shows, in one line.
    pub title: String,
    /// What a reader must also know.
    pub caption: String,
    /// What is drawn.
    pub picture: Picture,
}

/// What is drawn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Picture {
    /// Curves and points over two axes.
    Chart(Chart),
    /// A number for each place of a grid, as a colour.
    Map(Map),
    /// Things where they are.
    Drawing(Drawing),
    /// A picture that was drawn before, as SVG, and whether a file has its data.
    Drawn {
        /// The picture.
        svg: String,
        /// Whether a file has its data.
        has_data: bool,
    },
}

impl Picture {
    /// As a figure without a caption.
    pub fn figure(self, name: impl Into<String>, title: impl Into<String>) -> Figure {
        Figure { name: name.into(), title: title.into(), caption: String::new(), picture: self }
    }
}

impl Chart {
    /// As a figure without a caption.
    pub fn figure(self, name: impl Into<String>, title: impl Into<String>) -> Figure {
        Picture::Chart(self).figure(name, title)
    }
}

impl Figure {
    /// With what a reader must also know.
    pub fn caption(self, caption: impl Into<String>) -> Figure {
        Figure { caption: caption.into(), ..self }
    }
}
