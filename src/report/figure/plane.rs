//! Planes between two axes, one or several side by side, with tick marks and headings.

use super::axis::{AxisRange, TickMark};
use super::writer::{END, MIDDLE, Svg, box_attributes, stroke, tenths};
use super::{Scale, font, style};

/// Length of a labelled mark, length of a small mark, and distance from a mark to its label (pixels).
const MARK: f64 = 6.0;
const SMALL_MARK: f64 = 3.0;
const TO_LABEL: f64 = 4.0;
/// Distance between planes, and between headings and labels (pixels).
const GAP: f64 = 14.0;
/// Distance between lines of words (pixels).
const LINE: f64 = style::LABEL * style::LINE_SPACING;

/// Plane between two axes.
pub(crate) struct Plane {
    /// Horizontal axis.
    pub x: AxisRange,
    /// Vertical axis.
    pub y: AxisRange,
    /// Upper left corner (pixels).
    pub corner: [f64; 2],
    /// Width and height (pixels).
    pub size: [f64; 2],
}

impl Plane {
    /// Returns the position of a point on the picture.
    pub(super) fn place(&self, x: f64, y: f64) -> [f64; 2] {
        let Plane { corner: [left, top], size: [width, height], .. } = self;
        [left + width * self.x.fraction_of(x), top + height * (1.0 - self.y.fraction_of(y))]
    }

    /// Adds elements clipped to the plane. `more` are further attributes.
    pub(super) fn fill(&self, svg: &mut Svg, more: &str, add: impl FnOnce(&mut Svg)) {
        let ([left, top], [width, height]) = (self.corner, self.size);
        let [x, y] = [self.x.described(left, left + width), self.y.described(top + height, top)];
        svg.window(self.corner, self.size);
        svg.add(format_args!("<g fill=\"none\" data-x=\"{x}\" data-y=\"{y}\"{more}>"));
        add(svg);
        svg.add("</g>\n</svg>");
    }

    /// Adds frame, grid and marks, and the labels of the axes in `shows`.
    fn axes(&self, svg: &mut Svg, [x_marks, y_marks]: [&[TickMark]; 2], shows: [bool; 2], is_turned: bool) {
        let ([left, top], [width, height], size) = (self.corner, self.size, style::LABEL);
        let (bottom, right, half) = (top + height, left + width, 0.5 * size * font::CAPITAL);
        let [mut grid, mut marks] = [String::new(), String::new()];
        let length = |label: &str| if label.is_empty() { SMALL_MARK } else { MARK };
        for (part, label) in x_marks {
            let (at, below) = (left + width * part, bottom + MARK + TO_LABEL);
            let x = tenths(at);
            marks += &format!("M{x} {bottom}v{}", length(label));
            match label.as_str() {
                "" => continue,
                _ if is_turned && shows[0] => svg.turned([at + half, below], -90, size, END, label),
                _ if shows[0] => svg.words([at, below + 2.0 * half], size, MIDDLE, label),
                _ => {}
            }
            grid += &format!("M{x} {bottom}V{top}");
        }
        for (part, label) in y_marks {
            let at = top + height * (1.0 - part);
            let y = tenths(at);
            marks += &format!("M{left} {y}h-{}", length(label));
            match label.as_str() {
                "" => continue,
                _ if shows[1] => svg.words([left - MARK - TO_LABEL, at + half], size, END, label),
                _ => {}
            }
            grid += &format!("M{left} {y}H{right}");
        }
        svg.path(&stroke(style::GRID, 1.0), &grid);
        svg.path(&stroke(style::INK, style::LINE), &marks);
        let frame = box_attributes(
            self.corner.map(|it| it - 0.5 * style::LINE),
            self.size.map(|it| it + style::LINE),
        );
        svg.add(format_args!("<rect fill=\"none\"{frame}{}/>", stroke(style::INK, style::LINE)));
    }
}

/// Words above a plane: its name, possibly empty, and labels with their positions as fractions of the x axis.
pub(crate) type PlaneHead<'a> = (&'a str, Vec<(f64, &'a str)>);

/// Places labels above a plane of a width without overlaps: row from below, middle and words of each.
fn rows<'a>(labels: &[(f64, &'a str)], width: f64) -> Vec<(usize, f64, &'a str)> {
    let mut ends: Vec<f64> = vec![];
    let place = |&(part, words): &(f64, _)| {
        let half = 0.5 * font::width(words, style::LABEL);
        let middle = (part * width).min(width - half).max(half);
        let row = ends.iter().position(|end| middle - half > *end).unwrap_or(ends.len());
        ends.resize(ends.len().max(row + 1), 0.0);
        ends[row] = middle + half + GAP;
        (row, middle, words)
    };
    labels.iter().map(place).collect()
}

/// Draws axes for a plane below each head, starting at the present height of the picture.
pub(crate) fn draw(svg: &mut Svg, x: &AxisRange, y: &AxisRange, heads: &[PlaneHead]) -> Vec<Plane> {
    let size = style::LABEL;
    let columns = [1, 1, 2, 3, 2].get(heads.len()).copied().unwrap_or(3);
    let height = match &y.scale {
        Scale::Names(names) => (30.0 * names.len() as f64).max(120.0),
        _ => [style::PLOT_HEIGHT, 230.0, 180.0][columns - 1],
    };
    let y_marks = y.tick_marks(height, |_| 2.0 * LINE);
    let widest = |marks: &[TickMark]| font::widest(marks.iter().map(|mark| &mark.1), size);
    let heading = font::wrap(&y.heading, size, height.max(style::PLOT_HEIGHT));
    // Planes are aligned to whole pixels.
    let left = style::MARGIN + LINE * heading.len() as f64 + widest(&y_marks) + TO_LABEL + MARK + TO_LABEL;
    let (left, begin) = (left.ceil(), svg.size[1].ceil());
    let gaps = GAP * (columns - 1) as f64;
    let width = |right: f64| ((style::WIDTH - left - right - gaps) / columns as f64).floor();
    let marks = |width| x.tick_marks(width, |label| (font::width(label, size) + 1.2 * size).max(3.5 * size));
    // Half of the last number extends beyond the axis.
    let is_named = matches!(x.scale, Scale::Names(_));
    let beyond = if is_named { 0.0 } else { 0.5 * widest(&marks(width(style::MARGIN))) };
    let width = width(style::MARGIN + beyond.min(2.5 * style::MARGIN));
    let x_marks = marks(width);
    let is_turned = is_named && widest(&x_marks) + 0.5 * size > width / x_marks.len() as f64;

    let names = heads.iter().map(|head| font::wrap(head.0, size, width)).collect::<Vec<_>>();
    let rows = heads.iter().map(|head| rows(&head.1, width)).collect::<Vec<_>>();
    let most_rows = rows.iter().flatten().map(|it| it.0 + 1).max().unwrap_or(0) as f64;
    let most_lines = names.iter().map(Vec::len).max().unwrap_or(0) as f64;
    let above = (LINE * (most_rows + most_lines) + 0.5 * GAP).ceil();
    let mut planes = vec![];
    for (i, (lines, rows)) in names.iter().zip(rows).enumerate() {
        let (column, row) = ((i % columns) as f64, (i / columns) as f64);
        let corner = [left + column * (width + GAP), begin + above + row * (above + height + GAP)];
        let plane = Plane { x: x.clone(), y: y.clone(), corner, size: [width, height] };
        let top = corner[1] - TO_LABEL - LINE * most_rows - font::height(lines.len(), size);
        svg.block(lines, [corner[0] + 0.5 * width, top], size, MIDDLE);
        for (row, middle, words) in rows {
            let base = corner[1] - 1.5 * TO_LABEL - LINE * row as f64;
            svg.words([corner[0] + middle, base], size, MIDDLE, words);
        }
        plane.axes(svg, [&x_marks, &y_marks], [i + columns >= names.len(), column == 0.0], is_turned);
        planes.push(plane);
    }
    let bottom = planes.iter().map(|plane| plane.corner[1] + height).fold(0.0, f64::max);
    let middle = 0.5 * (begin + above + bottom);
    for (i, line) in heading.iter().enumerate() {
        let base = style::MARGIN + size * font::CAPITAL + LINE * i as f64;
        svg.turned([base, middle], -90, size, MIDDLE, line);
    }
    let labels = if is_turned { widest(&x_marks) } else { size * font::CAPITAL };
    let heading = font::wrap(&x.heading, size, style::WIDTH - left);
    let middle = left + 0.5 * (gaps + width * columns as f64);
    svg.size[1] = svg.block(&heading, [middle, bottom + MARK + TO_LABEL + labels + GAP], size, MIDDLE);
    planes
}
