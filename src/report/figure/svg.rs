//! A figure as a vector picture: numbers to a hundredth of a pixel, nothing that changes from run to run.

use super::sheet::{Anchor, Area, Mark, Paint, Place, Sheet, Stroke};
use super::style::Colour;
use super::{Figure, FigureError, layout, style};
use std::collections::BTreeMap;
use std::fmt::{self, Write};

/// Draws a figure as SVG.
///
/// # Errors
/// When the figure cannot be drawn.
pub fn svg(figure: &Figure) -> Result<String, FigureError> {
    let Sheet { width, height, marks } = layout::sheet(figure)?;
    let (w, h) = (Decimal(width), Decimal(height));
    let (title, caption) = (Escaped(&figure.title), Escaped(&figure.caption));
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" role=\"img\" \
         font-family=\"{}\" stroke-linejoin=\"round\">\n<title>{title}</title>\n<desc>{caption}</desc>\n\
         <rect width=\"{w}\" height=\"{h}\" fill=\"{}\"/>\n",
        style::FONTS,
        style::PAPER
    );
    write_marks(&mut out, &marks);
    out.push_str("</svg>\n");
    Ok(out)
}

/// Marks from back to front; what looks alike and follows each other is written together.
fn write_marks(out: &mut String, marks: &[Mark]) {
    for alike in marks.chunk_by(|a, b| kind(a).is_some_and(|own| Some(own) == kind(b))) {
        let own = attributes(&alike[0]).unwrap_or_default();
        match (alike, kind(&alike[0])) {
            ([mark], _) => write_mark(out, mark, &own),
            (discs, Some(Kind::Discs(outline))) => write_discs(out, discs, outline),
            _ => {
                let _ = writeln!(out, "<g{own}>");
                alike.iter().for_each(|mark| write_mark(out, mark, ""));
                out.push_str("</g>\n");
            }
        }
    }
}

/// Which marks may be written together.
#[derive(PartialEq)]
enum Kind {
    /// Filled discs with one outline, whatever their colours.
    Discs(Option<Stroke>),
    /// Marks with the same attributes.
    Of(String),
}

fn kind(mark: &Mark) -> Option<Kind> {
    match mark {
        Mark::Disc { paint: Paint { fill: Some(_), stroke }, .. } => Some(Kind::Discs(*stroke)),
        _ => attributes(mark).map(Kind::Of),
    }
}

/// What a mark may have in common with others; none for those that stand alone.
fn attributes(mark: &Mark) -> Option<String> {
    match mark {
        Mark::Lines { paint, .. } | Mark::Disc { paint, .. } => Some(Attributes(paint).to_string()),
        Mark::Words { size, colour, .. } => {
            Some(format!(" font-size=\"{}\" fill=\"{colour}\"", Decimal(*size)))
        }
        Mark::Cells { .. } | Mark::Window { .. } => None,
    }
}

/// Filled discs; which of them is in front makes no difference. Outlines are larger discs behind all of them.
fn write_discs(out: &mut String, discs: &[Mark], outline: Option<Stroke>) {
    let rim = outline.map_or(0.0, |stroke| stroke.width);
    if let Some(Stroke { colour, .. }) = outline {
        write_dots(out, discs, |_| colour, rim);
    }
    write_dots(out, discs, |fill| fill, -rim);
}

/// Discs as dots, to a tenth of a pixel, their diameters changed by `rim`. Those of one colour and diameter are the round ends of the shortest lines
/// of that width.
fn write_dots(out: &mut String, discs: &[Mark], colour: impl Fn(Colour) -> Colour, rim: f64) {
    let mut paths: BTreeMap<(String, i64), Vec<Vec<Place>>> = BTreeMap::new();
    for mark in discs {
        if let Mark::Disc { centre: [x, y], radius, paint: Paint { fill: Some(fill), .. } } = mark {
            // Some viewers show nothing of a line without a length.
            let [x, y, diameter] = [*x, *y, 2.0 * radius + rim].map(|pixels| (10.0 * pixels).round() / 10.0);
            let line = vec![[x, y], [x + SHORTEST, y]];
            let alike = (colour(*fill).to_string(), hundredths(diameter));
            paths.entry(alike).or_default().push(line);
        }
    }
    out.push_str("<g fill=\"none\" stroke-linecap=\"round\">\n");
    for ((colour, diameter), pieces) in paths {
        let (path, width) = (Course { pieces: &pieces, closed: false }, Decimal(diameter as f64 / 100.0));
        let _ = writeln!(out, "<path stroke=\"{colour}\" stroke-width=\"{width}\" d=\"{path}\"/>");
    }
    out.push_str("</g>\n");
}

/// The length of a line that is a dot (pixels).
const SHORTEST: f64 = 0.1;

/// A mark with these attributes.
fn write_mark(out: &mut String, mark: &Mark, attributes: &str) {
    let _ = match mark {
        Mark::Lines { pieces, closed, .. } => {
            writeln!(out, "<path d=\"{}\"{attributes}/>", Course { pieces, closed: *closed })
        }
        Mark::Disc { centre: [x, y], radius, .. } => {
            let [x, y, r] = [*x, *y, *radius].map(Decimal);
            writeln!(out, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\"{attributes}/>")
        }
        Mark::Words { at, anchor, upwards, words, .. } => {
            let [x, y] = at.map(Decimal);
            let anchor = match anchor {
                Anchor::Start => "",
                Anchor::Middle => " text-anchor=\"middle\"",
                Anchor::End => " text-anchor=\"end\"",
            };
            let turn = if *upwards { format!(" transform=\"rotate(-90 {x} {y})\"") } else { String::new() };
            let words = Escaped(words);
            writeln!(out, "<text x=\"{x}\" y=\"{y}\"{anchor}{attributes}{turn}>{words}</text>")
        }
        Mark::Cells { area, columns, levels } => write_cells(out, *area, *columns, levels),
        Mark::Window { area, marks } => {
            let [x, y, w, h] = [area.left, area.top, area.width, area.height].map(Decimal);
            // A picture within the picture cuts off what is outside of it, and needs no name that might be taken.
            let _ = writeln!(
                out,
                "<svg x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" viewBox=\"{x} {y} {w} {h}\" \
                 preserveAspectRatio=\"none\">"
            );
            write_marks(out, marks);
            writeln!(out, "</svg>")
        }
    };
}

/// Cells of one shade are one path, neighbours in a row one line of it, as wide as a cell is high; in units of cells.
fn write_cells(out: &mut String, area: Area, columns: usize, levels: &[u8]) -> fmt::Result {
    let mut paths = vec![vec![]; 1 + usize::from(*style::levels(true).end())];
    for (j, row) in levels.chunks(columns).enumerate() {
        let mut i = 0;
        for run in row.chunk_by(|a, b| a == b) {
            let end = i + run.len();
            paths[usize::from(run[0])].push([i, end].map(|i| [i as f64, j as f64]).to_vec());
            i = end;
        }
    }
    let rows = levels.len() / columns;
    let [across, down] = [area.width / columns as f64, area.height / rows as f64];
    // Lines run along the middle of their row.
    let [x, y] = [area.left, area.top + 0.5 * down].map(Decimal);
    writeln!(
        out,
        "<g transform=\"translate({x} {y}) scale({across:.6} {down:.6})\" shape-rendering=\"crispEdges\" fill=\"none\">"
    )?;
    for (level, pieces) in
        (0..=*style::levels(true).end()).zip(&paths).filter(|(_, pieces)| !pieces.is_empty())
    {
        let path = Course { pieces, closed: false };
        writeln!(out, "<path stroke=\"{}\" d=\"{path}\"/>", style::shade(level))?;
    }
    writeln!(out, "</g>")
}

/// A number in hundredths.
fn hundredths(number: f64) -> i64 {
    (number * 100.0).round() as i64
}

/// A number to a hundredth, without needless zeros.
struct Decimal(f64);

impl fmt::Display for Decimal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let hundredths = hundredths(self.0);
        let text = format!("{}.{:02}", hundredths.unsigned_abs() / 100, hundredths.unsigned_abs() % 100);
        let text = text.trim_end_matches('0').trim_end_matches('.');
        write!(f, "{}{text}", if hundredths < 0 { "-" } else { "" })
    }
}

/// Lines in the words of a path: each place seen from the one before, in whole hundredths, so that nothing adds up.
struct Course<'a> {
    pieces: &'a [Vec<Place>],
    closed: bool,
}

impl fmt::Display for Course<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut at = [0, 0];
        for (i, piece) in self.pieces.iter().enumerate() {
            let mut places = piece.iter().map(|place| place.map(hundredths));
            let Some(first) = places.next() else { continue };
            let [x, y] = [first[0] - at[0], first[1] - at[1]];
            write!(f, "{}{}{}", if i == 0 { 'M' } else { 'm' }, Step::first(x), Step::next(y))?;
            at = first;
            let mut goes_on = false;
            for place in places {
                let [x, y] = [place[0] - at[0], place[1] - at[1]];
                match (x, y) {
                    (x, 0) => write!(f, "h{}", Step::first(x))?,
                    (0, y) => write!(f, "v{}", Step::first(y))?,
                    (x, y) if goes_on => write!(f, "{}{}", Step::next(x), Step::next(y))?,
                    (x, y) => write!(f, "l{}{}", Step::first(x), Step::next(y))?,
                }
                goes_on = x != 0 && y != 0;
                at = place;
            }
            if self.closed {
                f.write_char('Z')?;
                at = first;
            }
        }
        Ok(())
    }
}

/// A number of hundredths in a path, parted from a number before it by a blank or by its sign.
struct Step {
    hundredths: i64,
    parted: bool,
}

impl Step {
    /// After a letter.
    fn first(hundredths: i64) -> Step {
        Step { hundredths, parted: false }
    }

    /// After a number.
    fn next(hundredths: i64) -> Step {
        Step { hundredths, parted: true }
    }
}

impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = Decimal(self.hundredths as f64 / 100.0).to_string();
        let (sign, digits) = text.strip_prefix('-').map_or(("", text.as_str()), |digits| ("-", digits));
        // No zero before the point.
        let digits = digits.strip_prefix('0').filter(|rest| !rest.is_empty()).unwrap_or(digits);
        let blank = if self.parted && sign.is_empty() { " " } else { "" };
        write!(f, "{blank}{sign}{digits}")
    }
}

struct Attributes<'a>(&'a Paint);

impl fmt::Display for Attributes<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0.fill {
            Some(colour) => write!(f, " fill=\"{colour}\"")?,
            None => write!(f, " fill=\"none\"")?,
        }
        if let Some(stroke) = self.0.stroke {
            write!(f, " stroke=\"{}\" stroke-width=\"{}\"", stroke.colour, Decimal(stroke.width))?;
            if !stroke.dash.is_empty() {
                let dash: Vec<_> = stroke.dash.iter().map(|&part| Decimal(part).to_string()).collect();
                write!(f, " stroke-dasharray=\"{}\"", dash.join(" "))?;
            }
        }
        Ok(())
    }
}

/// Words with the signs that mean something in XML spelled out; those it has no place for are blanks.
struct Escaped<'a>(&'a str);

impl fmt::Display for Escaped<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for letter in self.0.chars() {
            match letter {
                '&' => f.write_str("&amp;")?,
                '<' => f.write_str("&lt;")?,
                '>' => f.write_str("&gt;")?,
                '\u{fffe}' | '\u{ffff}' => f.write_char(' ')?,
                control if control.is_control() => f.write_char(' ')?,
                other => f.write_char(other)?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::samples;
    use super::*;

    #[test]
    fn numbers_are_short_and_never_minus_zero() {
        let texts = [0.0, -0.001, 12.0, 12.5, -4.56789, 0.07, 1e5].map(|x| Decimal(x).to_string());
        assert_eq!(texts, ["0", "0", "12", "12.5", "-4.57", "0.07", "100000"]);
    }

    #[test]
    fn the_same_figure_gives_the_same_bytes() {
        for figure in samples::all() {
            assert_eq!(svg(&figure).unwrap(), svg(&figure.clone()).unwrap());
        }
    }

    #[test]
    fn words_cannot_break_out() {
        let mut figure = samples::linear();
        figure.title = "</text><script>1 & 2\u{1}".into();
        let text = svg(&figure).unwrap();
        assert!(!text.contains("<script>") && text.contains("&lt;script&gt;1 &amp; 2"));
        assert!(!text.contains('\u{1}'));
    }

    #[test]
    fn cells_of_one_shade_are_one_path() {
        let mut out = String::new();
        let area = Area { left: 10.0, top: 20.0, width: 6.0, height: 4.0 };
        write_cells(&mut out, area, 3, &[7, 7, 0, 7, 0, 0]).unwrap();
        assert!(out.contains("translate(10 21) scale(2.000000 2.000000)"));
        assert!(out.contains("M0 0h2m-2 1h1\""), "{out}");
        assert!(out.contains("M2 0h1m-2 1h2\""), "{out}");
    }

    #[test]
    fn paths_go_from_place_to_place() {
        let path = |pieces: &[Vec<Place>], closed| Course { pieces, closed }.to_string();
        let bar = vec![[10.0, 2.5], [10.0, 7.0], [10.25, 6.0], [9.75, 6.5], [12.0, 6.5]];
        assert_eq!(path(std::slice::from_ref(&bar), false), "M10 2.5v4.5l.25-1-.5 .5h2.25");
        assert_eq!(
            path(&[bar.clone(), vec![[1.0, 1.0], [2.0, 2.0]]], true),
            "M10 2.5v4.5l.25-1-.5 .5h2.25Zm-9-1.5l1 1Z"
        );
        // Roundings do not add up.
        let thirds: Vec<Place> = (0..=300).map(|i| [f64::from(i) / 3.0, f64::from(i % 2)]).collect();
        let text = path(&[thirds], false);
        let steps = text.split(['M', 'l', ' ', '-']).filter_map(|step| step.parse::<f64>().ok());
        assert!((steps.sum::<f64>() - 100.0 - 300.0).abs() < 1e-9, "{text}");
    }

    #[test]
    fn marks_that_are_painted_alike_are_written_together() {
        let disc = |x: f64, radius: f64, stroke: bool| {
            let stroke = stroke.then_some(Stroke { colour: style::PAPER, width: 1.0, dash: &[] });
            Mark::Disc { centre: [x, 5.0], radius, paint: Paint { fill: Some(style::PAPER), stroke } }
        };
        let discs =
            [1.5, 1.25, 1.5].into_iter().zip(1..).map(|(radius, x)| disc(f64::from(x), radius, false));
        let mut out = String::new();
        write_marks(&mut out, &discs.chain([disc(7.0, 1.0, true), disc(8.0, 1.5, true)]).collect::<Vec<_>>());
        // Discs of one colour and size are one path; outlines are larger discs behind them.
        for path in [
            "stroke-width=\"3\" d=\"M1 5h.1m1.9 0h.1\"/>",
            "stroke-width=\"2.5\" d=\"M2 5h.1\"/>",
            "stroke-width=\"4\" d=\"M8 5h.1\"/>\n</g>\n<g",
            "stroke-width=\"1\" d=\"M7 5h.1\"/>",
        ] {
            assert!(out.contains(path), "{path}: {out}");
        }
    }
}
