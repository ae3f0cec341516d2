//! Where an entry stands in a file.

use std::fmt;
use toml::de::{DeTable, DeValue};

/// A place in a text, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Position {
    /// The line.
    pub line: usize,
    /// The character of the line.
    pub column: usize,
}

impl Position {
    /// Of `entry`, a path of keys joined by dots; where it is missing, of the table that it is missing from; none
    /// if the text is not TOML.
    pub fn of(text: &str, entry: &str) -> Option<Position> {
        let document = DeTable::parse(text).ok()?;
        let mut table = Some(document.get_ref());
        let mut found = 0;
        for key in entry.split('.') {
            let Some((name, value)) =
                table.and_then(|table| table.iter().find(|(name, _)| name.get_ref() == key))
            else {
                break;
            };
            // A table's own span may be that of its last header: its key says where it begins.
            found = if value.get_ref().is_table() { name.span().start } else { value.span().start };
            table = match value.get_ref() {
                DeValue::Table(inner) => Some(inner),
                _ => None,
            };
        }
        let before = text.get(..found)?;
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().map_or(0, |line| line.chars().count()) + 1;
        Some(Position { line, column })
    }
}

impl fmt::Display for Position {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}, column {}", self.line, self.column)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_entry_is_found_and_a_missing_one_lies_in_its_table() {
        let text = "a = 1\n[b]\nc = { value = -3, note = \"\" }\n";
        let at = |entry| Position::of(text, entry).map(|at| (at.line, at.column));
        assert_eq!(at("a"), Some((1, 5)));
        assert_eq!(at("b.c.value"), Some((3, 15)));
        assert_eq!(at("b.c.nothing"), Some((3, 1)));
        assert_eq!(at("b.d"), Some((2, 2)));
        assert_eq!(at("z"), Some((1, 1)));
    }
}
