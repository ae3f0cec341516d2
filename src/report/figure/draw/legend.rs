//! What the curves, markers and grounds of a chart mean, to the right of it. The library's own legends show a line or a
//! marker, not both.

use super::super::look::{Look, grounds, looks};
use super::super::{Chart, font, style};
use super::frame::colour;
use super::{series, words};
use kuva::render::render::{Primitive, Scene};

/// From the chart to the legend.
const GAP: f64 = 24.0;
/// Width of a sample: two of the longest dashes.
const SAMPLE: f64 = 54.0;
/// From a sample to its words.
const TO_WORDS: f64 = 10.0;
/// Most width of the words, if they can be broken.
const MOST_WORDS: f64 = 215.0;
/// From one entry to the next.
const BETWEEN: f64 = 13.0;

/// A legend.
pub struct Legend {
    entries: Vec<Entry>,
}

struct Entry {
    sample: Sample,
    lines: Vec<String>,
}

enum Sample {
    Series(Look),
    Band(style::Colour),
}

impl Legend {
    /// The legend of a chart: what has a name and something to show.
    pub fn new(chart: &Chart) -> Legend {
        let entry = |sample, name: &str| {
            let lines = font::wrap(name, style::LABEL, MOST_WORDS);
            (!lines.is_empty()).then_some(Entry { sample, lines })
        };
        let series = chart.series.iter().zip(looks(chart)).filter(|(series, _)| !series.points.is_empty());
        let series = series.filter_map(|(series, look)| entry(Sample::Series(look), &series.name));
        let bands = chart.bands.iter().zip(grounds(chart));
        let bands = bands.filter_map(|(band, colour)| entry(Sample::Band(colour), &band.label));
        Legend { entries: series.chain(bands).collect() }
    }

    /// The width it needs at the right of a chart, up to the edge of the picture.
    pub fn width(&self) -> f64 {
        if self.entries.is_empty() {
            // Half a number of the axis below may stand out.
            return 3.0 * style::MARGIN;
        }
        let words = font::widest(self.entries.iter().flat_map(|entry| &entry.lines), style::LABEL);
        GAP + SAMPLE + TO_WORDS + words + style::MARGIN
    }

    /// The height it needs.
    pub fn height(&self) -> f64 {
        let entries: f64 = self.entries.iter().map(Entry::height).sum();
        entries + BETWEEN * self.entries.len().saturating_sub(1) as f64
    }

    /// Adds the legend to a picture: right of the axes' upper right end, and down from there.
    pub fn add_to(&self, scene: &mut Scene, [right, mut top]: [f64; 2]) {
        let left = right + GAP;
        let mut words_of_all = vec![];
        for entry in &self.entries {
            let middle = top + entry.height() / 2.0;
            match &entry.sample {
                Sample::Series(look) => scene.elements.extend(series::sample(look, [left, middle], SAMPLE)),
                Sample::Band(ground) => scene.add(Primitive::Rect {
                    x: left,
                    y: middle - 9.0,
                    width: SAMPLE,
                    height: 18.0,
                    fill: colour(*ground),
                    stroke: None,
                    stroke_width: None,
                    opacity: None,
                }),
            }
            let at = [left + SAMPLE + TO_WORDS, top + font::DESCENT * style::LABEL];
            words_of_all.extend(words::block(&entry.lines, at, style::LABEL));
            top += entry.height() + BETWEEN;
        }
        scene.elements.extend(words_of_all);
    }
}

impl Entry {
    fn height(&self) -> f64 {
        words::block_height(&self.lines, style::LABEL) + font::DESCENT * style::LABEL
    }
}
