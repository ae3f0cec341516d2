//! What the curves, markers and hatchings of a chart mean, to the right of it.

use super::super::look::{Look, looks};
use super::super::sheet::{Anchor, Area, Mark, Place};
use super::super::{Along, Band, Chart, font, style};
use super::band::{band, ground};
use super::title;

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
    bands: Vec<Band>,
}

struct Entry {
    sample: Sample,
    lines: Vec<String>,
}

enum Sample {
    Series(Look),
    Band,
    Ground(usize),
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
        let bands = chart.bands.iter().enumerate().filter_map(|(i, band)| {
            let sample = if band.along == Along::Y { Sample::Ground(i) } else { Sample::Band };
            entry(sample, &band.label)
        });
        Legend { entries: series.chain(bands).collect(), bands: chart.bands.clone() }
    }

    /// The width it needs at the right of a chart, up to the edge of the sheet.
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

    /// The legend as marks, at the right of a chart.
    pub fn marks(&self, plot: &Area) -> Vec<Mark> {
        let left = plot.right() + GAP;
        let mut top = plot.top;
        let mut marks = Vec::new();
        for entry in &self.entries {
            let middle = top + entry.height() / 2.0;
            match &entry.sample {
                Sample::Series(look) => marks.extend(look.sample([left, middle], SAMPLE)),
                Sample::Band | Sample::Ground(_) => {
                    let area = Area { left, top: middle - 9.0, width: SAMPLE, height: 18.0 };
                    match entry.sample {
                        Sample::Ground(number) => marks.push(ground(&area, &self.bands, number)),
                        _ => marks.extend(band(&area)),
                    }
                }
            }
            let words: Place = [left + SAMPLE + TO_WORDS, top + font::DESCENT * style::LABEL];
            marks.extend(title::block(&entry.lines, words[0], words[1], Anchor::Start, style::LABEL));
            top += entry.height() + BETWEEN;
        }
        marks
    }
}

impl Entry {
    fn height(&self) -> f64 {
        title::block_height(&self.lines, style::LABEL) + font::DESCENT * style::LABEL
    }
}
