//! What a machine file must fulfil beyond its grammar.

use super::MachineFileError;
use crate::model::machine::{ClassCounts, Expansion, MachineModel, Quantity, add_scaled};
use std::collections::BTreeMap;
use stripmine_kernels::isa::op::OpClass;

/// The checks of one file; they look at different entries and report the same file name.
pub(super) struct Check<'a> {
    pub(super) file: &'a str,
}

impl Check<'_> {
    /// Whether the numbers, notes and start-ups of a finished machine can be used.
    pub(super) fn machine(&self, machine: &MachineModel) -> Result<(), MachineFileError> {
        self.whole("year", &machine.year)?;
        self.positive("clock_period_ns", &machine.clock_period_ns)?;
        if let Some(registers) = &machine.vector_registers {
            self.whole("vector_registers.count", &registers.count)?;
            self.whole("vector_registers.length", &registers.length)?;
        }
        if let Some(start_up) = &machine.default_start_up {
            self.positive("start_up.default", start_up)?;
        }
        for (class, start_up) in &machine.class_start_ups {
            self.positive(&format!("start_up.{}", class.name()), start_up)?;
        }
        self.start_ups_of_executed_classes(machine)?;
        match machine.entries().into_iter().find(|entry| entry.note.trim().is_empty()) {
            Some(entry) => Err(MachineFileError::EmptyNote { file: self.file.to_owned(), entry: entry.name }),
            None => Ok(()),
        }
    }

    fn positive(&self, entry: &str, quantity: &Quantity) -> Result<(), MachineFileError> {
        let value = quantity.value;
        if value.is_finite() && value > 0.0 { Ok(()) } else { Err(self.not_positive(entry, value)) }
    }

    fn not_positive(&self, entry: &str, value: f64) -> MachineFileError {
        MachineFileError::NotPositive { file: self.file.to_owned(), entry: entry.to_owned(), value }
    }

    fn whole(&self, entry: &str, quantity: &Quantity) -> Result<(), MachineFileError> {
        self.positive(entry, quantity)?;
        let value = quantity.value;
        if value.fract() == 0.0 {
            return Ok(());
        }
        Err(MachineFileError::NotWhole { file: self.file.to_owned(), entry: entry.to_owned(), value })
    }

    /// Whether an expansion has steps, and each of them at least one execution.
    pub(super) fn steps(&self, entry: &str, steps: &ClassCounts) -> Result<(), MachineFileError> {
        if steps.is_empty() {
            return Err(MachineFileError::EmptyExpansion {
                file: self.file.to_owned(),
                entry: entry.to_owned(),
            });
        }
        match steps.iter().find(|&(_, &count)| count == 0) {
            Some((class, _)) => Err(self.not_positive(&format!("{entry}.{}", class.name()), 0.0)),
            None => Ok(()),
        }
    }

    fn start_ups_of_executed_classes(&self, machine: &MachineModel) -> Result<(), MachineFileError> {
        let is_executed =
            |class: &OpClass| machine.expansions.get(class).is_none_or(|own| own.steps.contains_key(class));
        let is_stated = |class: &OpClass| {
            machine.default_start_up.is_some() || machine.class_start_ups.contains_key(class)
        };
        match OpClass::ALL.iter().find(|class| is_executed(class) && !is_stated(class)) {
            Some(class) => {
                let entry = format!("start_up.{}", class.name());
                Err(MachineFileError::MissingStartUp { file: self.file.to_owned(), entry })
            }
            None => Ok(()),
        }
    }

    /// The entries of the table `table` by the class that their key names.
    pub(super) fn named_by_class<T>(
        &self,
        table: &str,
        written: BTreeMap<String, T>,
    ) -> Result<BTreeMap<OpClass, T>, MachineFileError> {
        written
            .into_iter()
            .map(|(name, value)| match OpClass::ALL.iter().find(|class| class.name() == name) {
                Some(&class) => Ok((class, value)),
                None => {
                    let entry = format!("{table}.{name}");
                    Err(MachineFileError::UnknownClass { file: self.file.to_owned(), entry })
                }
            })
            .collect()
    }

    /// What one operation of `class` comes to in classes that the machine executes.
    pub(super) fn expand_fully(
        &self,
        class: OpClass,
        expansions: &BTreeMap<OpClass, Expansion>,
    ) -> Result<ClassCounts, MachineFileError> {
        follow(class, expansions, &mut Vec::new()).map_err(|cycle| MachineFileError::EndlessExpansion {
            file: self.file.to_owned(),
            entry: format!("expansions.{}", class.name()),
            cycle,
        })
    }
}

/// Follows the expansion of `class` to its end; `open` holds the classes being expanded, an error the circle.
fn follow(
    class: OpClass,
    expansions: &BTreeMap<OpClass, Expansion>,
    open: &mut Vec<OpClass>,
) -> Result<ClassCounts, Vec<&'static str>> {
    let Some(expansion) = expansions.get(&class) else { return Ok(ClassCounts::from([(class, 1)])) };
    let circle = open.contains(&class);
    open.push(class);
    if circle {
        return Err(open.iter().map(|class| class.name()).collect());
    }
    let mut total = ClassCounts::new();
    for (&step, &times) in &expansion.steps {
        let executed =
            if step == class { ClassCounts::from([(class, 1)]) } else { follow(step, expansions, open)? };
        add_scaled(&mut total, &executed, times);
    }
    open.pop();
    Ok(total)
}
