//! Heat maps and colour bars.

use super::axis::AxisRange;
use super::plane::{self, Plane};
use super::style;
use super::writer::{MIDDLE, Svg, box_attributes, escaped, stroke, tenths};
use super::{ChartAxis, HeatMap, Scale, font};
use std::collections::BTreeSet;
use stripmine_physics::number::{significant, with_power_of_ten};

/// Maximum length of a colour bar, and its thickness (pixels).
const BAR: f64 = 440.0;
const THICKNESS: f64 = 16.0;
/// Significant digits of a value in its cell.
const DIGITS: usize = 2;

pub(crate) fn draw(title: &str, map: &HeatMap) -> Result<Svg, String> {
    let [x, y] = [&map.x, &map.y].map(|axis| AxisRange::new(axis, std::iter::empty()));
    let (x, y) = (x?, y?);
    let shades = shade_axis(&map.value, map.rows.iter().flatten().copied().filter(|value| !value.is_nan()))?;
    let mut svg = Svg::new(title, style::WIDTH, 1.0);
    let planes = plane::draw(&mut svg, &x, &y, &[("", vec![])]);
    let plane = &planes[0];
    let heading = format!(" data-value=\"{}\"", escaped(&shades.heading));
    plane.fill(&mut svg, &heading, |svg| add_cells(svg, map, &shades, plane));
    add_cell_values(&mut svg, map, &shades, plane);
    add_colour_bar(&mut svg, &shades, 1.0);
    Ok(svg)
}

/// Returns the axis of the shades; without limits it spans exactly the values of the map.
fn shade_axis(axis: &ChartAxis, values: impl Iterator<Item = f64> + Clone) -> Result<AxisRange, String> {
    let [low, high] = [f64::min, f64::max].map(|it| values.clone().reduce(it).unwrap_or(f64::NAN));
    let is_exact = axis.limits.is_none() && low < high;
    if is_exact {
        AxisRange::new(&axis.clone().between([low, high]), values)
    } else {
        AxisRange::new(axis, values)
    }
}

/// Returns true if shades show a sign.
fn is_signed(shades: &AxisRange) -> bool {
    shades.scale == Scale::Linear && style::is_signed(shades.ends)
}

fn level(shades: &AxisRange, value: f64) -> u8 {
    style::level(shades.fraction_of(value), is_signed(shades))
}

/// Adds the cells of a map in units of cells. Cells of one colour are one path; adjacent cells in a row are one line as wide as a cell is
/// high. A line continues under cells of higher levels, which are painted later; this saves a fifth of the lines. Edges are not antialiased,
/// which would show as seams.
fn add_cells(svg: &mut Svg, map: &HeatMap, shades: &AxisRange, plane: &Plane) {
    // Rows from the top; 1 is the lowest level, 0 an empty cell.
    let level = |&value: &f64| if value.is_nan() { 0 } else { 1 + u32::from(level(shades, value)) };
    let rows: Vec<Vec<u32>> = map.rows.iter().rev().map(|row| row.iter().map(level).collect()).collect();
    let [across, down] = [plane.size[0] / rows[0].len() as f64, plane.size[1] / rows.len() as f64];
    // Lines run along the middle of the row.
    let [x, y] = [plane.corner[0], plane.corner[1] + 0.5 * down];
    svg.add(format_args!(
        "<g transform=\"translate({x:.2} {y:.2}) scale({across:.6} {down:.6})\" shape-rendering=\"crispEdges\">"
    ));
    let present: BTreeSet<u32> = rows.iter().flatten().copied().filter(|&level| level > 0).collect();
    for level in present {
        let (mut d, mut at) = (String::new(), [0, 0]);
        for (j, row) in (0..).zip(&rows) {
            let mut i = 0;
            // Between cells of lower levels, from the first to the last cell of this level.
            for free in row.split(|&other| other < level) {
                let ends =
                    [free.iter().position(|&it| it == level), free.iter().rposition(|&it| it == level)];
                if let [Some(first), Some(last)] = ends.map(|end| end.map(|end| i + end as i64)) {
                    let start = if d.is_empty() { 'M' } else { 'm' };
                    d += &format!("{start}{} {}h{}", first - at[0], j - at[1], last + 1 - first);
                    at = [last + 1, j];
                }
                i += free.len() as i64 + 1;
            }
        }
        let level = (level - 1) as u8;
        let part = f64::from(level % style::SHADES) / f64::from(style::SHADES - 1);
        let look = stroke(style::shade(level), 1.0);
        svg.named(&with_power_of_ten(shades.value(part), 3), |svg| svg.path(&look, &d));
    }
    svg.add("</g>");
}

/// Adds the values of a map if they fit into its cells.
fn add_cell_values(svg: &mut Svg, map: &HeatMap, shades: &AxisRange, plane: &Plane) {
    let text = |value: &f64| {
        if value.is_nan() { String::new() } else { with_power_of_ten(*value, DIGITS).replace('-', "−") }
    };
    let words: Vec<Vec<String>> = map.rows.iter().map(|row| row.iter().map(text).collect()).collect();
    let [across, up] = [plane.size[0] / words[0].len() as f64, plane.size[1] / words.len() as f64];
    let size = style::LABEL;
    if up < size * style::LINE_SPACING || font::widest(words.iter().flatten(), size) > 0.9 * across {
        return;
    }
    for (j, row) in words.iter().enumerate() {
        for (i, words) in row.iter().enumerate().filter(|(_, words)| !words.is_empty()) {
            let colour = style::ink_on(style::shade(level(shades, map.rows[j][i])));
            let right = plane.corner[0] + across * (i as f64 + 0.5);
            let down = plane.corner[1] + plane.size[1] - up * (j as f64 + 0.5);
            let look = format!("{MIDDLE} fill=\"{colour}\" pointer-events=\"none\"");
            svg.words([right, down + 0.5 * size * font::CAPITAL], size, &look, words);
        }
    }
}

/// Adds a colour bar below a picture, with a heading and tick marks; a short bar shows its ends and middle.
pub(crate) fn add_colour_bar(svg: &mut Svg, shades: &AxisRange, zoom: f64) {
    let [picture, top] = svg.size;
    let (size, margin, is_signed) = (style::LABEL * zoom, style::MARGIN * zoom, is_signed(shades));
    // Numbers at the ends extend beyond the bar.
    let width = (picture - 5.0 * margin).min(BAR * zoom);
    let (left, top, height) = (0.5 * (picture - width), top + margin, THICKNESS * zoom);
    let stop = |part| (part, style::shade(style::level(part, is_signed)));
    let stops = (0..=16).map(|stop| f64::from(stop) / 16.0).map(stop);
    let stops = stops.map(|(part, shade)| format!("<stop offset=\"{part}\" stop-color=\"{shade}\"/>"));
    let stops: String = stops.collect();
    let name = format!("shades{}", u8::from(is_signed));
    svg.define(format!("<linearGradient id=\"{name}\">{stops}</linearGradient>"));
    let place = box_attributes([left, top], [width, height]);
    svg.add(format_args!("<rect{place} fill=\"url(#{name})\"{}/>", stroke(style::INK, style::LINE * zoom)));
    let mut marks = shades.tick_marks(width, |label| font::width(label, size) + 2.0 * size);
    marks.retain(|(_, label)| !label.is_empty());
    if marks.len() < 3 {
        let number = |part| significant(shades.value(part), 3).replace('-', "−");
        marks = [0.0, 0.5, 1.0].map(|part| (part, number(part))).to_vec();
    }
    let (bottom, mut d) = (top + height, String::new());
    for (part, label) in marks {
        let x = left + part * width;
        d += &format!("M{} {}v{}", tenths(x), tenths(bottom), tenths(5.0 * zoom));
        svg.words([x, bottom + 7.0 * zoom + size * font::CAPITAL], size, MIDDLE, &label);
    }
    svg.path(&stroke(style::INK, style::LINE * zoom), &d);
    let lines = font::wrap(&shades.heading, size, picture - 2.0 * margin);
    let below = bottom + 7.0 * zoom + size * 1.3;
    svg.size[1] = svg.block(&lines, [0.5 * picture, below], size, MIDDLE) + margin;
}
