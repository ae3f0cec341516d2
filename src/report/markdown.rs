//! Tables in Markdown.

use super::Table;

/// Rows of a table that a page shows; a longer one is for programs.
const ROWS: usize = 16;

/// The table as a section of a page: the first rows of a long one, and where in an item's folder all are.
pub fn render(table: &Table, folder: &str) -> String {
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let mut text = format!("### {}\n\n", table.title);
    text.push_str(&line(table.columns.iter().map(|column| column.replace('|', "\\|")).collect()));
    let numeric = |i: usize| table.rows.iter().all(|row| row[i].is_number());
    let rule = |i| if numeric(i) { "--:" } else { "---" }.to_owned();
    text.push_str(&line((0..table.columns.len()).map(rule).collect()));
    for row in table.rows.iter().take(ROWS) {
        text.push_str(&line(row.iter().map(|cell| cell.for_reading().replace('|', "\\|")).collect()));
    }
    if table.rows.len() > ROWS {
        let file = format!("{folder}/{}.csv", table.name);
        text.push_str(&format!(
            "\nThe first {ROWS} of {} rows; all are in [{file}]({file}).\n",
            table.rows.len()
        ));
    }
    for note in &table.notes {
        text.push_str(&format!("\n{note}\n"));
    }
    text
}
