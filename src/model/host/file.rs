//! Host files: what `calibrate` writes, as TOML.

use super::HostModel;
use crate::model::machine_file::Position;

/// The version of the file format that this program reads.
pub const FORMAT: u32 = 1;

/// Why a host file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum HostFileError {
    /// Not TOML, or an entry that is missing, unknown or of the wrong type; the cause shows line and column.
    #[error("host file `{file}`: {cause}")]
    Syntax {
        /// Name of the file.
        file: String,
        /// What the TOML reader says, with the place.
        cause: Box<toml::de::Error>,
    },
    /// An entry that cannot be.
    #[error("host file `{file}`{}: `{entry}` {what}", position.map_or(String::new(), |at| format!(", {at}")))]
    Content {
        /// Name of the file.
        file: String,
        /// Where.
        position: Option<Position>,
        /// The entry.
        entry: String,
        /// What is wrong.
        what: String,
    },
}

impl HostModel {
    /// Reads a host file; `file` is the name that errors give it.
    ///
    /// # Errors
    /// [`HostFileError`] for the first entry found wrong.
    pub fn parse(file: &str, text: &str) -> Result<HostModel, HostFileError> {
        let model: HostModel = toml::from_str(text)
            .map_err(|cause| HostFileError::Syntax { file: file.to_owned(), cause: Box::new(cause) })?;
        match model.defect() {
            None => Ok(model),
            Some((entry, what)) => Err(HostFileError::Content {
                file: file.to_owned(),
                position: Position::of(text, &entry),
                entry,
                what,
            }),
        }
    }

    /// The text of its file.
    pub fn to_toml(&self) -> String {
        // A model is tables of numbers and words, which TOML can always say.
        toml::to_string(self).unwrap_or_default()
    }

    /// The first entry that cannot be, and why.
    fn defect(&self) -> Option<(String, String)> {
        if self.format != FORMAT {
            return Some((
                "format".to_owned(),
                format!("is {}, but this program reads {FORMAT}", self.format),
            ));
        }
        let lanes = self.lanes.iter().flat_map(|(lane, costs)| {
            let passes = costs.passes.iter().flat_map(move |(op, cost)| {
                [("element", cost.element.value), ("start", cost.start.value)]
                    .map(|(what, value)| (format!("lanes.{lane}.passes.{op}.{what}.value"), value))
            });
            let chained = costs.chained.iter();
            let chained =
                chained.map(move |(op, cost)| (format!("lanes.{lane}.chained.{op}.value"), cost.value));
            passes.chain(chained)
        });
        let levels = self.levels.iter().map(|level| ("levels".to_owned(), level.byte));
        let rest = [
            ("operand", self.operand),
            ("bind", self.bind),
            ("chained_run", self.chained_run),
            ("chained_overlap", self.chained_overlap),
            ("measured.spread", self.measured.spread),
        ];
        let mut numbers = lanes.chain(levels).chain(rest.map(|(entry, value)| (entry.to_owned(), value)));
        if let Some((entry, value)) = numbers.find(|(_, value)| !(value.is_finite() && *value >= 0.0)) {
            return Some((entry, format!("is {value}, but must be finite and not negative")));
        }
        if self.levels.is_empty() || self.set_up.len() < 2 || self.lanes.is_empty() {
            return Some(("levels".to_owned(), "with `set_up` and `lanes` must not be empty".to_owned()));
        }
        None
    }
}

/// The host model that comes with the program: of the machine that it was developed on.
///
/// # Errors
/// [`HostFileError`] never, as a test of the shipped text holds.
pub fn default_model() -> Result<HostModel, HostFileError> {
    HostModel::parse("the shipped host model", include_str!("default.toml"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shipped_model_is_read_and_written_without_loss() {
        let model = default_model().unwrap();
        assert_eq!(HostModel::parse("again", &model.to_toml()).unwrap(), model);
    }

    #[test]
    fn bad_entries_are_named_with_their_place() {
        let text = default_model().unwrap().to_toml();
        let complaint = |old: &str, new: &str| {
            assert!(text.contains(old), "{old}");
            HostModel::parse("bad.toml", &text.replacen(old, new, 1)).unwrap_err().to_string()
        };
        for (old, new, expected) in [
            ("operand = ", "operand = -", "`operand` is -"),
            ("operand = ", "operands = ", "unknown field `operands`"),
            ("chained_run", "chaind_run", "unknown field `chaind_run`"),
            ("format = 1", "format = 7", "`format` is 7"),
            ("format = 1\n", "", "missing field `format`"),
        ] {
            let said = complaint(old, new);
            assert!(said.contains(expected) && said.contains("line "), "{said}");
        }
    }
}
