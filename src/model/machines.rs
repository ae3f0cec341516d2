//! Machines shipped with the program.

use super::machine::MachineModel;
use stripmine_physics::input::InputErrors;
use stripmine_physics::quoted::quoted;
use stripmine_physics::reported::{ErrorClass, Reported};
use stripmine_physics::words::suggestion;

macro_rules! embedded {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("machines/", $name, ".toml")))),*]
    };
}

/// Shipped machines: name and text of the file.
const PRESETS: &[(&str, &str)] = embedded![
    "paper",
    "cray-1",
    "cyber-205",
    "cray-y-mp-el",
    "sx-aurora",
    "spacemit-a100",
    "spacemit-x60",
    "spacemit-x100",
    "xuantie-c908",
    "sifive-x280",
];

/// Failures to find a machine.
#[derive(Debug, thiserror::Error)]
pub enum MachineError {
    /// No preset has this name, and it is not the path of a machine file.
    #[error(
        "unknown machine `{}`; known are {}, and machine files by a path that ends in .toml{}",
        quoted(name),
        known.join(", "),
        suggestion(name, known.iter().copied())
    )]
    Unknown {
        /// The requested name.
        name: String,
        /// All valid names.
        known: Vec<&'static str>,
    },
    /// A file cannot be used.
    #[error(transparent)]
    File(#[from] InputErrors),
}

impl Reported for MachineError {
    fn class(&self) -> ErrorClass {
        match self {
            MachineError::Unknown { .. } => ErrorClass::Usage,
            MachineError::File(error) => error.class(),
        }
    }

    fn inner_error(&self) -> Option<&dyn Reported> {
        if let MachineError::File(errors) = self { Some(errors) } else { None }
    }

    fn remedy(&self) -> Option<String> {
        matches!(self, MachineError::Unknown { .. })
            .then(|| "use one of the known machines, or write a machine file".to_owned())
    }
}

/// Names of the presets, the paper's own machine first.
pub fn names() -> impl Iterator<Item = &'static str> {
    PRESETS.iter().map(|&(name, _)| name)
}

/// Finds a machine by name: a preset, or the file at that path, if it ends in `.toml`.
///
/// # Errors
/// [`MachineError`] if no preset has that name, or the file is invalid.
pub fn find(name: &str) -> Result<MachineModel, MachineError> {
    if !name.ends_with(".toml") {
        return preset(name);
    }
    Ok(MachineModel::load(name)?)
}

/// Returns a preset by name.
///
/// # Errors
/// [`MachineError::Unknown`] if no preset has that name.
pub fn preset(name: &str) -> Result<MachineModel, MachineError> {
    let (known, text) = PRESETS
        .iter()
        .find(|&&(known, _)| known == name)
        .ok_or_else(|| MachineError::Unknown { name: name.to_owned(), known: names().collect() })?;
    // The texts are part of the program and covered by a test, so parsing cannot fail here.
    Ok(MachineModel::parse(known, text)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use OpClass::{Add, Divide, Load, Logical, Multiply};
    use stripmine_kernels::isa::op::{Op, OpClass, OpCounts};

    #[test]
    fn every_preset_parses_and_knows_all_start_ups() {
        for name in names() {
            let machine = preset(name).unwrap();
            // Every operation that a program counts must expand to classes with a start-up.
            let mut counts = OpCounts::default();
            Op::ALL.iter().for_each(|&op| counts.record(op));
            for class in machine.expand(&counts).into_keys() {
                let has_time = machine.start_up(class) > 0.0 || machine.whole_registers.is_some();
                assert!(has_time, "{name}: {}", class.name());
            }
        }
    }

    #[test]
    fn paper_machine_has_one_start_up() {
        let machine = preset("paper").unwrap();
        assert!(OpClass::ALL.iter().all(|&class| machine.start_up(class) == 20.0));
        assert!(OpClass::ALL.iter().all(|&class| !machine.expansions.contains_key(class.name())));
        assert_eq!(machine.vector_registers, None);
        assert_eq!(machine.assumed(), [""; 0]);
    }

    #[test]
    fn expansions_nest_and_multiply() {
        let machine = preset("cray-1").unwrap();
        let mut counts = OpCounts::default();
        (0..5).for_each(|_| counts.record(Op::SquareRoot));
        (0..2).for_each(|_| counts.record(Op::Divide));
        counts.record(Op::Load);
        // A square root consists of 3 quotients, 4 products, 4 sums and 4 bit operations; a quotient of 3 products.
        let expected =
            [(Add, 5 * 4), (Multiply, 5 * (4 + 3 * 3) + 2 * 3), (Divide, 5 * 3 + 2), (Logical, 5 * 4)];
        assert_eq!(machine.expand(&counts), expected.into_iter().chain([(Load, 1)]).collect());
    }

    #[test]
    fn unknown_machine_error_lists_known_names() {
        let error = preset("cray-3").unwrap_err();
        assert_eq!(
            error.to_string(),
            "unknown machine `cray-3`; known are paper, cray-1, cyber-205, cray-y-mp-el, sx-aurora, spacemit-a100, \
             spacemit-x60, spacemit-x100, xuantie-c908, sifive-x280, and machine files by a path that ends in .toml\n  \
             help: did you mean cray-1?"
        );
    }

    #[test]
    fn assumed_entries_are_listed_by_name() {
        let assumed = preset("cray-1").unwrap().assumed();
        assert!(assumed.contains(&"expansions.square_root".to_owned()));
        assert!(!assumed.contains(&"start_up.multiply".to_owned()));
    }
}
