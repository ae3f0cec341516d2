//! Host files, as written by `calibrate`, in TOML.

use super::model::HostModel;
use crate::model::file::{FileEntry, FileKind};
use std::path::Path;
use stripmine_kernels::InstructionSet;
use stripmine_physics::input::InputErrors;

/// Format version that this program reads.
pub(crate) const FORMAT: u32 = 15;
const KIND: FileKind<HostModel> = FileKind {
    format: FORMAT,
    remedy: Some("calibrate again"),
    wrong: host_entry_error,
    completed: HostModel::checked,
};
/// Upper bound of the numbers of a host file: with larger ones the sum over a step might not be finite.
const MOST: f64 = 1e15;

impl HostModel {
    /// Reads a host file.
    ///
    /// # Errors
    /// [`InputErrors`]: the file cannot be read, or as for [`HostModel::parse`].
    pub fn load(path: &Path) -> Result<HostModel, InputErrors> {
        KIND.load(path)
    }

    /// Reads a host file's text; `file` is its name in errors.
    ///
    /// # Errors
    /// [`InputErrors`]: another format, every invalid entry, or a contradiction between valid ones.
    pub fn parse(file: &str, text: &str) -> Result<HostModel, InputErrors> {
        KIND.read(file, text)
    }

    /// Text of its file.
    ///
    /// # Errors
    /// Fails where TOML cannot represent an entry.
    pub fn to_toml(&self) -> Result<String, toml::ser::Error> {
        let mut value = toml::Value::try_from(self)?;
        round_numbers(&mut value);
        Ok(HEADING.to_owned() + &toml::to_string(&value)?)
    }

    /// Checks that the entries agree with each other.
    fn checked(self) -> Result<HostModel, (String, String)> {
        let wrong = |path: &str, what: String| Err((path.to_owned(), format!("`{path}` {what}")));
        let sets: Vec<&str> = InstructionSet::ALL.iter().map(|set| set.name()).collect();
        if !sets.contains(&&*self.instruction_set) {
            let what = format!("is \"{}\", but must be one of {}", self.instruction_set, sets.join(", "));
            return wrong("instruction_set", what);
        }
        for (path, list) in [("footprints", &self.footprints[..]), ("discs", &self.discs)] {
            if list.first().is_none_or(|&first| first <= 0.0) || list.windows(2).any(|two| two[0] >= two[1]) {
                return wrong(path, "must be positive and rise".to_owned());
            }
        }
        let footprints = self.footprints.len();
        let prices = self.programs.values().flat_map(|of| [&of.interpreted, &of.chained]);
        if let Some(of) = prices.map(|of| of.bytes.len()).find(|of| *of != footprints) {
            return wrong(
                "programs",
                format!("has {of} prices of a byte, but there are {footprints} footprints"),
            );
        }
        Ok(self)
    }
}

/// Describes the error of a number, if any.
fn host_entry_error(entry: &FileEntry<'_>) -> Option<String> {
    let number = entry.number()?;
    let (range, words) = match entry.names.last() {
        // Numbers of lanes and of elements.
        Some(&"lanes") => (1.0..=65_536.0, "a whole number from 1 to 65536".to_owned()),
        Some(&"shortest" | &"longest") => (1.0..=2_f64.powi(40), "a whole number from 1 to 2^40".to_owned()),
        _ => (0.0..=MOST, format!("from 0 to {MOST:e}")),
    };
    (!range.contains(&number)).then(|| format!("`{}` is {number}, but must be {words}", entry.path()))
}

/// Comment at the top of a host file.
const HEADING: &str = "\
# Prices of a host, measured by `stripmine calibrate`. Times are in nanoseconds, footprints in bytes. Each number is the median of
# its samples, under the load that the machine had.
#
# programs   prices of a run of a program, of the start of a pass, of an operation on an element, of its additional cost through an
#            index vector, and of a byte by the footprint between two visits; interpreted and in a compiled loop;
#            fitted to the programs of the lattice method on drill scenes
# rates      work whose amount depends on the data, by method, phase and precision: a step, disc, cell, candidate, contact, rebuild of
#            lists, disc whose lists are rebuilt, entry of these
";

/// Significant digits of a number in the file.
const DIGITS: i32 = 4;

/// Lists that must rise: rounded, two of their numbers might be equal.
const ABSCISSAS: [&str; 2] = ["footprints", "discs"];

/// Rounds numbers to the digits that a person reads.
fn round_numbers(value: &mut toml::Value) {
    match value {
        toml::Value::Float(number) if number.is_finite() && *number != 0.0 => {
            let places = DIGITS - 1 - number.abs().log10().floor() as i32;
            let text = format!("{number:.*}", places.clamp(0, 12) as usize);
            *number = text.parse().unwrap_or(*number);
        }
        toml::Value::Array(items) => items.iter_mut().for_each(round_numbers),
        toml::Value::Table(table) => {
            let rounded = table.iter_mut().filter(|(name, _)| !ABSCISSAS.contains(&name.as_str()));
            rounded.for_each(|(_, value)| round_numbers(value));
        }
        _ => {}
    }
}

/// Host model shipped with the program: that of the development machine.
///
/// # Errors
/// [`InputErrors`] never, as a test reads the shipped text.
pub fn default_model() -> Result<HostModel, InputErrors> {
    HostModel::parse("the shipped host model", include_str!("default.toml"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shipped_model_round_trips() {
        let model = default_model().unwrap();
        assert_eq!(HostModel::parse("again", &model.to_toml().unwrap()).unwrap(), model);
    }

    /// Numbers of discs that differ in the sixth digit only.
    #[test]
    fn rising_lists_are_written_exactly() {
        let mut model = default_model().unwrap();
        model.discs[1] = model.discs[0] * 1.000001;
        let again = HostModel::parse("again.toml", &model.to_toml().unwrap()).unwrap();
        assert_eq!(again.discs, model.discs);
    }

    #[test]
    fn invalid_entries_are_reported_with_location() {
        let text = default_model().unwrap().to_toml().unwrap();
        let complaint = |old: &str, new: &str| {
            assert!(text.contains(old), "{old}");
            HostModel::parse("bad.toml", &text.replacen(old, new, 1)).unwrap_err().to_string()
        };
        for (old, new, expected) in [
            ("\"avx512\"", "\"purple\"", "`instruction_set` is \"purple\"\n  expected: one of scalar, wide"),
            ("operation = ", "operations = ", "unknown field `operations`"),
            ("footprints = ", "footprint = ", "unknown field `footprint`"),
            ("format = 15", "format = 16", "`format` is 16"),
            ("format = 15", "format = 14\npace = 1.0", "`format` is 14\n  expected: 15"),
            ("format = 15\n", "", "missing field `format`"),
        ] {
            let said = complaint(old, new);
            assert!(said.contains(expected) && said.starts_with("bad.toml:"), "{said}");
        }
    }
}
