//! Tables in Markdown.

use super::Table;

/// Rows of a table that a page shows; a longer one is for programs, and of it a page has the first few.
const ROWS: usize = 10;
const FIRST: usize = 4;

/// The table as a section of a page: the first rows of a long one, and where in an item's folder all are.
pub fn render(table: &Table, folder: &str) -> String {
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let mut text = format!("### {}\n\n", table.title);
    text.push_str(&line(table.columns.iter().map(|column| column.replace('|', "\\|")).collect()));
    let numeric = |i: usize| table.rows.iter().all(|row| row[i].is_number());
    let rule = |i| if numeric(i) { "--:" } else { "---" }.to_owned();
    text.push_str(&line((0..table.columns.len()).map(rule).collect()));
    let shown = if table.rows.len() > ROWS { FIRST } else { ROWS };
    for row in table.rows.iter().take(shown) {
        text.push_str(&line(row.iter().map(|cell| cell.for_reading().replace('|', "\\|")).collect()));
    }
    if table.rows.len() > ROWS {
        let file = format!("{folder}/{}.csv", table.name);
        text.push_str(&format!(
            "\nThe first {FIRST} of {} rows; all are in [{file}]({file}).\n",
            table.rows.len()
        ));
    }
    for note in &table.notes {
        text.push_str(&format!("\n{note}\n"));
    }
    text
}
