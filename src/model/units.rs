//! Functional units and memory ports: what instructions of a convoy compete for.

use super::quantity::Quantity;
use serde::Deserialize;
use std::collections::BTreeMap;
use stripmine_kernels::isa::op::OpClass;

/// Functional units of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// The classes that they serve.
    pub serves: Vec<OpClass>,
    /// How many there are: the number of instructions of these classes that run at once.
    pub count: Quantity,
    /// Elements a clock period of each; 1 where nothing is said.
    pub rate: Option<Quantity>,
}

/// The ports to memory.
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
