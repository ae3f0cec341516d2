//! Description of a vector machine.

pub use super::sourced::NumberProvenance;
use super::sourced::{SourcedNumber, SourcedValue};
use super::whole_registers::WholeRegisters;
use serde::Deserialize;
use std::collections::BTreeMap;
use stripmine_kernels::isa::op::{OpClass, OpCounts};

/// Vector registers of one processor.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct VectorRegisters {
    pub(super) count: SourcedNumber,
    /// Elements in each.
    pub(super) length: SourcedNumber,
}

/// Functional units of one kind.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Unit {
    /// Names of the classes that they serve.
    serves: Vec<String>,
    /// Instructions of these classes that execute at once.
    count: SourcedNumber,
    /// Elements per clock period of each; 1 by default.
    rate: Option<SourcedNumber>,
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MemoryPorts {
    /// Loads that execute at once; loads and stores together where there are no ports for stores.
    load_ports: SourcedNumber,
    /// Stores that execute at once; none where they share the ports of the loads.
    store_ports: Option<SourcedNumber>,
    /// Elements per clock period of each port; 1 by default.
    rate: Option<SourcedNumber>,
    /// Elements per clock period through an index vector; as `rate` by default.
    gather_rate: Option<SourcedNumber>,
}

/// Executions per class of operations; classes that do not occur are absent.
pub(crate) type ClassCounts = BTreeMap<OpClass, u64>;

/// Replacement of one operation of a class that a machine lacks.
///
/// The class itself, where it occurs, denotes the unit of the machine that serves it (`divide` for the reciprocal
/// approximation) and is not expanded again. All counts come from one sequence of operations and so share one provenance.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Expansion {
    pub(super) steps: BTreeMap<String, u64>,
    provenance: NumberProvenance,
    #[serde(rename = "note")]
    _note: String,
}

/// A resource that instructions compete for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum MachineResource<'m> {
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
    pub(crate) resource: MachineResource<'m>,
    /// Instructions that it serves at once.
    pub count: f64,
    /// Elements per clock period.
    pub rate: f64,
}

/// One processor of a vector machine, as stated in its file. Classes of operations are given by name. If an entry needed by a clock is
/// omitted, the clock charges as the one before it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MachineModel {
    format: u32,
    pub(super) title: String,
    year: SourcedNumber,
    pub(super) clock_period_ns: SourcedNumber,
    /// True if a result feeds the next instruction element by element.
    chaining: Option<SourcedValue<bool>>,
    /// True if one instruction takes a product and a sum.
    fma: Option<SourcedValue<bool>>,
    /// Elements of 32 bits that take the place of one of 64 bits.
    pub(super) lanes_32: Option<SourcedNumber>,
    /// Clock periods per strip.
    pub(super) loop_overhead: Option<SourcedNumber>,
    /// Vector registers; none where vectors have any length.
    pub(super) vector_registers: Option<VectorRegisters>,
    /// Times of instructions on whole registers, where they do not depend on the number of elements.
    pub(super) whole_registers: Option<WholeRegisters>,
    /// Clock periods by class; `default` applies to all other classes.
    #[serde(default)]
    pub(super) start_up: BTreeMap<String, SourcedNumber>,
    #[serde(default)]
    units: BTreeMap<String, Unit>,
    memory: Option<MemoryPorts>,
    #[serde(default)]
    pub(super) expansions: BTreeMap<String, Expansion>,
    /// Complete expansions, down to classes that the machine executes.
    #[serde(skip)]
    pub(super) executed: BTreeMap<OpClass, ClassCounts>,
}

/// A feature that our own executions do not use, or only in single precision.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MachineFeature {
    /// Instructions that take a product and a sum.
    Fma,
    /// Elements of 32 bits that take the place of one of 64.
    Lanes32,
}

/// Key of the start-up of all other classes.
pub(super) const DEFAULT: &str = "default";

impl MachineModel {
    /// Name of the machine in a heading.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// Clock period in nanoseconds.
    pub fn clock_period_ns(&self) -> f64 {
        self.clock_period_ns.value
    }

    /// Start-up D of an operation of `class`, in clock periods: BP93 section 3, the pipeline depth.
    ///
    /// Zero for a class that never executes because its expansion does not contain it.
    pub(crate) fn start_up(&self, class: OpClass) -> f64 {
        let start_up = self.start_up.get(class.name()).or_else(|| self.start_up.get(DEFAULT));
        start_up.map_or(0.0, |start_up| start_up.value)
    }

    /// Operations executed for one of `class`: itself, or its complete expansion.
    pub fn steps(&self, class: OpClass) -> ClassCounts {
        self.executed.get(&class).cloned().unwrap_or_else(|| ClassCounts::from([(class, 1)]))
    }

    /// Operations executed for `counts`, after expanding those that the machine lacks.
    ///
    /// Saturates where a count exceeds the range of `u64`.
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

    /// Copy of the machine with every assumed start-up, and an assumed loop overhead, set to zero: shows which results depend
    /// on them.
    #[must_use]
    pub(crate) fn without_assumed_start_ups(&self) -> MachineModel {
        let mut known = self.clone();
        let quantities = known.start_up.values_mut().chain(&mut known.loop_overhead);
        quantities
            .filter(|quantity| quantity.provenance == NumberProvenance::Assumed)
            .for_each(|quantity| quantity.value = 0.0);
        known
    }

    /// Names of the assumed entries, such as `start_up.add`.
    pub(crate) fn assumed(&self) -> Vec<String> {
        let assumed = |it: &NumberProvenance| *it == NumberProvenance::Assumed;
        self.provenances().into_iter().filter(|(_, it)| assumed(it)).map(|(name, _)| name).collect()
    }

    /// Names and provenances of all entries.
    pub(super) fn provenances(&self) -> Vec<(String, NumberProvenance)> {
        let mut all: Vec<(String, Option<NumberProvenance>)> = vec![];
        let mut add = |name: String, it: Option<&SourcedNumber>| all.push((name, it.map(|it| it.provenance)));
        let (registers, memory) = (self.vector_registers.as_ref(), self.memory.as_ref());
        add("year".to_owned(), Some(&self.year));
        add("clock_period_ns".to_owned(), Some(&self.clock_period_ns));
        add("vector_registers.count".to_owned(), registers.map(|it| &it.count));
        add("vector_registers.length".to_owned(), registers.map(|it| &it.length));
        for name in [DEFAULT].into_iter().chain(OpClass::ALL.iter().map(|class| class.name())) {
            add(format!("start_up.{name}"), self.start_up.get(name));
        }
        add("loop_overhead".to_owned(), self.loop_overhead.as_ref());
        add("lanes_32".to_owned(), self.lanes_32.as_ref());
        for (name, unit) in &self.units {
            add(format!("units.{name}.count"), Some(&unit.count));
            add(format!("units.{name}.rate"), unit.rate.as_ref());
        }
        add("memory.load_ports".to_owned(), memory.map(|it| &it.load_ports));
        add("memory.store_ports".to_owned(), memory.and_then(|it| it.store_ports.as_ref()));
        add("memory.rate".to_owned(), memory.and_then(|it| it.rate.as_ref()));
        add("memory.gather_rate".to_owned(), memory.and_then(|it| it.gather_rate.as_ref()));
        let whole = self.whole_registers.iter().flat_map(WholeRegisters::entries);
        all.extend(whole.map(|(name, provenance)| (name, Some(provenance))));
        for (name, it) in [("chaining", &self.chaining), ("fma", &self.fma)] {
            all.push((name.to_owned(), it.as_ref().map(|it| it.provenance)));
        }
        for name in OpClass::ALL.iter().map(|class| class.name()) {
            all.push((format!("expansions.{name}"), self.expansions.get(name).map(|it| it.provenance)));
        }
        all.into_iter().filter_map(|(name, provenance)| Some((name, provenance?))).collect()
    }

    /// True if the machine states start-ups; others are charged a clock period an element by the clocks that need them.
    pub(crate) fn has_start_ups(&self) -> bool {
        !self.start_up.is_empty()
    }

    /// Copy of the machine with another number of vector registers that form one.
    #[must_use]
    pub(crate) fn with_group(&self, registers: usize) -> MachineModel {
        let whole = self.whole_registers.clone().map(|it| it.with_group(registers));
        MachineModel { whole_registers: whole, ..self.clone() }
    }

    /// Elements of a group of registers, if instructions take the time of whole registers.
    pub(crate) fn group_elements(&self) -> Option<f64> {
        self.whole_registers.as_ref().map(WholeRegisters::elements)
    }

    /// True if the machine states which operations can execute at once.
    pub(crate) fn has_units(&self) -> bool {
        !self.units.is_empty()
    }

    /// True if a result feeds the next instruction element by element.
    pub(crate) fn chains(&self) -> bool {
        self.chaining.as_ref().is_some_and(|chaining| chaining.value)
    }

    /// True if one instruction takes a product and a sum. Our own executions never do: it would change bits.
    pub(crate) fn fuses(&self) -> bool {
        self.fma.as_ref().is_some_and(|fma| fma.value)
    }

    /// Elements of a type that take the place of one of 64 bits.
    pub(crate) fn lanes(&self, element: &str) -> f64 {
        self.lanes_32.as_ref().filter(|_| element == "f32").map_or(1.0, |lanes| lanes.value)
    }

    /// Copy of the machine with or without a feature, to see what it gains: two elements of 32 bits take the place of one of 64.
    #[must_use]
    pub(crate) fn with_feature(&self, feature: MachineFeature, is_present: bool) -> MachineModel {
        let mut machine = self.clone();
        let (provenance, note) = (NumberProvenance::Assumed, String::new());
        match feature {
            MachineFeature::Fma => machine.fma = Some(SourcedValue { value: is_present, provenance, note }),
            MachineFeature::Lanes32 => {
                let value = if is_present { 2.0 } else { 1.0 };
                machine.lanes_32 = Some(SourcedValue { value, provenance, note });
            }
        }
        machine
    }

    /// Resource that an instruction of `class` occupies; none where the machine does not state it.
    pub(crate) fn unit(&self, class: OpClass) -> Option<Occupied<'_>> {
        let number =
            |quantity: &Option<SourcedNumber>, otherwise| quantity.as_ref().map_or(otherwise, |q| q.value);
        if !class.moves_data() {
            let serves = |unit: &Unit| unit.serves.iter().any(|name| name == class.name());
            let (name, unit) = self.units.iter().find(|(_, unit)| serves(unit))?;
            let rate = number(&unit.rate, 1.0);
            return Some(Occupied { resource: MachineResource::Unit(name), count: unit.count.value, rate });
        }
        let memory = self.memory.as_ref()?;
        let rate = number(&memory.rate, 1.0);
        let rate = match class {
            OpClass::Gather | OpClass::Scatter => number(&memory.gather_rate, rate),
            _ => rate,
        };
        Some(match (class, &memory.store_ports) {
            (OpClass::Store | OpClass::Scatter, Some(ports)) => {
                Occupied { resource: MachineResource::Stores, count: ports.value, rate }
            }
            _ => Occupied { resource: MachineResource::Loads, count: memory.load_ports.value, rate },
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
