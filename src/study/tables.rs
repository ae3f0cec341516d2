//! How the tables of studies are put together.

use crate::report::{Cell, Table};

/// A table of a study's page.
pub fn table(name: &str, title: &str, columns: &[&str], rows: Vec<Vec<Cell>>, notes: &[&str]) -> Table {
    Table {
        name: name.into(),
        title: title.into(),
        columns: columns.iter().map(|&column| column.to_owned()).collect(),
        rows,
        notes: notes.iter().map(|&note| note.to_owned()).collect(),
    }
}

/// A cell with words.
pub fn text(text: impl Into<String>) -> Cell {
    Cell::Text(text.into())
}
