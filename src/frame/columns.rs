//! Frames: typed columns and rows.

use serde::{Deserialize, Serialize};

/// A table of results: columns with a type, a unit and a meaning, and rows as long as the columns.
#[derive(Clone, Debug, PartialEq)]
pub struct ResultFrame {
    /// Name of its file, without the extension.
    pub name: String,
    /// Content in one line.
    pub title: String,
    /// The columns.
    pub columns: Vec<FrameColumn>,
    /// Rows, each as long as the columns.
    pub rows: Vec<Vec<FrameValue>>,
}

/// A column of a [`ResultFrame`].
#[derive(Clone, Debug, PartialEq)]
pub struct FrameColumn {
    /// Name for programs: small letters, digits and `_`.
    pub name: String,
    /// Meaning, as a heading.
    pub doc: String,
    /// Unit; none for words, counts or ratios.
    pub unit: Option<String>,
    /// Role among the columns of the same heading.
    pub(crate) role: Role,
    /// Digits shown on a page.
    pub digits: Option<Digits>,
}

/// Role of a column among those of the same heading.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Role {
    Words,
    Count,
    Number,
    /// 95 % half-width of the number before it, or the error named in the table's note.
    Error,
    Lowest,
    Highest,
}

/// Digits shown of a number on a page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Digits {
    /// Decimals.
    Decimals(usize),
    /// Two significant digits, with a power of ten where the number is small or large.
    Short,
}

/// Content of a cell of a [`ResultFrame`].
#[derive(Clone, Debug, PartialEq)]
pub enum FrameValue {
    /// Nothing, or no finite number.
    Nothing,
    /// Words.
    Words(String),
    /// A count.
    Count(u64),
    /// A number.
    Number(f64),
}

impl FrameValue {
    /// Wraps a number; infinities and NaN become nothing.
    pub(super) fn number(value: f64) -> FrameValue {
        if value.is_finite() { FrameValue::Number(value) } else { FrameValue::Nothing }
    }
}

impl ResultFrame {
    /// Index of a column.
    ///
    /// # Errors
    /// A sentence with the existing names.
    pub fn position(&self, column: &str) -> Result<usize, String> {
        let found = self.columns.iter().position(|it| it.name == column);
        found.ok_or_else(|| {
            let names: Vec<&str> = self.columns.iter().map(|it| it.name.as_str()).collect();
            format!("table `{}` has no column `{column}`; it has {}", self.name, names.join(", "))
        })
    }
}

/// Export for programs.
impl ResultFrame {
    /// Rows as a list of objects, keyed by the names of the columns.
    pub fn json(&self) -> serde_json::Value {
        let value = |value: &FrameValue| match value {
            FrameValue::Nothing => serde_json::Value::Null,
            FrameValue::Words(words) => words.as_str().into(),
            FrameValue::Count(count) => (*count).into(),
            FrameValue::Number(number) => (*number).into(),
        };
        let row = |row: &Vec<FrameValue>| {
            let cells = self.columns.iter().zip(row).map(|(column, it)| (column.name.clone(), value(it)));
            cells.collect::<serde_json::Value>()
        };
        self.rows.iter().map(row).collect()
    }
}

impl Role {
    /// All roles, in the order of columns.
    pub(super) const ALL: [Role; 6] =
        [Role::Number, Role::Count, Role::Error, Role::Lowest, Role::Highest, Role::Words];
}

/// Orders roles as the columns of one heading.
impl PartialOrd for Role {
    fn partial_cmp(&self, other: &Role) -> Option<std::cmp::Ordering> {
        let place = |role: &Role| Role::ALL.iter().position(|it| it == role);
        place(self).partial_cmp(&place(other))
    }
}
