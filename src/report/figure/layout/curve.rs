//! Curves, points and their samples in the legend.

use super::super::look::Look;
use super::super::sheet::{Mark, Paint, Place, Stroke};
use super::super::style;
use super::super::{Series, Style};
use super::frame::Frame;
use super::{clip, marker};

/// Half the width of the ends of an error bar.
const CAP: f64 = 4.5;

impl Look {
    pub(super) fn curve(&self, frame: &Frame, series: &Series) -> Option<Mark> {
        let places: Vec<Place> = series.points.iter().map(|point| frame.place(point.x, point.y)).collect();
        let places = if self.style == Style::Steps { steps(&places) } else { places };
        self.line(clip::line(&frame.plot, &places))
    }

    fn line(&self, pieces: Vec<Vec<Place>>) -> Option<Mark> {
        if self.style == Style::Points || pieces.is_empty() {
            return None;
        }
        let width = if self.style == Style::Joined { 0.6 * style::CURVE } else { style::CURVE };
        let stroke = Stroke { colour: self.colour, width, dash: self.dash };
        Some(Mark::Lines { pieces, closed: false, paint: Paint { fill: None, stroke: Some(stroke) } })
    }

    pub(super) fn spreads(&self, frame: &Frame, series: &Series) -> Option<Mark> {
        let bars = series.points.iter().filter_map(|point| Some((point.x, point.spread?)));
        let lines = bars.flat_map(|(x, ends)| {
            let [[x, low], [_, high]] = ends.map(|y| frame.place(x, y));
            let cap = |y: f64| vec![[x - CAP, y], [x + CAP, y]];
            [cap(low), vec![[x, low], [x, high]], cap(high)]
        });
        let pieces: Vec<_> = lines.flat_map(|piece| clip::line(&frame.plot, &piece)).collect();
        let paint = Paint::stroke(self.colour, 0.7 * style::CURVE);
        (!pieces.is_empty()).then_some(Mark::Lines { pieces, closed: false, paint })
    }

    pub(super) fn markers(&self, frame: &Frame, series: &Series) -> Vec<Mark> {
        // One point is no line, but it must be seen.
        if !self.has_markers() && series.points.len() > 1 {
            return Vec::new();
        }
        let places = series.points.iter().map(|point| frame.place(point.x, point.y));
        places.filter(|&place| frame.plot.contains(place)).map(|place| self.marker(place)).collect()
    }

    fn marker(&self, place: Place) -> Mark {
        marker::mark(self.marker, place, self.colour, self.hollow)
    }

    /// A sample for the legend, from a place to the right.
    pub fn sample(&self, [left, y]: Place, width: f64) -> Vec<Mark> {
        let line = self.line(vec![vec![[left, y], [left + width, y]]]);
        let marker = self.has_markers().then(|| self.marker([left + width / 2.0, y]));
        line.into_iter().chain(marker).collect()
    }
}

/// The outline of a histogram whose bins have these middles: each bin reaches halfway to its neighbours.
fn steps(middles: &[Place]) -> Vec<Place> {
    let edge = |i: usize| 0.5 * (middles[i][0] + middles[i + 1][0]);
    let last = middles.len().saturating_sub(1);
    let outline = middles.iter().enumerate().flat_map(|(i, &[x, y])| {
        // The outermost bins are as wide on the outside as on the inside.
        let [inner, outer] = [i.saturating_sub(1), i.min(last.saturating_sub(1))];
        let [left, right] = match last {
            0 => [x, x],
            _ => [
                if i == 0 { 2.0 * x - edge(0) } else { edge(inner) },
                if i == last { 2.0 * x - edge(inner) } else { edge(outer) },
            ],
        };
        [[left, y], [right, y]]
    });
    outline.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_reach_halfway_to_their_neighbours() {
        let outline = steps(&[[0.0, 1.0], [2.0, 3.0], [4.0, 2.0]]);
        assert_eq!(outline, [[-1.0, 1.0], [1.0, 1.0], [1.0, 3.0], [3.0, 3.0], [3.0, 2.0], [5.0, 2.0]]);
        assert_eq!(steps(&[[1.0, 2.0]]), [[1.0, 2.0], [1.0, 2.0]]);
        assert!(steps(&[]).is_empty());
    }
}
