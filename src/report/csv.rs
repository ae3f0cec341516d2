//! Tables as comma-separated values.

use super::Table;

/// The table's columns and rows, numbers with all their digits.
///
/// # Errors
/// If the writer does.
pub fn write(table: &Table, out: impl std::io::Write) -> std::io::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(&table.columns)?;
    for row in &table.rows {
        writer.write_record(row.iter().map(super::Cell::for_machines))?;
    }
    writer.flush()
}
