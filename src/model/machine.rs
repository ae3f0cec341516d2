//! A machine of the timing model.

use super::quantity::{Fact, Provenance, Quantity};
use super::units::{MemoryPorts, Occupied, Resource, Units};
use serde::Deserialize;
use std::collections::BTreeMap;
use stripmine_kernels::isa::op::{OpClass, OpCounts};

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

    /// Whether the machine says which operations can run at once.
    pub fn has_units(&self) -> bool {
        !self.units.is_empty()
    }

    /// Whether a result feeds the next instruction element by element.
    pub fn chains(&self) -> bool {
        self.chaining.as_ref().is_some_and(|chaining| chaining.value)
    }

    /// Clock periods of the loop around the strips; none where nothing is said.
    pub fn loop_overhead(&self) -> Option<&Quantity> {
        self.loop_overhead.as_ref()
    }

    /// What an instruction of `class` occupies; none where the machine says nothing of it.
    pub fn unit(&self, class: OpClass) -> Option<Occupied<'_>> {
        let number =
            |quantity: &Option<Quantity>, otherwise| quantity.as_ref().map_or(otherwise, |q| q.value);
        if !class.moves_data() {
            let (name, unit) = self.units.iter().find(|(_, unit)| unit.serves.contains(&class))?;
            let rate = number(&unit.rate, 1.0);
            return Some(Occupied { resource: Resource::Unit(name), count: unit.count.value, rate });
        }
        let memory = self.memory.as_ref()?;
        let rate = number(&memory.rate, 1.0);
        let rate = match class {
            OpClass::Gather | OpClass::Scatter => number(&memory.gather_rate, rate),
            _ => rate,
        };
        Some(match (class, &memory.store_ports) {
            (OpClass::Store | OpClass::Scatter, Some(ports)) => {
                Occupied { resource: Resource::Stores, count: ports.value, rate }
            }
            _ => Occupied { resource: Resource::Loads, count: memory.load_ports.value, rate },
        })
    }

    /// The numbers of units, ports and strips, by the names of their entries in a machine file.
    pub(super) fn unit_quantities(&self) -> Vec<(String, &Quantity)> {
        let mut quantities: Vec<(String, &Quantity)> = vec![];
        quantities.extend(self.loop_overhead.iter().map(|quantity| ("loop_overhead".to_owned(), quantity)));
        for (name, unit) in &self.units {
            quantities.push((format!("units.{name}.count"), &unit.count));
            quantities.extend(unit.rate.iter().map(|rate| (format!("units.{name}.rate"), rate)));
        }
        if let Some(memory) = &self.memory {
            quantities.push(("memory.load_ports".to_owned(), &memory.load_ports));
            let rest = [
                ("memory.store_ports", &memory.store_ports),
                ("memory.rate", &memory.rate),
                ("memory.gather_rate", &memory.gather_rate),
            ];
            quantities.extend(rest.into_iter().filter_map(|(name, q)| Some((name.to_owned(), q.as_ref()?))));
        }
        quantities
    }
}

/// Adds `times` executions of every step to `total`.
pub(super) fn add_scaled(total: &mut ClassCounts, steps: &ClassCounts, times: u64) {
    for (&class, &each) in steps {
        let count = total.entry(class).or_default();
        *count = count.saturating_add(each.saturating_mul(times));
    }
}
