//! Host files: what `calibrate` writes, as TOML.

use super::{HostModel, Residual, Transfer};
use crate::model::machine_file::Position;

/// The version of the file format that this program reads.
pub const FORMAT: u32 = 11;

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
    /// Entries that cannot be, all of them, a line each.
    #[error("{}", lines(file, entries))]
    Content {
        /// Name of the file.
        file: String,
        /// Every one of them.
        entries: Vec<BadEntry>,
    },
}

/// An entry of a host file that cannot be.
#[derive(Clone, Debug, PartialEq)]
pub struct BadEntry {
    /// Where.
    pub position: Option<Position>,
    /// The entry.
    pub entry: String,
    /// What is wrong.
    pub what: String,
}

fn lines(file: &str, entries: &[BadEntry]) -> String {
    let line = |bad: &BadEntry| {
        let at = bad.position.map_or(String::new(), |at| format!(", {at}"));
        format!("host file `{file}`{at}: `{}` {}", bad.entry, bad.what)
    };
    entries.iter().map(line).collect::<Vec<_>>().join("\n")
}

impl HostModel {
    /// Reads a host file; `file` is the name that errors give it.
    ///
    /// # Errors
    /// [`HostFileError`]: the grammar's first defect, or every entry that cannot be.
    pub fn parse(file: &str, text: &str) -> Result<HostModel, HostFileError> {
        let model: HostModel = toml::from_str(text)
            .map_err(|cause| HostFileError::Syntax { file: file.to_owned(), cause: Box::new(cause) })?;
        let defects = model.defects().into_iter();
        let entries: Vec<BadEntry> = defects
            .map(|(entry, what)| BadEntry { position: Position::of(text, &entry), entry, what })
            .collect();
        if entries.is_empty() {
            Ok(model)
        } else {
            Err(HostFileError::Content { file: file.to_owned(), entries })
        }
    }

    /// The text of its file.
    pub fn to_toml(&self) -> String {
        // A model is tables of numbers and words, which TOML can always say.
        toml::to_string(self).unwrap_or_default()
    }

    /// The entries that cannot be, and why.
    fn defects(&self) -> Vec<(String, String)> {
        let mut defects = vec![];
        if self.format != FORMAT {
            let what = format!("is {}, but this program reads {FORMAT}", self.format);
            defects.push(("format".to_owned(), what));
        }
        let lanes = self.lanes.iter().flat_map(|(lane, costs)| {
            let passes = costs.passes.iter().flat_map(move |(op, cost)| {
                [("element", cost.element.value), ("start", cost.start.value)]
                    .map(|(what, value)| (format!("lanes.{lane}.passes.{op}.{what}.value"), value))
            });
            passes.chain([(format!("lanes.{lane}.array_operand"), costs.array_operand)])
        });
        let levels = self.levels.iter().flat_map(|level| {
            [level.passes, level.loops].into_iter().flat_map(
                |Transfer { fetch, fetch_array, write_back, first, line }| {
                    [fetch, fetch_array, write_back, first, line]
                },
            )
        });
        let lists = self.lanes.iter().map(|(lane, costs)| (format!("lanes.{lane}"), &costs.seen));
        let seen = lists.chain([("loops".to_owned(), &self.loops.seen)]).flat_map(|(of, seen)| {
            let all = seen.iter().map(move |(name, seen)| (format!("{of}.seen.{name}"), seen));
            all.flat_map(|(name, seen)| {
                [
                    ("element.value", seen.element.value),
                    ("start.value", seen.start.value),
                    ("rest.element.value", seen.rest.element.value),
                    ("rest.start.value", seen.rest.start.value),
                    ("factors.computing", seen.factors.computing),
                    ("factors.waiting", seen.factors.waiting),
                    ("factors.beyond", seen.factors.beyond.iter().sum()),
                ]
                .map(|(what, value)| (format!("{name}.{what}"), value))
            })
        });
        let lists = self.lanes.iter().map(|(lane, costs)| (format!("lanes.{lane}"), &costs.seen));
        let unsound = lists.chain([("loops".to_owned(), &self.loops.seen)]).flat_map(|(of, seen)| {
            let bad = seen.iter().filter(|(_, seen)| !seen.residuals.iter().all(Residual::is_sound));
            bad.map(move |(name, _)| format!("{of}.seen.{name}.residuals"))
        });
        let what = "holds a number that is not finite, a negative one or a ratio of nought";
        defects.extend(unsound.map(|entry| (entry, what.to_owned())));
        let rates = self.rates.iter().flat_map(|(method, rates)| {
            let points = rates.0.values().flat_map(|phases| phases.values()).flatten();
            points.flat_map(|point| point.ns.values()).map(move |&ns| (format!("rates.{method}"), ns))
        });
        let rest = [
            ("operand", self.operand),
            ("begin", self.begin),
            ("bind", self.bind),
            ("run", self.run),
            ("clock", self.clock),
            ("loops.overlap", self.loops.overlap),
            ("measured.spread", self.measured.spread),
            ("measured.yardstick", self.measured.yardstick),
            ("measured.quiet", self.measured.quiet),
        ];
        let rest = rest.map(|(entry, value)| (entry.to_owned(), value));
        let levels = levels.map(|value| ("levels".to_owned(), value));
        for (entry, value) in rest.into_iter().chain(levels).chain(lanes).chain(seen).chain(rates) {
            if !(value.is_finite() && value >= 0.0) {
                defects.push((entry, format!("is {value}, but must be finite and not negative")));
            }
        }
        if self.levels.is_empty() || self.lanes.is_empty() {
            defects.push(("levels".to_owned(), "with `lanes` must not be empty".to_owned()));
        }
        defects
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
            ("run = ", "run = -", "`run` is -"),
            ("run = ", "runs = ", "unknown field `runs`"),
            ("overlap", "overlapp", "unknown field `overlapp`"),
            ("residuals = [[", "residuals = [[-1.0, 1.0, 1.0, 1.0], [", "residuals` holds a number"),
            ("format = 11", "format = 12", "`format` is 12"),
            ("format = 11\n", "", "missing field `format`"),
        ] {
            let said = complaint(old, new);
            assert!(said.contains(expected) && said.contains("line "), "{said}");
        }
    }
}
