//! Frames as comma-separated values with a description of every column: writing and reading.

use super::{Digits, FrameColumn, FrameValue, ResultFrame, Role};
use serde::{Deserialize, Serialize};

/// First characters that a spreadsheet interprets as the beginning of a formula.
const FORMULA: [char; 6] = ['=', '+', '-', '@', '\t', '\r'];

/// Writes the frame's rows, numbers with all their digits. Words that a spreadsheet would interpret as a formula are prefixed with an apostrophe,
/// which marks a text.
///
/// # Errors
/// I/O errors of the writer.
pub(crate) fn write(frame: &ResultFrame, out: impl std::io::Write) -> std::io::Result<()> {
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
    pub(crate) resources: Vec<PackageResource>,
}

/// A file of a [`Package`].
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct PackageResource {
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
    fields: Vec<SchemaField>,
    missing_values: Vec<String>,
}

#[derive(Debug, Serialize, Deserialize)]
struct SchemaField {
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
        frames: impl IntoIterator<Item = &'f ResultFrame>,
    ) -> Package {
        Package {
            name: name.to_owned(),
            title: title.to_owned(),
            profile: "tabular-data-package".to_owned(),
            seeds: seeds.to_vec(),
            resources: frames.into_iter().map(PackageResource::of).collect(),
        }
    }
}

impl PackageResource {
    fn of(frame: &ResultFrame) -> PackageResource {
        PackageResource {
            name: frame.name.to_lowercase(),
            title: frame.title.clone(),
            path: format!("{}.csv", frame.name),
            format: "csv".to_owned(),
            encoding: "utf-8".to_owned(),
            schema: Schema {
                fields: frame.columns.iter().map(SchemaField::of).collect(),
                missing_values: vec![String::new()],
            },
        }
    }
}

impl SchemaField {
    fn of(column: &FrameColumn) -> SchemaField {
        let FrameColumn { name, doc, unit, role, digits } = column;
        let kind = match role {
            Role::Words => "string",
            Role::Count => "integer",
            _ => "number",
        };
        let (name, title, kind, unit) = (name.clone(), doc.clone(), kind.to_owned(), unit.clone());
        SchemaField { name, title, kind, unit, role: Some(*role), digits: *digits }
    }

    fn column(self) -> FrameColumn {
        let role = self.role.unwrap_or(match self.kind.as_str() {
            "string" => Role::Words,
            "integer" => Role::Count,
            _ => Role::Number,
        });
        FrameColumn { name: self.name, doc: self.title, unit: self.unit, role, digits: self.digits }
    }
}

/// Reads a frame written by [`write()`], by its description.
///
/// # Errors
/// A sentence with line and column of a cell whose type differs from that of its column.
pub(crate) fn read(resource: PackageResource, bytes: &[u8]) -> Result<ResultFrame, String> {
    let columns: Vec<FrameColumn> = resource.schema.fields.into_iter().map(SchemaField::column).collect();
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
        cells.collect::<Result<Vec<FrameValue>, String>>()
    };
    let rows = reader.records().enumerate().map(row).collect::<Result<_, String>>()?;
    let name = resource.path.trim_end_matches(".csv").to_owned();
    Ok(ResultFrame { name, title: resource.title, columns, rows })
}

fn text(value: &FrameValue) -> String {
    match value {
        FrameValue::Nothing => String::new(),
        FrameValue::Words(words) if words.starts_with(FORMULA) => format!("'{words}"),
        FrameValue::Words(words) => words.clone(),
        FrameValue::Count(count) => count.to_string(),
        FrameValue::Number(number) => number.to_string(),
    }
}

fn value(text: &str, role: Role) -> Option<FrameValue> {
    match role {
        _ if text.is_empty() => Some(FrameValue::Nothing),
        Role::Words => {
            let bare = text.strip_prefix('\'').filter(|rest| rest.starts_with(FORMULA));
            Some(FrameValue::Words(bare.unwrap_or(text).to_owned()))
        }
        Role::Count => text.parse().ok().map(FrameValue::Count),
        _ => text.parse().ok().map(FrameValue::Number),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{FrameBuilder, TableCell};
    use serde_json::json;

    fn written(table: &ResultFrame) -> Vec<Vec<String>> {
        let mut bytes = vec![];
        write(table, &mut bytes).unwrap();
        let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(bytes.as_slice());
        reader.records().map(|record| record.unwrap().iter().map(str::to_owned).collect()).collect()
    }

    #[test]
    fn no_cell_begins_a_formula() {
        let words = ["=1+1", "+A1", "-A1", "@x", "\tx", "\rx", "−3", "a=b"];
        let table = FrameBuilder::of(words).text("=c", |word| *word).frame("t", "t");
        let guarded = ["'=1+1", "'+A1", "'-A1", "'@x", "'\tx", "'\rx", "−3", "a=b"];
        assert_eq!(written(&table).concat()[1..], guarded);
        assert_eq!(written(&table)[0], ["c"]);
    }

    /// Numbers, their errors and words each have a column; a file describes each column.
    #[test]
    fn every_column_holds_numbers_or_words() {
        let cells = [
            [
                TableCell::Number(0.5, 1),
                TableCell::WithError { value: 1.5, error: 0.25, decimals: 1 },
                TableCell::Range([1.0, 2.0], 0),
            ],
            [TableCell::from("lost"), TableCell::Nothing, TableCell::Nothing],
        ];
        let table = FrameBuilder::of([0, 1])
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
        let fields = json!(PackageResource::of(&table).schema.fields);
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
            [
                TableCell::Number(0.1 + 0.2, 1),
                TableCell::with_error(1.5, Some(0.25), 2),
                TableCell::Range([1.0, 2.0], 0),
            ],
            [TableCell::from("-lost"), TableCell::Nothing, TableCell::Nothing],
            [
                TableCell::from("+x"),
                TableCell::with_error(-3.0, Some(0.5), 2),
                TableCell::Range([-1.0, 2.5], 0),
            ],
        ];
        let spread = TableCell::Spread { value: 1.7, range: [1.3, 2.0], decimals: 1 };
        let frame = FrameBuilder::of(&cells)
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
        let table = crate::frame::FormattedTable::from(&again);
        assert_eq!(table.columns, ["energy (J)", "Fano", "seeds", "rate (1/s)", "n", "tiny"]);
        assert_eq!(table.rows[0][..3], cells[0]);
        assert_eq!(table.rows[1][..3], cells[1]);
        assert_eq!(table.rows[2][3..], [spread, TableCell::Count(3), TableCell::Short(1.5e-9)]);
    }

    #[test]
    fn a_damaged_file_names_the_cell() {
        let frame = FrameBuilder::of([1u64]).count("n", |n| *n).frame("t", "T");
        let resource = || PackageResource::of(&frame);
        assert_eq!(read(resource(), b"n\n1\nx\n").unwrap_err(), "t.csv line 3: `x` in column n");
        assert!(read(resource(), b"m\n1\n").unwrap_err().contains("columns"));
    }
}
