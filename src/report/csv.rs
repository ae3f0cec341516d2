//! Tables as comma-separated values.

use super::{Cell, Table};

/// What a spreadsheet takes for the beginning of a formula.
const FORMULA: [char; 6] = ['=', '+', '-', '@', '\t', '\r'];

/// The table's columns and rows, numbers with all their digits. Words that a spreadsheet would take for a formula have an
/// apostrophe before them, which it takes for the mark of a text.
///
/// # Errors
/// If the writer does.
pub fn write(table: &Table, out: impl std::io::Write) -> std::io::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(table.columns.iter().map(|column| text(column)))?;
    for row in &table.rows {
        writer.write_record(row.iter().map(cell))?;
    }
    writer.flush()
}

fn cell(cell: &Cell) -> String {
    match cell {
        Cell::Text(words) => text(words),
        Cell::Count(_) | Cell::Number(..) | Cell::Nothing => cell.for_machines(),
    }
}

fn text(words: &str) -> String {
    // A number that is written as a text is a number.
    let is_formula = words.starts_with(FORMULA) && words.parse::<f64>().is_err();
    if is_formula { format!("'{words}") } else { words.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_cell_begins_a_formula_and_numbers_stay() {
        let words = ["=1+1", "+A1", "-A1", "@x", "\tx", "\rx", "-1.5", "+2", "−3", "a=b", "-inf"];
        let row = words.map(Cell::from).into_iter().chain([Cell::Number(-0.5, 1), Cell::Nothing]);
        let columns = vec!["=c".to_owned(); words.len() + 2];
        let (name, title) = ("t".to_owned(), "t".to_owned());
        let table = Table { name, title, columns, rows: vec![row.collect()], notes: vec![] };
        let mut bytes = vec![];
        write(&table, &mut bytes).unwrap();
        let mut reader = csv::Reader::from_reader(bytes.as_slice());
        assert!(reader.headers().unwrap().iter().all(|heading| heading == "'=c"));
        let read = reader.records().next().unwrap().unwrap();
        assert_eq!(
            read.iter().collect::<Vec<_>>(),
            ["'=1+1", "'+A1", "'-A1", "'@x", "'\tx", "'\rx", "-1.5", "+2", "−3", "a=b", "-inf", "-0.5", ""]
        );
    }
}
