//! Functional units and memory ports: what instructions of a convoy compete for.

use super::machine::{MachineModel, Quantity};
use serde::Deserialize;
use std::collections::BTreeMap;
use stripmine_kernels::isa::op::OpClass;

/// Functional units of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// The classes that they serve.
    pub serves: Vec<OpClass>,
    /// How many there are: so many instructions of these classes run at once.
    pub count: Quantity,
    /// Elements a clock period of each; 1 where nothing is said.
    pub rate: Option<Quantity>,
}

/// The way to memory.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MemoryPorts {
    /// Loads that run at once; loads and stores together where there are no ports for stores.
    pub load_ports: Quantity,
    /// Stores that run at once; none where they share the ports of the loads.
    pub store_ports: Option<Quantity>,
    /// Elements a clock period of each port; 1 where nothing is said.
    pub rate: Option<Quantity>,
    /// Elements a clock period through an index vector; as `rate` where nothing is said.
    pub gather_rate: Option<Quantity>,
}

/// The units of a machine by name.
pub type Units = BTreeMap<String, Unit>;

/// Something that instructions compete for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Resource<'m> {
    /// Functional units of a kind, by name.
    Unit(&'m str),
    /// The ports of loads.
    Loads,
    /// The ports of stores.
    Stores,
}

/// What an instruction of a class occupies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Occupied<'m> {
    /// The resource.
    pub resource: Resource<'m>,
    /// How many instructions find place at once.
    pub count: f64,
    /// Elements a clock period.
    pub rate: f64,
}

impl MachineModel {
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
