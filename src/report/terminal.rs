//! Tables for a terminal.

use super::Table;
use comfy_table::presets::UTF8_HORIZONTAL_ONLY;
use comfy_table::{CellAlignment, ContentArrangement, LineStyle};

/// The table as text, no wider than the terminal where there is one.
pub fn render(table: &Table) -> String {
    let mut drawn = comfy_table::Table::new();
    // A rule below the headings and around the table; rows stand close.
    drawn
        .load_style(UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none()))
        .set_content_arrangement(ContentArrangement::Dynamic);
    drawn.set_header(&table.columns);
    for row in &table.rows {
        drawn.add_row(row.iter().map(|cell| {
            let side = if cell.is_number() { CellAlignment::Right } else { CellAlignment::Left };
            comfy_table::Cell::new(cell.for_reading()).set_alignment(side)
        }));
    }
    let mut text = format!("{}\n{drawn}\n", table.title);
    for note in &table.notes {
        text.push_str(note);
        text.push('\n');
    }
    text
}
