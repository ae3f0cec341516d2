//! One marked edge of a picture: marks, numbers and a heading.

use super::super::sheet::{Anchor, Mark, Paint, Place};
use super::super::{Axis, font, style};
use super::ruler::Ruler;
use super::ticks::{Tick, ticks};
use super::title;

/// Length of a mark with a number, and of one without.
const TICKS: [f64; 2] = [7.0, 4.0];
/// From a mark to its number.
const TO_NUMBER: f64 = 5.0;
/// From the numbers to the heading.
const TO_HEADING: f64 = 12.0;

/// Which edge of a picture is marked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The lower edge.
    Bottom,
    /// The left edge.
    Left,
    /// The right edge.
    Right,
}

/// A marked edge.
pub struct Edge {
    side: Side,
    ruler: Ruler,
    ticks: Vec<Tick>,
    heading: Vec<String>,
    zoom: f64,
}

impl Edge {
    /// An edge along two pixels, marked as closely as its numbers allow.
    pub fn new(side: Side, axis: &Axis, ends: [f64; 2], pixels: [f64; 2], zoom: f64) -> Edge {
        let length = (pixels[1] - pixels[0]).abs();
        let ruler = Ruler::new(axis.scale, ends, pixels);
        let heading = font::wrap(&axis.heading(), style::HEADING * zoom, length);
        let mut edge = Edge { side, ruler, ticks: Vec::new(), heading, zoom };
        let marked = |most| ticks(axis.scale, ends, most);
        // Where two neighbours find no room, the outermost may.
        let mut choices = (1..=8).rev().map(marked).chain((1..=8).map(|most| outermost(marked(most))));
        edge.ticks = choices.find(|ticks| edge.can_be_read(ticks)).unwrap_or_else(|| marked(1));
        edge
    }

    /// How numbers lie on it.
    pub fn ruler(&self) -> &Ruler {
        &self.ruler
    }

    /// Where its numbers stand.
    pub fn numbered(&self) -> impl Iterator<Item = f64> {
        self.ticks.iter().filter(|tick| tick.label.is_some()).map(|tick| self.ruler.pixel(tick.at))
    }

    /// How far it reaches out from the picture.
    pub fn depth(&self) -> f64 {
        self.numbers_end() + self.zoom * TO_HEADING + title::block_height(&self.heading, self.heading_size())
    }

    /// The edge as marks, at a distance from the sheet's upper (or left) edge.
    pub fn marks(&self, at: f64) -> Vec<Mark> {
        let places = || self.ticks.iter().map(|tick| (tick, self.ruler.pixel(tick.at)));
        let line = |(tick, along): (&Tick, f64)| {
            let length = TICKS[usize::from(tick.label.is_none())] * self.zoom;
            vec![self.outward(at, along, 0.0), self.outward(at, along, length)]
        };
        let paint = Paint::stroke(style::INK, style::AXIS * self.zoom);
        let mut marks = vec![Mark::Lines { pieces: places().map(line).collect(), closed: false, paint }];
        marks.extend(places().filter_map(|(tick, along)| Some(self.number(at, along, tick.label.as_ref()?))));
        marks.extend(self.heading_marks(at));
        marks
    }

    fn number(&self, at: f64, along: f64, label: &str) -> Mark {
        let capital = font::CAPITAL * self.label_size();
        let [x, y] = self.outward(at, along, self.zoom * (TICKS[0] + TO_NUMBER));
        let (place, anchor) = match self.side {
            Side::Bottom => ([x, y + capital], Anchor::Middle),
            Side::Left => ([x, y + capital / 2.0], Anchor::End),
            Side::Right => ([x, y + capital / 2.0], Anchor::Start),
        };
        title::words(place, anchor, self.label_size(), label)
    }

    fn heading_marks(&self, at: f64) -> Vec<Mark> {
        let size = self.heading_size();
        let [start, end] = self.ruler.pixels();
        let middle = (start + end) / 2.0;
        let first = match self.side {
            Side::Left => at - self.depth(),
            Side::Bottom | Side::Right => at + self.numbers_end() + self.zoom * TO_HEADING,
        };
        let mut marks = title::block(&self.heading, middle, first, Anchor::Middle, size);
        if self.side != Side::Bottom {
            for mark in &mut marks {
                let Mark::Words { at: place, upwards, .. } = mark else { continue };
                *upwards = true;
                place.swap(0, 1);
            }
        }
        marks
    }

    fn numbers_end(&self) -> f64 {
        let numbers = match self.side {
            Side::Bottom => font::CAPITAL * self.label_size(),
            Side::Left | Side::Right => {
                font::widest(self.ticks.iter().filter_map(|tick| tick.label.as_ref()), self.label_size())
            }
        };
        self.zoom * (TICKS[0] + TO_NUMBER) + numbers
    }

    /// Whether there are two numbers at least, and none touches another.
    fn can_be_read(&self, ticks: &[Tick]) -> bool {
        let size = self.label_size();
        let length = |label: &str| match self.side {
            Side::Bottom => font::width(label, size) + size,
            Side::Left | Side::Right => 2.4 * size,
        };
        let numbers: Vec<[f64; 2]> = ticks
            .iter()
            .filter_map(|tick| Some([self.ruler.pixel(tick.at), length(tick.label.as_ref()?)]))
            .collect();
        let apart =
            |[[here, length], [there, next]]: [[f64; 2]; 2]| (there - here).abs() >= (length + next) / 2.0;
        numbers.len() > 1 && numbers.windows(2).all(|pair| apart([pair[0], pair[1]]))
    }

    fn outward(&self, at: f64, along: f64, distance: f64) -> Place {
        match self.side {
            Side::Bottom => [along, at + distance],
            Side::Left => [at - distance, along],
            Side::Right => [at + distance, along],
        }
    }

    fn label_size(&self) -> f64 {
        style::LABEL * self.zoom
    }

    fn heading_size(&self) -> f64 {
        style::HEADING * self.zoom
    }
}

/// The same marks with numbers at the first and the last only.
fn outermost(mut ticks: Vec<Tick>) -> Vec<Tick> {
    let numbered: Vec<usize> = (0..ticks.len()).filter(|&i| ticks[i].label.is_some()).collect();
    for &i in numbered.iter().skip(1).rev().skip(1) {
        ticks[i].label = None;
    }
    ticks
}
