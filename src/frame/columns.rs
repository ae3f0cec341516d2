//! Frames: typed columns and rows.

use serde::{Deserialize, Serialize};

/// A table of results: columns with a type, a unit and a meaning, and rows as long as the columns.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Name of its file, without the ending.
    pub name: String,
    /// Content in one line.
    pub title: String,
    /// The columns.
    pub columns: Vec<Column>,
    /// Rows, each as long as the columns.
    pub rows: Vec<Vec<Value>>,
}

/// A column of a [`Frame`].
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Name for programs: small letters, digits and `_`.
    pub name: String,
    /// Meaning, as a heading.
    pub doc: String,
    /// Unit; none for words, counts and ratios.
    pub unit: Option<String>,
    /// Part that it plays beside the columns of the same heading.
    pub(crate) role: Role,
    /// Digits that a page shows.
    pub digits: Option<Digits>,
}

/// Part that a column plays beside the columns of the same heading.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Role {
    Words,
    Count,
    Number,
    /// 95 % half-width of the number before it, or the error that the table's note names.
    Error,
    /// Lowest of several numbers.
    Lowest,
    /// Highest of several numbers.
    Highest,
}

/// Digits that a page shows of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Digits {
    /// Decimals.
    Decimals(usize),
    /// Two significant digits, with a power of ten where the number is small or large.
    Short,
}

/// Content of a place of a [`Frame`].
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Nothing, or no finite number.
    Nothing,
    /// Words.
    Words(String),
    /// A count.
    Count(u64),
    /// A number.
    Number(f64),
}

impl Value {
    /// A number, or nothing where it is not finite.
    pub(super) fn number(value: f64) -> Value {
        if value.is_finite() { Value::Number(value) } else { Value::Nothing }
    }
}

impl Frame {
    /// Position of a column.
    ///
    /// # Errors
    /// A sentence with the names that exist.
    pub fn position(&self, column: &str) -> Result<usize, String> {
        let found = self.columns.iter().position(|it| it.name == column);
        found.ok_or_else(|| {
            let names: Vec<&str> = self.columns.iter().map(|it| it.name.as_str()).collect();
            format!("table `{}` has no column `{column}`; it has {}", self.name, names.join(", "))
        })
    }
}

/// For programs.
impl Frame {
    /// The rows as a list of objects, by the names of the columns.
    pub fn json(&self) -> serde_json::Value {
        let value = |value: &Value| match value {
            Value::Nothing => serde_json::Value::Null,
            Value::Words(words) => words.as_str().into(),
            Value::Count(count) => (*count).into(),
            Value::Number(number) => (*number).into(),
        };
        let row = |row: &Vec<Value>| {
            let cells = self.columns.iter().zip(row).map(|(column, it)| (column.name.clone(), value(it)));
            cells.collect::<serde_json::Value>()
        };
        self.rows.iter().map(row).collect()
    }
}

impl Role {
    /// All of them, in the order of columns.
    pub(super) const ALL: [Role; 6] =
        [Role::Number, Role::Count, Role::Error, Role::Lowest, Role::Highest, Role::Words];
}

/// In the order of the columns of one heading.
impl PartialOrd for Role {
    fn partial_cmp(&self, other: &Role) -> Option<std::cmp::Ordering> {
        let place = |role: &Role| Role::ALL.iter().position(|it| it == role);
        place(self).partial_cmp(&place(other))
    }
}
