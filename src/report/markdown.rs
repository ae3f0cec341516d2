//! Tables in Markdown.

use super::Table;

/// Rows of a table that a page shows; a longer one is for programs.
const ROWS: usize = 8;

/// The table without its notes, which the page with charts has; of a long one, where it lies in an item's folder.
pub(crate) fn render(table: &Table, folder: &str) -> String {
    let file = format!("{folder}/{}.csv", table.name);
    if table.rows.len() > ROWS {
        return format!("**{}**: {} rows in [{file}]({file}).\n", table.title, table.rows.len());
    }
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let mut text = format!("**{}**\n\n", table.title);
    text.push_str(&line(table.columns.iter().map(|column| column.replace('|', "\\|")).collect()));
    let numeric = |i: usize| table.rows.iter().all(|row| row[i].is_number());
    let rule = |i| if numeric(i) { "--:" } else { "---" }.to_owned();
    text.push_str(&line((0..table.columns.len()).map(rule).collect()));
    for row in &table.rows {
        text.push_str(&line(row.iter().map(|cell| cell.for_reading().replace('|', "\\|")).collect()));
    }
    text
}
