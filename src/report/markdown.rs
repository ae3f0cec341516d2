//! Tables in Markdown.

use super::FormattedTable;

/// Maximum rows of a table on the page; a longer table is only linked.
const ROWS: usize = 8;

/// Renders a table without its notes, which are on the HTML page. A long table is replaced by a link to its file.
pub(crate) fn render(table: &FormattedTable, folder: &str) -> String {
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
        text.push_str(&line(row.iter().map(|cell| cell.formatted_text().replace('|', "\\|")).collect()));
    }
    text
}
