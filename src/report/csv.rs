//! Tables as comma-separated values for programs: numbers as numbers, words in columns of their own, one name for a quantity in all
//! files, and a description of each column.

mod names;

use super::{Cell, Table};
use serde_json::{Value, json};

/// What a spreadsheet takes for the beginning of a formula.
const FORMULA: [char; 6] = ['=', '+', '-', '@', '\t', '\r'];

/// What a column of a file holds of the cells of a column of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Words,
    Whole,
    Number,
    Error,
    Lowest,
    Highest,
}

/// A column of a file.
struct Field<'t> {
    name: String,
    heading: &'t str,
    column: usize,
    part: Part,
}

/// The table's rows, numbers with all their digits. Words that a spreadsheet would take for a formula have an apostrophe before them, which
/// it takes for the mark of a text.
///
/// # Errors
/// If the writer does.
pub fn write(table: &Table, out: impl std::io::Write) -> std::io::Result<()> {
    let fields = fields(table);
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(fields.iter().map(|field| &field.name))?;
    for row in &table.rows {
        writer.write_record(fields.iter().map(|field| text(&row[field.column], field.part)))?;
    }
    writer.flush()
}

/// The tables of a folder as a Frictionless data package: each file, its columns, their types, and what they are called for readers.
pub fn package(name: &str, title: &str, tables: &[Table]) -> Value {
    let resource = |table: &Table| {
        let fields: Vec<Value> = fields(table).iter().map(described).collect();
        json!({
            "name": table.name.to_lowercase(),
            "title": table.title,
            "path": format!("{}.csv", table.name),
            "format": "csv",
            "encoding": "utf-8",
            "schema": { "fields": fields, "missingValues": [""] },
        })
    };
    let resources: Vec<Value> = tables.iter().map(resource).collect();
    json!({ "name": name, "title": title, "profile": "tabular-data-package", "resources": resources })
}

fn described(field: &Field<'_>) -> Value {
    let kind = match field.part {
        Part::Words => "string",
        Part::Whole => "integer",
        _ => "number",
    };
    let what = match field.part {
        Part::Words | Part::Whole | Part::Number => "",
        Part::Error => ", half the width of its interval",
        Part::Lowest => ", lowest",
        Part::Highest => ", highest",
    };
    let mut described =
        json!({ "name": field.name, "title": format!("{}{what}", field.heading), "type": kind });
    if let Some(unit) = names::unit(field.heading).filter(|_| field.part != Part::Words) {
        described["unit"] = json!(unit);
    }
    described
}

/// The columns of a file: of each column of the table as many as its cells need.
fn fields(table: &Table) -> Vec<Field<'_>> {
    let mut fields: Vec<Field<'_>> = vec![];
    let mut before = String::new();
    for (column, heading) in table.columns.iter().enumerate() {
        let mut base = names::of(heading);
        // What only says what it is of the column before, and what occurs twice, is called by both.
        let is_known = |name: &str| fields.iter().any(|field| field.name == name);
        if heading.starts_with('±') || is_known(&base) {
            base = format!("{before}_{base}");
        }
        before.clone_from(&base);
        let numbered = (2..).map(|number| format!("{base}_{number}"));
        let base = std::iter::once(base.clone()).chain(numbered).find(|name| !is_known(name)).unwrap_or(base);
        let cells = || table.rows.iter().filter_map(|row| row.get(column));
        for part in parts(cells) {
            let name = match part {
                Part::Words if parts(cells).len() > 1 => format!("{base}_words"),
                Part::Words | Part::Whole | Part::Number => base.clone(),
                Part::Error => format!("{base}_error"),
                Part::Lowest => format!("{base}_lowest"),
                Part::Highest => format!("{base}_highest"),
            };
            fields.push(Field { name, heading, column, part });
        }
    }
    fields
}

fn parts<'c, I: Iterator<Item = &'c Cell>>(cells: impl Fn() -> I) -> Vec<Part> {
    let has = |is_so: fn(&Cell) -> bool| cells().any(is_so);
    let ranges = has(|cell| matches!(cell, Cell::Range(..)));
    let errors = has(|cell| matches!(cell, Cell::WithError { .. }));
    let numbers = has(|cell| matches!(cell, Cell::Number(..) | Cell::Short(_)));
    let counts = has(|cell| matches!(cell, Cell::Count(_)));
    let words = has(|cell| matches!(cell, Cell::Text(words) if !words.is_empty()));
    let all = [
        (numbers || errors, Part::Number),
        (counts && !(numbers || errors), Part::Whole),
        (errors, Part::Error),
        (ranges, Part::Lowest),
        (ranges, Part::Highest),
        (words || !(numbers || errors || counts || ranges), Part::Words),
    ];
    all.into_iter().filter(|(is_there, _)| *is_there).map(|(_, part)| part).collect()
}

fn text(cell: &Cell, part: Part) -> String {
    let number = |value: f64| if value.is_finite() { value.to_string() } else { String::new() };
    match (cell, part) {
        (Cell::Text(words), Part::Words) => guarded(words),
        (Cell::Count(count), Part::Whole | Part::Number) => count.to_string(),
        (Cell::Number(value, _) | Cell::Short(value), Part::Number) => number(*value),
        (Cell::WithError { value, .. }, Part::Number) => number(*value),
        (Cell::WithError { error, .. }, Part::Error) => number(*error),
        (Cell::Range([lowest, _], _), Part::Lowest) => number(*lowest),
        (Cell::Range([_, highest], _), Part::Highest) => number(*highest),
        _ => String::new(),
    }
}

fn guarded(words: &str) -> String {
    if words.starts_with(FORMULA) { format!("'{words}") } else { words.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Rows;

    fn written(table: &Table) -> Vec<Vec<String>> {
        let mut bytes = vec![];
        write(table, &mut bytes).unwrap();
        let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(bytes.as_slice());
        reader.records().map(|record| record.unwrap().iter().map(str::to_owned).collect()).collect()
    }

    #[test]
    fn no_cell_begins_a_formula() {
        let words = ["=1+1", "+A1", "-A1", "@x", "\tx", "\rx", "−3", "a=b"];
        let table = Rows::of(words).text("=c", |word| *word).table("t", "t");
        let guarded = ["'=1+1", "'+A1", "'-A1", "'@x", "'\tx", "'\rx", "−3", "a=b"];
        assert_eq!(written(&table).concat()[1..], guarded);
        assert_eq!(written(&table)[0], ["c"]);
    }

    /// Numbers, their errors and the words between them each have a column; a file says what a column is.
    #[test]
    fn every_column_holds_numbers_or_words() {
        let cells = [
            [
                Cell::Number(0.5, 1),
                Cell::WithError { value: 1.5, error: 0.25, decimals: 1 },
                Cell::Range([1.0, 2.0], 0),
            ],
            [Cell::from("lost"), Cell::Nothing, Cell::Nothing],
        ];
        let table = Rows::of([0, 1])
            .cells(["energy (J)", "Fano late", "seeds"], |row| cells[*row].clone())
            .count("± (95 %)", |row| *row as u64)
            .count("± (95 %)", |row| *row as u64)
            .table("T", "Title");
        let rows = written(&table);
        let names = [
            "energy",
            "energy_words",
            "fano_late",
            "fano_late_error",
            "seeds_lowest",
            "seeds_highest",
            "seeds_error_95",
            "seeds_error_95_error_95",
        ];
        assert_eq!(rows[0], names);
        assert_eq!(rows[1], ["0.5", "", "1.5", "0.25", "1", "2", "0", "0"]);
        assert_eq!(rows[2], ["", "lost", "", "", "", "", "1", "1"]);
        let package = package("item", "Item", &[table]);
        let fields = &package["resources"][0]["schema"]["fields"];
        assert_eq!(
            fields[0],
            json!({ "name": "energy", "title": "energy (J)", "type": "number", "unit": "J" })
        );
        assert_eq!([&fields[1]["type"], &fields[6]["type"]], ["string", "integer"]);
    }
}
