//! Tables and texts for a terminal, or for a pipe, which has the width of a page. Numbers and words are never broken. A table that is too wide
//! is printed in blocks of columns, each with the columns that name a row; a single row becomes a record.

use super::{FormattedTable, TableCell};
use comfy_table::{Cell, CellAlignment, ColumnConstraint, ContentArrangement, LineStyle, TableStyle, Width};

/// Width in characters where neither the environment nor a terminal gives one.
const PAGE: usize = 100;
/// Width in characters that fits into any terminal.
pub(crate) const NARROW: usize = 80;
/// Padding of a table column: a blank on either side.
pub(crate) const BESIDE: usize = 2;
/// Minimum width in characters.
const NARROWEST: usize = 20;
/// Width in characters that a column of words gets in a block, if its text is that long.
const COMFORTABLE: usize = 28;
/// A rule below the headings, nothing between columns. Rules above and below a table are drawn here: those of the library have gaps.
const RULE: TableStyle = TableStyle::new().header_separator(LineStyle::none().fill('═'));

/// Renders a table, no wider than the environment variable `COLUMNS`, the terminal, or a page.
pub(crate) fn render(table: &FormattedTable) -> String {
    render_within(table, page_width())
}

/// Width of tables and texts on standard output (characters).
fn page_width() -> usize {
    width().unwrap_or(PAGE)
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

/// Wraps the lines of a message to the width of the terminal, if there is one: programs read messages a line at a time.
pub(crate) fn wrap_message(message: &str) -> String {
    width().map_or_else(|| message.to_owned(), |width| wrap_lines(message, width).trim_end().to_owned())
}

/// Wraps the lines of a text for standard output; continued lines are indented.
pub(crate) fn wrap_text(text: &str) -> String {
    wrap_lines(text, page_width())
}

/// Wraps paragraphs for standard output.
pub(crate) fn wrap_prose(text: &str) -> String {
    text.lines().map(|line| wrap_paragraph(line, page_width(), 0)).collect()
}

fn wrap_lines(text: &str, width: usize) -> String {
    let one = |line: &str| match line.chars().count() > width {
        true => wrap_paragraph(line, width, HANGING),
        false => format!("{line}\n"),
    };
    text.lines().map(one).collect()
}

/// Further indentation of continued lines.
const HANGING: usize = 2;

/// Column of a table as text.
struct TextColumn<'t> {
    heading: &'t str,
    cells: Vec<String>,
    is_number: bool,
    /// Width of the longest word, and of the longest text, each with its padding (characters).
    least: usize,
    natural: usize,
}

impl<'t> TextColumn<'t> {
    fn of(table: &'t FormattedTable, place: usize) -> TextColumn<'t> {
        let heading = table.columns[place].as_str();
        let cells = || table.rows.iter().filter_map(move |row| row.get(place));
        let texts: Vec<String> = cells().map(TableCell::formatted_text).collect();
        let widest = |of: fn(&str) -> usize| {
            texts.iter().map(String::as_str).chain([heading]).map(of).max().unwrap_or(0) + BESIDE
        };
        let (least, natural) = (widest(longest_word), widest(|text| text.chars().count()));
        let is_number = cells().all(TableCell::is_number);
        TextColumn { heading, cells: texts, is_number, least, natural }
    }

    /// Width that the column gets in a block (characters): words are more than a word a line.
    fn wanted(&self) -> usize {
        if self.is_number { self.least } else { self.natural.min(COMFORTABLE).max(self.least) }
    }
}

/// Renders a table within a number of columns.
pub(crate) fn render_within(table: &FormattedTable, width: usize) -> String {
    let columns: Vec<TextColumn> = (0..table.columns.len()).map(|at| TextColumn::of(table, at)).collect();
    let mut text = wrap_paragraph(&table.title, width, 0);
    match blocks(&columns, width) {
        Some(blocks) if blocks.len() == 1 || table.rows.len() > 1 => {
            for (at, block) in blocks.iter().enumerate() {
                text += &draw(block, table.rows.len(), width, at + 1 == blocks.len());
            }
        }
        _ => text += &records(&columns, table.rows.len(), width),
    }
    table.notes.iter().for_each(|note| text += &wrap_paragraph(note, width, 0));
    text
}

/// Blocks of columns that fit into a width: all in one, or each with the columns that name a row. None if a column does not fit beside these.
fn blocks<'c, 't>(columns: &'c [TextColumn<'t>], width: usize) -> Option<Vec<Vec<&'c TextColumn<'t>>>> {
    if columns.iter().map(|column| column.least).sum::<usize>() <= width {
        return Some(vec![columns.iter().collect()]);
    }
    let words = columns.iter().take_while(|column| !column.is_number).count();
    // In a table of words only the first column names a row.
    let mut names = &columns[..if words < columns.len() { words.max(1) } else { 1 }];
    let taken = |names: &[TextColumn]| names.iter().map(TextColumn::wanted).sum::<usize>();
    while names.len() > 1 && taken(names) > width / 2 {
        names = &names[..names.len() - 1];
    }
    let (mut blocks, mut left): (Vec<Vec<&TextColumn>>, usize) = (vec![], 0);
    for column in &columns[names.len()..] {
        if column.wanted() > left {
            left = width.checked_sub(taken(names)).filter(|&room| room >= column.wanted())?;
            blocks.push(names.iter().collect());
        }
        left -= column.wanted();
        blocks.last_mut()?.push(column);
    }
    Some(blocks)
}

/// Width of a table without broken lines (characters).
pub(crate) fn width_of(table: &FormattedTable) -> usize {
    (0..table.columns.len()).map(|at| TextColumn::of(table, at).natural).sum()
}

fn longest_word(text: &str) -> usize {
    text.split(' ').map(|word| word.chars().count()).max().unwrap_or(0)
}

/// Draws columns side by side, with a rule below if they are the last.
fn draw(columns: &[&TextColumn], rows: usize, width: usize, is_last: bool) -> String {
    let mut drawn = comfy_table::Table::new();
    drawn.load_style(RULE).set_content_arrangement(ContentArrangement::Dynamic);
    drawn.set_width(width.min(u16::MAX.into()) as u16);
    let aligned = |text: &str, is_number: bool| {
        Cell::new(text).set_alignment(if is_number { CellAlignment::Right } else { CellAlignment::Left })
    };
    drawn.set_header(columns.iter().map(|column| aligned(column.heading, column.is_number)));
    for row in 0..rows {
        // Words among numbers are aligned with these.
        drawn.add_row(columns.iter().map(|column| aligned(&column.cells[row], column.is_number)));
    }
    for (column, text) in drawn.column_iter_mut().zip(columns) {
        column.set_constraint(ColumnConstraint::LowerBoundary(Width::Fixed(text.least as u16)));
    }
    let lines: Vec<String> = drawn.lines().collect();
    let rule = "─".repeat(lines.first().map_or(0, |line| line.chars().count()));
    let below = is_last.then_some(rule.clone());
    [rule].into_iter().chain(lines).chain(below).map(|line| line.trim_end().to_owned() + "\n").collect()
}

/// Renders rows as records: one line for each cell, named by its column; a blank line between rows.
fn records(columns: &[TextColumn], rows: usize, width: usize) -> String {
    let one = |row: usize| {
        let filled = columns.iter().filter(|column| !column.cells[row].is_empty());
        filled
            .map(|it| wrap_paragraph(&format!("  {}: {}", it.heading, it.cells[row]), width, HANGING))
            .collect::<String>()
    };
    (0..rows).map(one).collect::<Vec<_>>().join("\n")
}

/// Wraps a paragraph at blanks; a longer word is not broken. Continued lines have the indentation of the first, and a further one.
pub(crate) fn wrap_paragraph(text: &str, width: usize, further: usize) -> String {
    let indent = text.chars().take_while(|c| *c == ' ').count();
    let (mut lines, mut line) = (String::new(), " ".repeat(indent));
    let mut is_empty = true;
    for word in text.split(' ').filter(|word| !word.is_empty()) {
        if !is_empty && line.chars().count() + 1 + word.chars().count() > width {
            lines += &line;
            lines.push('\n');
            line = " ".repeat(indent + further);
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
        let text = wrap_lines(message, 30);
        assert!(text.lines().all(|line| line.chars().count() <= 30), "{text}");
        assert!(text.contains("0.0083249") && text.ends_with("\n    ^ here\n"), "{text}");
        assert!(text.contains("\n    (time), or slower"), "continued lines are indented further: {text}");
        assert_eq!(wrap_lines(message, 60), format!("{message}\n"));
    }

    /// At any width every number and every word of a heading is unbroken, and no line is wider than requested.
    #[test]
    fn no_word_is_broken_at_any_width() {
        for width in 24..120 {
            let text = render_within(&table(), width);
            for whole in ["1\u{202f}234\u{202f}567", "123\u{202f}456.789", "damped-euler", "processor"] {
                assert!(text.contains(whole), "{width}: {text}");
            }
            let widest = text.lines().map(|line| line.chars().count()).max().unwrap();
            assert!(widest <= width, "{width}: {widest}\n{text}");
            assert!(text.lines().all(|line| line.trim_end() == line), "{width}: {text}");
        }
        let unbound = render_within(&table(), 300);
        assert!(unbound.lines().any(|line| line.contains("largest error of the energy")), "{unbound}");
    }

    #[test]
    fn a_terminal_without_columns_has_the_default_width() {
        assert_eq!([0, 1, 20, 79, 300].map(columns), [PAGE, NARROWEST, 20, 79, 300]);
    }

    /// Least widths are 14, 11, 13 and 11 with their padding: the first names a row, and two others fit beside it into 40.
    #[test]
    fn wide_tables_are_printed_in_blocks() {
        let text = render_within(&table(), 40);
        assert_eq!(text.matches("damped-euler").count(), 2, "{text}");
        let rules = |rule| text.lines().filter(|line| line.starts_with(rule)).count();
        assert_eq!((rules('─'), rules('═')), (3, 2), "{text}");
        assert_eq!(render_within(&table(), 60).matches("damped-euler").count(), 1);
    }

    #[test]
    fn single_rows_of_wide_tables_become_records() {
        let mut table = table();
        table.rows.truncate(1);
        let text = render_within(&table, 40);
        assert!(text.contains("  integrator: damped-euler\n  steps of an orbit: 1"), "{text}");
        assert!(!text.contains('═'), "{text}");
        // No other column fits beside the first.
        let narrow = render_within(&self::table(), 24);
        assert!(narrow.contains("\n\n  integrator: yoshida-8"), "{narrow}");
    }
}
