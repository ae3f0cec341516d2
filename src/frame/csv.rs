//! Frames as comma-separated values with a description of every column: writing and reading.

use super::{Column, Digits, Frame, Role, Value};
use serde::{Deserialize, Serialize};

/// First characters that a spreadsheet interprets as the beginning of a formula.
const FORMULA: [char; 6] = ['=', '+', '-', '@', '\t', '\r'];

/// Writes the frame's rows, numbers with all their digits. Words that a spreadsheet would interpret as a formula are prefixed with an apostrophe,
/// which marks a text.
///
/// # Errors
/// I/O errors of the writer.
pub(crate) fn write(frame: &Frame, out: impl std::io::Write) -> std::io::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(frame.columns.iter().map(|column| &column.name))?;
    for row in &frame.rows {
        writer.write_record(row.iter().map(text))?;
    }
    writer.flush()
}

/// Frames of a folder as a Frictionless data package: each file with its columns, their types, units and meanings.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Package {
    name: String,
    title: String,
    profile: String,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub seeds: Vec<u64>,
    pub(crate) resources: Vec<Resource>,
}

/// A file of a [`Package`].
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Resource {
    name: String,
    title: String,
    pub path: String,
    format: String,
    encoding: String,
    schema: Schema,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Schema {
    fields: Vec<Field>,
    missing_values: Vec<String>,
}

#[derive(Debug, Serialize, Deserialize)]
struct Field {
    name: String,
    title: String,
    #[serde(rename = "type")]
    kind: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    unit: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    role: Option<Role>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    digits: Option<Digits>,
}

impl Package {
    /// Describes the frames of an item.
    pub(crate) fn of<'f>(
        name: &str,
        title: &str,
        seeds: &[u64],
        frames: impl IntoIterator<Item = &'f Frame>,
    ) -> Package {
        Package {
            name: name.to_owned(),
            title: title.to_owned(),
            profile: "tabular-data-package".to_owned(),
            seeds: seeds.to_vec(),
            resources: frames.into_iter().map(Resource::of).collect(),
        }
    }
}

impl Resource {
    fn of(frame: &Frame) -> Resource {
        Resource {
            name: frame.name.to_lowercase(),
            title: frame.title.clone(),
            path: format!("{}.csv", frame.name),
            format: "csv".to_owned(),
            encoding: "utf-8".to_owned(),
            schema: Schema {
                fields: frame.columns.iter().map(Field::of).collect(),
                missing_values: vec![String::new()],
            },
        }
    }
}

impl Field {
    fn of(column: &Column) -> Field {
        let Column { name, doc, unit, role, digits } = column;
        let kind = match role {
            Role::Words => "string",
            Role::Count => "integer",
            _ => "number",
        };
        let (name, title, kind, unit) = (name.clone(), doc.clone(), kind.to_owned(), unit.clone());
        Field { name, title, kind, unit, role: Some(*role), digits: *digits }
    }

    fn column(self) -> Column {
        let role = self.role.unwrap_or(match self.kind.as_str() {
            "string" => Role::Words,
            "integer" => Role::Count,
            _ => Role::Number,
        });
        Column { name: self.name, doc: self.title, unit: self.unit, role, digits: self.digits }
    }
}

/// Reads a frame written by [`write()`], by its description.
///
/// # Errors
/// A sentence with line and column of a cell whose type differs from that of its column.
pub(crate) fn read(resource: Resource, bytes: &[u8]) -> Result<Frame, String> {
    let columns: Vec<Column> = resource.schema.fields.into_iter().map(Field::column).collect();
    let mut reader = csv::Reader::from_reader(bytes);
    let names: Vec<String> =
        reader.headers().map_err(|cause| cause.to_string())?.iter().map(str::to_owned).collect();
    if !columns.iter().map(|column| &column.name).eq(&names) {
        return Err(format!("{}: the columns differ from those in datapackage.json", resource.path));
    }
    let row = |(at, record): (usize, csv::Result<csv::StringRecord>)| {
        let record = record.map_err(|cause| cause.to_string())?;
        let cells = columns.iter().zip(record.iter()).map(|(column, text)| {
            let wrong = || format!("{} line {}: `{text}` in column {}", resource.path, at + 2, column.name);
            value(text, column.role).ok_or_else(wrong)
        });
        cells.collect::<Result<Vec<Value>, String>>()
    };
    let rows = reader.records().enumerate().map(row).collect::<Result<_, String>>()?;
    let name = resource.path.trim_end_matches(".csv").to_owned();
    Ok(Frame { name, title: resource.title, columns, rows })
}

fn text(value: &Value) -> String {
    match value {
        Value::Nothing => String::new(),
        Value::Words(words) if words.starts_with(FORMULA) => format!("'{words}"),
        Value::Words(words) => words.clone(),
        Value::Count(count) => count.to_string(),
        Value::Number(number) => number.to_string(),
    }
}

fn value(text: &str, role: Role) -> Option<Value> {
    match role {
        _ if text.is_empty() => Some(Value::Nothing),
        Role::Words => {
            let bare = text.strip_prefix('\'').filter(|rest| rest.starts_with(FORMULA));
            Some(Value::Words(bare.unwrap_or(text).to_owned()))
        }
        Role::Count => text.parse().ok().map(Value::Count),
        _ => text.parse().ok().map(Value::Number),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{Cell, Rows};
    use serde_json::json;

    fn written(table: &Frame) -> Vec<Vec<String>> {
        let mut bytes = vec![];
        write(table, &mut bytes).unwrap();
        let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(bytes.as_slice());
        reader.records().map(|record| record.unwrap().iter().map(str::to_owned).collect()).collect()
    }

    #[test]
    fn no_cell_begins_a_formula() {
        let words = ["=1+1", "+A1", "-A1", "@x", "\tx", "\rx", "−3", "a=b"];
        let table = Rows::of(words).text("=c", |word| *word).frame("t", "t");
        let guarded = ["'=1+1", "'+A1", "'-A1", "'@x", "'\tx", "'\rx", "−3", "a=b"];
        assert_eq!(written(&table).concat()[1..], guarded);
        assert_eq!(written(&table)[0], ["c"]);
    }

    /// Numbers, their errors and words each have a column; a file describes each column.
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
            .frame("T", "Title");
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
        let fields = json!(Resource::of(&table).schema.fields);
        let energy = json!({
            "name": "energy", "title": "energy (J)", "type": "number", "unit": "J", "role": "number", "digits": { "decimals": 1 }
        });
        assert_eq!(fields[0], energy);
        assert_eq!([&fields[1]["type"], &fields[6]["type"]], ["string", "integer"]);
    }

    /// Files contain everything a page shows: tables are unchanged after writing and reading.
    #[test]
    fn frames_are_read_as_they_were_written() {
        let cells = [
            [Cell::Number(0.1 + 0.2, 1), Cell::with_error(1.5, Some(0.25), 2), Cell::Range([1.0, 2.0], 0)],
            [Cell::from("-lost"), Cell::Nothing, Cell::Nothing],
            [Cell::from("+x"), Cell::with_error(-3.0, Some(0.5), 2), Cell::Range([-1.0, 2.5], 0)],
        ];
        let spread = Cell::Spread { value: 1.7, range: [1.3, 2.0], decimals: 1 };
        let frame = Rows::of(&cells)
            .cells(["energy (J)", "Fano", "seeds"], |row| (*row).clone())
            .cell("rate (1/s)", |_| spread.clone())
            .count("n", |_| 3u64)
            .short("tiny", |_| 1.5e-9)
            .frame("t", "Title");
        let mut bytes = vec![];
        write(&frame, &mut bytes).unwrap();
        let package = serde_json::to_string(&Package::of("i", "I", &[], [&frame])).unwrap();
        let mut package: Package = serde_json::from_str(&package).unwrap();
        let again = read(package.resources.remove(0), &bytes).unwrap();
        assert_eq!(again, frame);
        let table = crate::frame::Table::from(&again);
        assert_eq!(table.columns, ["energy (J)", "Fano", "seeds", "rate (1/s)", "n", "tiny"]);
        assert_eq!(table.rows[0][..3], cells[0]);
        assert_eq!(table.rows[1][..3], cells[1]);
        assert_eq!(table.rows[2][3..], [spread, Cell::Count(3), Cell::Short(1.5e-9)]);
    }

    #[test]
    fn a_damaged_file_names_the_cell() {
        let frame = Rows::of([1u64]).count("n", |n| *n).frame("t", "T");
        let resource = || Resource::of(&frame);
        assert_eq!(read(resource(), b"n\n1\nx\n").unwrap_err(), "t.csv line 3: `x` in column n");
        assert!(read(resource(), b"m\n1\n").unwrap_err().contains("columns"));
    }
}
