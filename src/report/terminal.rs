//! Tables for a terminal. Numbers and words are never broken; if a table does not fit, its rows become records.

use super::{FormattedTable, TableCell};
use comfy_table::presets::UTF8_HORIZONTAL_ONLY;
use comfy_table::{CellAlignment, ColumnConstraint, ContentArrangement, LineStyle, Width};

/// Default width in characters.
const PAGE: usize = 100;
/// Width in characters that fits into any terminal.
pub(crate) const NARROW: usize = 80;
/// Padding of a table column: a blank on either side.
const BESIDE: usize = 2;
/// Minimum width in characters.
const NARROWEST: usize = 20;

/// Renders a table, no wider than the environment variable `COLUMNS` or the terminal.
pub(crate) fn render(table: &FormattedTable) -> String {
    render_within(table, width())
}

/// Renders a table as [`render`] does, within 80 characters if neither limits it.
pub(crate) fn render_narrow(table: &FormattedTable) -> String {
    render_within(table, width().or(Some(NARROW)))
}

/// Width in characters, from `COLUMNS` or the terminal; `None` without either.
fn width() -> Option<usize> {
    let said = std::env::var("COLUMNS").ok().and_then(|columns| columns.parse().ok());
    let of_terminal = || comfy_table::Table::new().width().map(usize::from);
    said.filter(|&columns| columns > 0).or_else(of_terminal).map(columns)
}

/// Usable width of a terminal that reports a number of columns. The terminals of launchers report 0.
fn columns(reported: usize) -> usize {
    if reported == 0 { PAGE } else { reported.max(NARROWEST) }
}

/// Wraps the lines of a message at blanks to the width of the terminal.
pub(crate) fn wrap_message(message: &str) -> String {
    wrap_message_within(message, width())
}

fn wrap_message_within(message: &str, width: Option<usize>) -> String {
    let Some(width) = width else { return message.to_owned() };
    let one = |line: &str| match line.chars().count() > width {
        true => wrap_paragraph(line, width).trim_end().to_owned(),
        false => line.to_owned(),
    };
    message.lines().map(one).collect::<Vec<_>>().join("\n")
}

/// Renders a table within a number of columns, or without a limit.
pub(crate) fn render_within(table: &FormattedTable, width: Option<usize>) -> String {
    let rows: Vec<Vec<String>> =
        table.rows.iter().map(|row| row.iter().map(TableCell::formatted_text).collect()).collect();
    let least: Vec<usize> = (0..table.columns.len())
        .map(|column| {
            let cells = rows.iter().filter_map(|row| row.get(column));
            cells.chain(table.columns.get(column)).map(|text| longest_word(text)).max().unwrap_or(0)
        })
        .collect();
    let narrowest: usize = least.iter().map(|least| least + BESIDE).sum();
    let page = width.unwrap_or(PAGE);
    let mut text = wrap_paragraph(&table.title, page);
    text += &match width {
        Some(width) if narrowest > width => records(table, &rows, width),
        _ => draw_table(table, rows, &least, width) + "\n",
    };
    table.notes.iter().for_each(|note| text += &wrap_paragraph(note, page));
    text
}

fn longest_word(text: &str) -> usize {
    text.split(' ').map(|word| word.chars().count()).max().unwrap_or(0)
}

fn draw_table(
    table: &FormattedTable,
    rows: Vec<Vec<String>>,
    least: &[usize],
    width: Option<usize>,
) -> String {
    let mut drawn = comfy_table::Table::new();
    // Rules around the table and below the headings, none between rows.
    drawn.load_style(UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none())).set_content_arrangement(
        match width {
            Some(_) => ContentArrangement::Dynamic,
            None => ContentArrangement::Disabled,
        },
    );
    if let Some(width) = width {
        drawn.set_width(width.min(u16::MAX.into()) as u16);
    }
    drawn.set_header(&table.columns);
    for (cells, row) in table.rows.iter().zip(rows) {
        drawn.add_row(cells.iter().zip(row).map(|(cell, text)| {
            let side = if cell.is_number() { CellAlignment::Right } else { CellAlignment::Left };
            comfy_table::Cell::new(text).set_alignment(side)
        }));
    }
    for (column, least) in drawn.column_iter_mut().zip(least) {
        column.set_constraint(ColumnConstraint::LowerBoundary(Width::Fixed((least + BESIDE) as u16)));
    }
    drawn.to_string()
}

/// Renders rows as records: one line for each cell, named by its column; a blank line between rows.
fn records(table: &FormattedTable, rows: &[Vec<String>], width: usize) -> String {
    let one = |row: &Vec<String>| {
        let lines = table.columns.iter().zip(row).filter(|(_, text)| !text.is_empty());
        lines.map(|(column, text)| wrap_paragraph(&format!("  {column}: {text}"), width)).collect::<String>()
    };
    rows.iter().map(one).collect::<Vec<_>>().join("\n")
}

/// Wraps a paragraph at blanks; a longer word is not broken.
fn wrap_paragraph(text: &str, width: usize) -> String {
    let indent = text.chars().take_while(|c| *c == ' ').count();
    let (mut lines, mut line) = (String::new(), " ".repeat(indent));
    let mut is_empty = true;
    for word in text.split(' ').filter(|word| !word.is_empty()) {
        if !is_empty && line.chars().count() + 1 + word.chars().count() > width {
            lines += &line;
            lines.push('\n');
            line = " ".repeat(if indent > 0 { indent + 2 } else { 0 });
            is_empty = true;
        }
        if !is_empty {
            line.push(' ');
        }
        line += word;
        is_empty = false;
    }
    lines + &line + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> FormattedTable {
        let columns =
            ["integrator", "steps of an orbit", "largest error of the energy", "processor time (s)"];
        let row = |name: &str, steps: u64| {
            vec![
                TableCell::Text(name.into()),
                TableCell::Count(steps),
                TableCell::Number(123_456.789, 3),
                TableCell::Nothing,
            ]
        };
        FormattedTable {
            name: "t".into(),
            title: "Errors of integrators over the steps of an orbit and their cost on this host".into(),
            columns: columns.map(str::to_owned).to_vec(),
            rows: vec![row("damped-euler", 1_234_567), row("yoshida-8", 64)],
            notes: vec![
                "A note that is longer than a narrow terminal is wide, and is broken at blanks.".into(),
            ],
        }
    }

    #[test]
    fn long_messages_are_wrapped_at_blanks() {
        let message = "error: a scene that cannot be\n  expected: dt below 0.0083249 (time), or slower discs\n    ^ here";
        let text = wrap_message_within(message, Some(30));
        assert!(text.lines().all(|line| line.chars().count() <= 30), "{text}");
        assert!(text.contains("0.0083249") && text.ends_with("\n    ^ here"), "{text}");
        assert_eq!(wrap_message_within(message, None), message);
    }

    /// At any width every number and every word of a heading is unbroken, and no line is wider than requested.
    #[test]
    fn no_word_is_broken_at_any_width() {
        for width in [20, 30, 45, 60, 80, 100, 120] {
            let text = render_within(&table(), Some(width));
            for whole in ["1\u{202f}234\u{202f}567", "123\u{202f}456.789", "damped-euler", "processor"] {
                assert!(text.contains(whole), "{width}: {text}");
            }
            let widest = text.lines().map(|line| line.chars().count()).max().unwrap();
            assert!(widest <= width.max(24), "{width}: {widest}\n{text}");
        }
        let unbound = render_within(&table(), None);
        assert!(unbound.lines().any(|line| line.contains("largest error of the energy")), "{unbound}");
    }

    #[test]
    fn a_terminal_without_columns_has_the_default_width() {
        assert_eq!([0, 1, 20, 79, 300].map(columns), [PAGE, NARROWEST, 20, 79, 300]);
    }

    #[test]
    fn rows_of_wide_tables_become_records() {
        let text = render_within(&table(), Some(30));
        assert!(
            text.contains("  integrator: damped-euler\n") && text.contains("\n\n  integrator: yoshida-8")
        );
        assert!(render_within(&table(), Some(100)).contains('═'));
    }
}
