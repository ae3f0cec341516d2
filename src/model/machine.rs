//! A machine of the timing model.

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

/// A number or a fact with its provenance; the unit is that of the entry it stands for.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table of value, provenance and note")]
pub(crate) struct Known<T> {
    /// The number, positive and finite, or the fact.
    pub value: T,
    /// Says whether it was printed somewhere, follows from something or is our choice.
    pub provenance: Provenance,
    /// The source, the derivation or the reason; never empty.
    pub(crate) note: String,
}

/// A number with its provenance.
pub(crate) type Quantity = Known<f64>;

/// The vector registers of one processor.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct VectorRegisters {
    pub(super) count: Quantity,
    /// Elements in each.
    pub(super) length: Quantity,
}

/// Functional units of one kind.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Unit {
    /// Names of the classes that they serve.
    serves: Vec<String>,
    /// Instructions of these classes that run at once.
    count: Quantity,
    /// Elements a clock period of each; 1 by default.
    rate: Option<Quantity>,
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MemoryPorts {
    /// Loads that run at once; loads and stores together where there are no ports for stores.
    load_ports: Quantity,
    /// Stores that run at once; none where they share the ports of the loads.
    store_ports: Option<Quantity>,
    /// Elements a clock period of each port; 1 by default.
    rate: Option<Quantity>,
    /// Elements a clock period through an index vector; as `rate` by default.
    gather_rate: Option<Quantity>,
}

/// Executions per class of operations; classes that do not occur are absent.
pub(crate) type ClassCounts = BTreeMap<OpClass, u64>;

/// Executions that replace one operation of a class that a machine lacks.
///
/// The class itself, where it occurs, stands for the unit of the machine that serves it (`divide` for the reciprocal
/// approximation) and is not expanded again. All counts come from one sequence of operations and so share one provenance.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Expansion {
    pub(super) steps: BTreeMap<String, u64>,
    provenance: Provenance,
    #[serde(rename = "note")]
    _note: String,
}

/// Something that instructions compete for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Resource<'m> {
    /// Functional units of a kind, by name.
    Unit(&'m str),
    /// The ports of loads.
    Loads,
    /// The ports of stores.
    Stores,
}

/// A resource that an instruction occupies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Occupied<'m> {
    pub(crate) resource: Resource<'m>,
    /// Instructions that find place at once.
    pub count: f64,
    /// Elements a clock period.
    pub rate: f64,
}

/// One processor of a vector machine, as its file states it. Classes of operations go by their names. A clock that needs what is left
/// out charges as the clock before it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MachineModel {
    format: u32,
    pub(super) title: String,
    year: Quantity,
    pub(super) clock_period_ns: Quantity,
    /// Whether a result feeds the next instruction element by element.
    chaining: Option<Known<bool>>,
    /// Clock periods of each strip.
    pub(super) loop_overhead: Option<Quantity>,
    /// None where vectors have any length.
    pub(super) vector_registers: Option<VectorRegisters>,
    /// Clock periods by class; `default` is for all classes that are not named.
    pub(super) start_up: BTreeMap<String, Quantity>,
    #[serde(default)]
    units: BTreeMap<String, Unit>,
    memory: Option<MemoryPorts>,
    #[serde(default)]
    pub(super) expansions: BTreeMap<String, Expansion>,
    /// The expansions followed to the end, down to classes that the machine executes.
    #[serde(skip)]
    pub(super) executed: BTreeMap<OpClass, ClassCounts>,
}

/// The start-up of classes that are not named.
pub(super) const DEFAULT: &str = "default";

impl MachineModel {
    /// The name of the machine in a heading.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// The clock period in nanoseconds.
    pub fn clock_period_ns(&self) -> f64 {
        self.clock_period_ns.value
    }

    /// The start-up D of an operation of `class`, in clock periods: BP93 section 3, the pipeline depth.
    ///
    /// Zero for a class that never executes because its expansion does without it.
    pub(crate) fn start_up(&self, class: OpClass) -> f64 {
        let start_up = self.start_up.get(class.name()).or_else(|| self.start_up.get(DEFAULT));
        start_up.map_or(0.0, |start_up| start_up.value)
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

    /// The same machine with every assumed start-up, and an assumed loop overhead, at zero: what a result keeps without
    /// them.
    #[must_use]
    pub(crate) fn without_assumed_start_ups(&self) -> MachineModel {
        let mut known = self.clone();
        let quantities = known.start_up.values_mut().chain(&mut known.loop_overhead);
        quantities
            .filter(|quantity| quantity.provenance == Provenance::Assumed)
            .for_each(|quantity| quantity.value = 0.0);
        known
    }

    /// Names of the entries that are our own choice, such as `start_up.add`.
    pub(crate) fn assumed(&self) -> Vec<String> {
        let mut all: Vec<(String, Option<Provenance>)> = vec![];
        let mut add = |name: String, it: Option<&Quantity>| all.push((name, it.map(|it| it.provenance)));
        let (registers, memory) = (self.vector_registers.as_ref(), self.memory.as_ref());
        add("year".to_owned(), Some(&self.year));
        add("clock_period_ns".to_owned(), Some(&self.clock_period_ns));
        add("vector_registers.count".to_owned(), registers.map(|it| &it.count));
        add("vector_registers.length".to_owned(), registers.map(|it| &it.length));
        for name in [DEFAULT].into_iter().chain(OpClass::ALL.iter().map(|class| class.name())) {
            add(format!("start_up.{name}"), self.start_up.get(name));
        }
        add("loop_overhead".to_owned(), self.loop_overhead.as_ref());
        for (name, unit) in &self.units {
            add(format!("units.{name}.count"), Some(&unit.count));
            add(format!("units.{name}.rate"), unit.rate.as_ref());
        }
        add("memory.load_ports".to_owned(), memory.map(|it| &it.load_ports));
        add("memory.store_ports".to_owned(), memory.and_then(|it| it.store_ports.as_ref()));
        add("memory.rate".to_owned(), memory.and_then(|it| it.rate.as_ref()));
        add("memory.gather_rate".to_owned(), memory.and_then(|it| it.gather_rate.as_ref()));
        all.push(("chaining".to_owned(), self.chaining.as_ref().map(|it| it.provenance)));
        for name in OpClass::ALL.iter().map(|class| class.name()) {
            all.push((format!("expansions.{name}"), self.expansions.get(name).map(|it| it.provenance)));
        }
        all.retain(|(_, provenance)| *provenance == Some(Provenance::Assumed));
        all.into_iter().map(|(name, _)| name).collect()
    }

    /// Whether the machine says which operations can run at once.
    pub(crate) fn has_units(&self) -> bool {
        !self.units.is_empty()
    }

    /// Whether a result feeds the next instruction element by element.
    pub(crate) fn chains(&self) -> bool {
        self.chaining.as_ref().is_some_and(|chaining| chaining.value)
    }

    /// The resource that an instruction of `class` occupies; none where the machine says nothing of it.
    pub(crate) fn unit(&self, class: OpClass) -> Option<Occupied<'_>> {
        let number =
            |quantity: &Option<Quantity>, otherwise| quantity.as_ref().map_or(otherwise, |q| q.value);
        if !class.moves_data() {
            let serves = |unit: &Unit| unit.serves.iter().any(|name| name == class.name());
            let (name, unit) = self.units.iter().find(|(_, unit)| serves(unit))?;
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
}

/// Adds `times` executions of every step to `total`.
pub(super) fn add_scaled(total: &mut ClassCounts, steps: &ClassCounts, times: u64) {
    for (&class, &each) in steps {
        let count = total.entry(class).or_default();
        *count = count.saturating_add(each.saturating_mul(times));
    }
}
