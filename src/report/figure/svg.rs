//! A figure as a vector picture: numbers to a hundredth of a pixel, nothing that changes from run to run.

use super::sheet::{Anchor, Area, Mark, Paint, Place, Sheet};
use super::{Figure, FigureError, layout, style};
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
    for mark in &marks {
        write_mark(&mut out, mark);
    }
    out.push_str("</svg>\n");
    Ok(out)
}

fn write_mark(out: &mut String, mark: &Mark) {
    let _ = match mark {
        Mark::Lines { pieces, closed, paint } => {
            writeln!(out, "<path d=\"{}\"{}/>", Course { pieces, closed: *closed }, Attributes(paint))
        }
        Mark::Disc { centre: [x, y], radius, paint } => {
            let [x, y, r] = [*x, *y, *radius].map(Decimal);
            writeln!(out, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\"{}/>", Attributes(paint))
        }
        Mark::Words { at, anchor, upwards, size, colour, words } => {
            let [x, y] = at.map(Decimal);
            let anchor = match anchor {
                Anchor::Start => "start",
                Anchor::Middle => "middle",
                Anchor::End => "end",
            };
            let turn = if *upwards { format!(" transform=\"rotate(-90 {x} {y})\"") } else { String::new() };
            writeln!(
                out,
                "<text x=\"{x}\" y=\"{y}\" font-size=\"{}\" text-anchor=\"{anchor}\" fill=\"{colour}\"{turn}>{}</text>",
                Decimal(*size),
                Escaped(words)
            )
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
            for mark in marks {
                write_mark(out, mark);
            }
            writeln!(out, "</svg>")
        }
    };
}

/// Cells of one shade are one path, neighbours in a row one box of it, in units of cells.
fn write_cells(out: &mut String, area: Area, columns: usize, levels: &[u8]) -> fmt::Result {
    let mut paths = vec![String::new(); usize::from(style::SHADES)];
    for (j, row) in levels.chunks(columns).enumerate() {
        let mut i = 0;
        for run in row.chunk_by(|a, b| a == b) {
            let path = &mut paths[usize::from(run[0])];
            write!(path, "M{i} {j}h{n}v1h-{n}z", n = run.len())?;
            i += run.len();
        }
    }
    let [x, y] = [area.left, area.top].map(Decimal);
    let rows = levels.len() / columns;
    let [across, down] = [area.width / columns as f64, area.height / rows as f64];
    writeln!(
        out,
        "<g transform=\"translate({x} {y}) scale({across:.6} {down:.6})\" shape-rendering=\"crispEdges\">"
    )?;
    for (level, path) in (0..style::SHADES).zip(&paths).filter(|(_, path)| !path.is_empty()) {
        writeln!(out, "<path fill=\"{}\" d=\"{path}\"/>", style::shade(level))?;
    }
    writeln!(out, "</g>")
}

/// A number to a hundredth, without needless zeros.
struct Decimal(f64);

impl fmt::Display for Decimal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let hundredths = (self.0 * 100.0).round() as i64;
        let text = format!("{}.{:02}", hundredths.unsigned_abs() / 100, hundredths.unsigned_abs() % 100);
        let text = text.trim_end_matches('0').trim_end_matches('.');
        write!(f, "{}{text}", if hundredths < 0 { "-" } else { "" })
    }
}

/// Lines in the words of a path.
struct Course<'a> {
    pieces: &'a [Vec<Place>],
    closed: bool,
}

impl fmt::Display for Course<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for piece in self.pieces {
            for (i, place) in piece.iter().enumerate() {
                let [x, y] = place.map(Decimal);
                write!(f, "{}{x} {y}", if i == 0 { 'M' } else { 'L' })?;
            }
            if self.closed {
                f.write_char('Z')?;
            }
        }
        Ok(())
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
        assert!(out.contains("translate(10 20) scale(2.000000 2.000000)"));
        assert!(out.contains("M0 0h2v1h-2zM0 1h1v1h-1z"), "{out}");
        assert!(out.contains("M2 0h1v1h-1zM1 1h2v1h-2z"), "{out}");
    }
}
