//! Tables in Markdown.

use super::Table;

/// The table as a section of a page.
pub fn render(table: &Table) -> String {
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let mut text = format!("### {}\n\n", table.title);
    text.push_str(&line(table.columns.iter().map(|column| column.replace('|', "\\|")).collect()));
    let numeric = |i: usize| table.rows.iter().all(|row| row[i].is_number());
    let rule = |i| if numeric(i) { "--:" } else { "---" }.to_owned();
    text.push_str(&line((0..table.columns.len()).map(rule).collect()));
    for row in &table.rows {
        text.push_str(&line(row.iter().map(|cell| cell.for_reading().replace('|', "\\|")).collect()));
    }
    for note in &table.notes {
        text.push_str(&format!("\n{note}\n"));
    }
    text
}
