//! What a machine file must fulfil beyond its grammar.

use super::error::Defect;
use crate::model::machine::{ClassCounts, Expansion, MachineModel, add_scaled};
use crate::model::quantity::Quantity;
use std::collections::BTreeMap;
use stripmine_kernels::isa::op::OpClass;

/// Whether the numbers, notes and start-ups of a finished machine can be used.
pub(super) fn machine(machine: &MachineModel) -> Result<(), Defect> {
    whole("year", &machine.year)?;
    positive("clock_period_ns", &machine.clock_period_ns)?;
    at_most(LAST_YEAR, "year", &machine.year)?;
    if let Some(registers) = &machine.vector_registers {
        whole("vector_registers.count", &registers.count)?;
        whole("vector_registers.length", &registers.length)?;
    }
    if let Some(start_up) = &machine.default_start_up {
        positive("start_up.default", start_up)?;
    }
    for (class, start_up) in &machine.class_start_ups {
        positive(&format!("start_up.{}", class.name()), start_up)?;
    }
    for (entry, quantity) in machine.unit_quantities() {
        let counted = entry.ends_with(".count") || entry.ends_with("_ports");
        if counted { whole(&entry, quantity) } else { positive(&entry, quantity) }?;
    }
    start_ups_of_executed_classes(machine)?;
    units_of_executed_classes(machine)?;
    match machine.entries().into_iter().find(|entry| entry.note.trim().is_empty()) {
        Some(entry) => Err(Defect::EmptyNote { entry: entry.name }),
        None => Ok(()),
    }
}

/// Four digits.
const LAST_YEAR: f64 = 9999.0;
/// Above every number of a machine: with larger ones a sum of all that a program does might not be finite.
const MOST: f64 = 1e12;
/// Registers, their elements, units and ports are fewer.
const MOST_COUNTED: f64 = 1e6;
/// Operations that one operation may come to; a clock writes them out one by one.
const LONGEST_EXPANSION: u64 = 10_000;

fn positive(entry: &str, quantity: &Quantity) -> Result<(), Defect> {
    let value = quantity.value;
    if !(value.is_finite() && value > 0.0) {
        return Err(not_positive(entry, value));
    }
    at_most(MOST, entry, quantity)
}

fn at_most(most: f64, entry: &str, quantity: &Quantity) -> Result<(), Defect> {
    let value = quantity.value;
    if value <= most { Ok(()) } else { Err(Defect::TooLarge { entry: entry.to_owned(), value, most }) }
}

fn not_positive(entry: &str, value: f64) -> Defect {
    Defect::NotPositive { entry: entry.to_owned(), value }
}

fn whole(entry: &str, quantity: &Quantity) -> Result<(), Defect> {
    positive(entry, quantity)?;
    at_most(MOST_COUNTED, entry, quantity)?;
    let value = quantity.value;
    if value.fract() == 0.0 {
        return Ok(());
    }
    Err(Defect::NotWhole { entry: entry.to_owned(), value })
}

/// Whether an expansion has steps, and each of them at least one execution.
pub(super) fn steps(entry: &str, steps: &ClassCounts) -> Result<(), Defect> {
    if steps.is_empty() {
        return Err(Defect::EmptyExpansion { entry: entry.to_owned() });
    }
    match steps.iter().find(|&(_, &count)| count == 0) {
        Some((class, _)) => Err(not_positive(&format!("{entry}.{}", class.name()), 0.0)),
        None => Ok(()),
    }
}

/// Whether the machine executes `class` and does not always replace it by others.
fn is_executed(machine: &MachineModel, class: OpClass) -> bool {
    machine.expansions.get(&class).is_none_or(|own| own.steps.contains_key(&class))
}

/// Whether, where units are named, one of them serves every class that computes.
fn units_of_executed_classes(machine: &MachineModel) -> Result<(), Defect> {
    let lacks = |class: &&OpClass| {
        !class.moves_data() && is_executed(machine, **class) && machine.unit(**class).is_none()
    };
    match OpClass::ALL.iter().find(lacks) {
        Some(class) if machine.has_units() => {
            Err(Defect::NoUnit { entry: "units".to_owned(), class: class.name() })
        }
        _ => Ok(()),
    }
}

fn start_ups_of_executed_classes(machine: &MachineModel) -> Result<(), Defect> {
    let is_stated =
        |class: &OpClass| machine.default_start_up.is_some() || machine.class_start_ups.contains_key(class);
    match OpClass::ALL.iter().find(|class| is_executed(machine, **class) && !is_stated(class)) {
        Some(class) => {
            let entry = format!("start_up.{}", class.name());
            Err(Defect::MissingStartUp { entry })
        }
        None => Ok(()),
    }
}

/// The entries of the table `table` by the class that their key names.
pub(super) fn named_by_class<T>(
    table: &str,
    written: BTreeMap<String, T>,
) -> Result<BTreeMap<OpClass, T>, Defect> {
    written.into_iter().map(|(name, value)| Ok((class(&name, &format!("{table}.{name}"))?, value))).collect()
}

/// The class called `name`, which stands at `entry`.
pub(super) fn class(name: &str, entry: &str) -> Result<OpClass, Defect> {
    let known = OpClass::ALL.iter().copied().find(|class| class.name() == name);
    known.ok_or_else(|| Defect::UnknownClass { entry: entry.to_owned(), name: name.to_owned() })
}

/// What one operation of `class` comes to in classes that the machine executes.
pub(super) fn expand_fully(
    class: OpClass,
    expansions: &BTreeMap<OpClass, Expansion>,
) -> Result<ClassCounts, Defect> {
    let entry = || format!("expansions.{}", class.name());
    let executed = follow(class, expansions, &mut Vec::new())
        .map_err(|cycle| Defect::EndlessExpansion { entry: entry(), cycle })?;
    let count = executed.values().fold(0u64, |sum, count| sum.saturating_add(*count));
    if count > LONGEST_EXPANSION {
        return Err(Defect::LongExpansion { entry: entry(), count, most: LONGEST_EXPANSION });
    }
    Ok(executed)
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
