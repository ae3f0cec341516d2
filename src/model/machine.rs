//! Machines of the timing model, and the presets that come with the program.

use super::machine_file::MachineFileError;
use super::units::{MemoryPorts, Units};
use crate::quoted::quoted;
use serde::Deserialize;
use std::collections::BTreeMap;
use stripmine_kernels::isa::op::{OpClass, OpCounts};

/// Where a number comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Provenance {
    /// Printed in the source that the note names.
    Sourced,
    /// Follows from sourced facts, by the argument in the note.
    Derived,
    /// Our choice, for the reason in the note; no source we could point to.
    Assumed,
}

impl Provenance {
    /// The name in tables and machine files.
    pub const fn name(self) -> &'static str {
        match self {
            Provenance::Sourced => "sourced",
            Provenance::Derived => "derived",
            Provenance::Assumed => "assumed",
        }
    }
}

/// A number with its provenance; the unit is that of the entry it stands for.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Quantity {
    /// The number itself, positive and finite.
    pub value: f64,
    /// Whether it was printed somewhere, follows from something or is our choice.
    pub provenance: Provenance,
    /// The source, the derivation or the reason; never empty.
    pub note: String,
}

/// A property that a machine has or has not, with its provenance.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fact {
    /// Whether it has it.
    pub value: bool,
    /// Whether it was printed somewhere, follows from something or is our choice.
    pub provenance: Provenance,
    /// The source, the derivation or the reason; never empty.
    pub note: String,
}

/// The vector registers of one processor.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VectorRegisters {
    /// How many there are.
    pub count: Quantity,
    /// Elements in each.
    pub length: Quantity,
}

/// Executions per class of operations; classes that do not occur are absent.
pub type ClassCounts = BTreeMap<OpClass, u64>;

/// How a machine carries out one operation of a class that it lacks.
///
/// The counts come from one sequence of operations and so share one provenance.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Expansion {
    /// Executions that replace one operation. The class itself, where it occurs, stands for the unit of the
    /// machine that serves it (`divide` for the reciprocal approximation) and is not expanded again.
    pub steps: ClassCounts,
    /// Whether the sequence was printed somewhere, follows from something or is our choice.
    pub provenance: Provenance,
    /// The source, the derivation or the reason; never empty.
    pub note: String,
}

/// The provenance of one entry of a machine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry<'a> {
    /// The entry as its file writes it, such as `start_up.add`.
    pub name: String,
    /// Where its number or numbers come from.
    pub provenance: Provenance,
    /// The source, the derivation or the reason.
    pub note: &'a str,
}

/// One processor of a vector machine: start-ups, registers and the operations it has to put together.
#[derive(Clone, Debug, PartialEq)]
pub struct MachineModel {
    pub(super) title: String,
    pub(super) year: Quantity,
    pub(super) clock_period_ns: Quantity,
    pub(super) vector_registers: Option<VectorRegisters>,
    pub(super) chaining: Option<Fact>,
    pub(super) loop_overhead: Option<Quantity>,
    pub(super) units: Units,
    pub(super) memory: Option<MemoryPorts>,
    pub(super) default_start_up: Option<Quantity>,
    pub(super) class_start_ups: BTreeMap<OpClass, Quantity>,
    pub(super) expansions: BTreeMap<OpClass, Expansion>,
    /// The expansions followed to the end, down to classes that the machine executes.
    pub(super) executed: BTreeMap<OpClass, ClassCounts>,
}

impl MachineModel {
    /// The name of the machine in a heading.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// The year of the first delivery, or of publication where the machine is a model.
    pub fn year(&self) -> &Quantity {
        &self.year
    }

    /// The clock period in nanoseconds.
    pub fn clock_period_ns(&self) -> &Quantity {
        &self.clock_period_ns
    }

    /// The vector registers; `None` where vectors of any length are worked on in one go.
    pub fn vector_registers(&self) -> Option<&VectorRegisters> {
        self.vector_registers.as_ref()
    }

    /// The start-up D of an operation of `class`, in clock periods: BP93 section 3, the pipeline depth.
    ///
    /// Zero for a class that never executes because its expansion does without it.
    pub fn start_up(&self, class: OpClass) -> f64 {
        self.class_start_ups
            .get(&class)
            .or(self.default_start_up.as_ref())
            .map_or(0.0, |start_up| start_up.value)
    }

    /// How the machine carries out an operation of `class`; `None` where it has the operation.
    pub fn expansion(&self, class: OpClass) -> Option<&Expansion> {
        self.expansions.get(&class)
    }

    /// The operations executed for one of `class`: itself, or its expansion followed to the end.
    pub fn steps(&self, class: OpClass) -> ClassCounts {
        self.executed.get(&class).cloned().unwrap_or_else(|| ClassCounts::from([(class, 1)]))
    }

    /// The operations executed for `counts`, once those that the machine lacks are expanded.
    ///
    /// Saturates where a count leaves the range of `u64`.
    pub fn expand(&self, counts: &OpCounts) -> ClassCounts {
        let mut executed = ClassCounts::new();
        for &class in OpClass::ALL {
            match counts.of_class(class) {
                0 => {}
                count => add_scaled(&mut executed, &self.steps(class), count),
            }
        }
        executed
    }

    /// Every entry that carries numbers, in the order of a machine file.
    pub fn entries(&self) -> Vec<Entry<'_>> {
        let registers = self.vector_registers.iter();
        let quantities =
            [("year".to_owned(), &self.year), ("clock_period_ns".to_owned(), &self.clock_period_ns)]
                .into_iter()
                .chain(registers.flat_map(|registers| {
                    [
                        ("vector_registers.count".to_owned(), &registers.count),
                        ("vector_registers.length".to_owned(), &registers.length),
                    ]
                }))
                .chain(self.default_start_up.iter().map(|start_up| ("start_up.default".to_owned(), start_up)))
                .chain(
                    self.class_start_ups
                        .iter()
                        .map(|(class, start_up)| (format!("start_up.{}", class.name()), start_up)),
                )
                .chain(self.unit_quantities())
                .map(|(name, quantity)| Entry {
                    name,
                    provenance: quantity.provenance,
                    note: &quantity.note,
                });
        let chaining = self.chaining.iter().map(|fact| Entry {
            name: "chaining".to_owned(),
            provenance: fact.provenance,
            note: &fact.note,
        });
        let expansions = self.expansions.iter().map(|(class, expansion)| Entry {
            name: format!("expansions.{}", class.name()),
            provenance: expansion.provenance,
            note: &expansion.note,
        });
        quantities.chain(chaining).chain(expansions).collect()
    }

    /// The same machine with every assumed start-up, and an assumed loop overhead, at zero: what a result keeps without
    /// them.
    #[must_use]
    pub fn without_assumed_start_ups(&self) -> MachineModel {
        let mut known = self.clone();
        let start_ups = known.class_start_ups.values_mut().chain(&mut known.default_start_up);
        let quantities = start_ups.chain(&mut known.loop_overhead);
        quantities
            .filter(|quantity| quantity.provenance == Provenance::Assumed)
            .for_each(|quantity| quantity.value = 0.0);
        known
    }

    /// Names of the entries whose numbers are our own choice.
    pub fn assumed(&self) -> Vec<String> {
        self.entries()
            .into_iter()
            .filter(|entry| entry.provenance == Provenance::Assumed)
            .map(|entry| entry.name)
            .collect()
    }
}

/// Adds `times` executions of every step to `total`.
pub(super) fn add_scaled(total: &mut ClassCounts, steps: &ClassCounts, times: u64) {
    for (&class, &each) in steps {
        let count = total.entry(class).or_default();
        *count = count.saturating_add(each.saturating_mul(times));
    }
}

macro_rules! embedded {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("machines/", $name, ".toml")))),*]
    };
}

/// The machines that come with the program: name and text of the file.
const PRESETS: &[(&str, &str)] = embedded![
    "paper",
    "cray-1",
    "cyber-205",
    "cray-x-mp",
    "cray-y-mp",
    "nec-sx-3",
    "cray-c90",
    "cray-y-mp-el",
    "cray-j90",
    "sx-aurora",
];

/// Why there is no such machine.
#[derive(Debug, thiserror::Error)]
pub enum MachineError {
    /// No preset has the name asked for, and it does not look like that of a file.
    #[error(
        "unknown machine `{}`; known are {}, and machine files by their path, which ends in .toml",
        quoted(name),
        known.join(", ")
    )]
    Unknown {
        /// The name asked for.
        name: String,
        /// All names that would have done.
        known: Vec<&'static str>,
    },
    /// A file that cannot be read.
    #[error("machine file `{}`: {cause}", quoted(file))]
    Read {
        /// Name of the file.
        file: String,
        /// What the system said.
        cause: std::io::Error,
    },
    /// A file that cannot be used.
    #[error(transparent)]
    File(#[from] MachineFileError),
}

/// The names of the presets, the paper's own machine first.
pub fn names() -> impl Iterator<Item = &'static str> {
    PRESETS.iter().map(|&(name, _)| name)
}

/// The machine called `name`: a preset, or the file at that path, if it ends in `.toml`.
///
/// # Errors
/// [`MachineError`] where no preset has that name, or the file is bad.
pub fn find(name: &str) -> Result<MachineModel, MachineError> {
    if !name.ends_with(".toml") {
        return preset(name);
    }
    MachineModel::load(name)
}

/// The preset called `name`.
///
/// # Errors
/// [`MachineError::Unknown`] where no preset has that name.
pub fn preset(name: &str) -> Result<MachineModel, MachineError> {
    let (known, text) = PRESETS
        .iter()
        .find(|&&(known, _)| known == name)
        .ok_or_else(|| MachineError::Unknown { name: name.to_owned(), known: names().collect() })?;
    // The texts are part of the program and a test reads them all: no user can get here with a bad one.
    Ok(MachineModel::parse(known, text)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use OpClass::{Add, Divide, Load, Logical, Multiply};
    use stripmine_kernels::isa::op::Op;

    #[test]
    fn every_preset_parses_and_states_where_each_number_comes_from() {
        for name in names() {
            let machine = preset(name).unwrap();
            let entries = machine.entries();
            assert!(entries.iter().all(|entry| !entry.note.trim().is_empty()), "{name}");
            // Whatever a program counts must end in classes with a start-up.
            let mut counts = OpCounts::default();
            Op::ALL.iter().for_each(|&op| counts.record(op));
            for class in machine.expand(&counts).into_keys() {
                assert!(machine.start_up(class) > 0.0, "{name}: {}", class.name());
            }
        }
    }

    #[test]
    fn the_paper_machine_has_one_start_up_and_lacks_nothing() {
        let machine = preset("paper").unwrap();
        assert!(OpClass::ALL.iter().all(|&class| machine.start_up(class) == 20.0));
        assert!(OpClass::ALL.iter().all(|&class| machine.expansion(class).is_none()));
        assert_eq!(machine.vector_registers(), None);
        assert_eq!(machine.assumed(), [""; 0]);
    }

    #[test]
    fn expansions_nest_and_multiply() {
        let machine = preset("cray-1").unwrap();
        let mut counts = OpCounts::default();
        (0..5).for_each(|_| counts.record(Op::SquareRoot));
        (0..2).for_each(|_| counts.record(Op::Divide));
        counts.record(Op::Load);
        // A square root holds 3 quotients, 4 products, 4 sums and 4 bit operations; a quotient 3 products.
        let expected =
            [(Add, 5 * 4), (Multiply, 5 * (4 + 3 * 3) + 2 * 3), (Divide, 5 * 3 + 2), (Logical, 5 * 4)];
        assert_eq!(machine.expand(&counts), expected.into_iter().chain([(Load, 1)]).collect());
    }

    #[test]
    fn an_unknown_machine_is_answered_with_the_known_names() {
        let error = preset("cray-3").unwrap_err();
        assert_eq!(
            error.to_string(),
            "unknown machine `cray-3`; known are paper, cray-1, cyber-205, cray-x-mp, cray-y-mp, nec-sx-3, \
             cray-c90, cray-y-mp-el, cray-j90, sx-aurora, and machine files by their path, which ends in .toml"
        );
    }

    #[test]
    fn assumed_entries_are_listed_by_name() {
        let assumed = preset("cray-1").unwrap().assumed();
        assert!(assumed.contains(&"expansions.square_root".to_owned()));
        assert!(!assumed.contains(&"start_up.multiply".to_owned()));
    }
}
