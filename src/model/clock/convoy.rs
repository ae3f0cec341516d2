//! Convoys: sets of vector instructions that begin together, Hennessy and Patterson, *Computer Architecture*, vector
//! processors.

use crate::model::machine::MachineResource;
use crate::model::machine::{ClassCounts, MachineModel};
use std::collections::HashMap;
use stripmine_kernels::backend::tape::{Outline, RegisterName, VectorLocation};
use stripmine_kernels::isa::{Array, OpClass};

/// Model of memory access.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MemoryModel {
    /// An unlimited number of ports, each with an element per clock period.
    NeverBusy,
    /// The ports and rates of the machine.
    Ports,
}

/// Instructions that execute at once.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Convoy {
    /// Clock periods until the last of its units delivers its first element.
    pub(crate) start_up: f64,
    /// Clock periods per element, those of its slowest unit.
    pub(crate) chime: f64,
    /// Number of instructions; the steps of an expansion count individually.
    pub instructions: usize,
}

/// Groups the instructions of a program into convoys. Each instruction, in order, joins the last convoy unless its unit is occupied, or it needs
/// a result of that convoy and the machine does not chain.
///
/// The number of registers is unlimited, so only true dependences count. An expansion is a chain of dependent steps with its classes spread evenly
/// over it: machine files state the number of each, not their order. Data stored by a convoy are not loaded by the same convoy.
pub(crate) fn convoys(machine: &MachineModel, order: &[Outline], memory: MemoryModel) -> Vec<Convoy> {
    let mut issue = Issue { machine, memory, convoys: vec![], used: HashMap::new(), results: HashMap::new() };
    for outline in order {
        issue.instruction(outline);
    }
    issue.convoys
}

/// A result that an instruction may wait for.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum IssuedResult {
    Register(RegisterName),
    Array(Array, &'static str),
}

impl IssuedResult {
    fn at(place: &VectorLocation) -> IssuedResult {
        match place {
            VectorLocation::Register(name) => IssuedResult::Register(*name),
            VectorLocation::Memory(reference) | VectorLocation::Indexed(reference) => {
                IssuedResult::Array(reference.array, reference.element)
            }
        }
    }
}

/// The convoy being filled, with the units and results in use.
struct Issue<'m> {
    machine: &'m MachineModel,
    memory: MemoryModel,
    convoys: Vec<Convoy>,
    /// Instructions of the open convoy on each unit.
    used: HashMap<MachineResource<'m>, f64>,
    /// Results of the open convoy: clock periods until their first element.
    results: HashMap<IssuedResult, f64>,
}

impl Issue<'_> {
    fn instruction(&mut self, outline: &Outline) {
        let mut before: Option<f64> = None;
        for class in outline.operations().flat_map(|op| spread(&self.machine.steps(op.class()))) {
            before = Some(self.step(class, outline, before));
        }
        if let (Some(place), Some(first_element)) = (&outline.writes, before) {
            self.results.insert(IssuedResult::at(place), first_element);
        }
    }

    /// Issues one step, which needs the operands of the instruction and its step `before`; returns the time of its first element.
    fn step(&mut self, class: OpClass, outline: &Outline, before: Option<f64>) -> f64 {
        let unit = self.machine.unit(class).filter(|unit| {
            !(self.memory == MemoryModel::NeverBusy
                && matches!(unit.resource, MachineResource::Loads | MachineResource::Stores))
        });
        let awaited = outline.reads.iter().filter_map(|place| {
            let result = IssuedResult::at(place);
            Some((matches!(result, IssuedResult::Array(..)), *self.results.get(&result)?))
        });
        let awaited: Vec<(bool, f64)> = awaited.chain(before.map(|before| (false, before))).collect();
        let must_wait = awaited.iter().any(|&(stored, _)| stored || !self.machine.chains());
        let taken =
            unit.is_some_and(|unit| self.used.get(&unit.resource).is_some_and(|&used| used >= unit.count));
        let opens = self.convoys.is_empty() || must_wait || taken;
        if opens {
            self.convoys.push(Convoy::default());
            self.used.clear();
            self.results.clear();
        }
        let begins = if opens { 0.0 } else { awaited.iter().map(|&(_, at)| at).fold(0.0, f64::max) };
        let first_element = begins + self.machine.start_up(class);
        if let Some(unit) = unit {
            *self.used.entry(unit.resource).or_default() += 1.0;
        }
        #[expect(clippy::expect_used, reason = "one was opened above if there was none")]
        let convoy = self.convoys.last_mut().expect("one was opened above if there was none");
        convoy.start_up = convoy.start_up.max(first_element);
        convoy.chime = convoy.chime.max(1.0 / unit.map_or(1.0, |unit| unit.rate));
        convoy.instructions += 1;
        first_element
    }
}

/// Classes of an expansion, each as often as it occurs, spread evenly among the others.
fn spread(steps: &ClassCounts) -> Vec<OpClass> {
    let mut placed: Vec<(f64, OpClass)> = steps
        .iter()
        .flat_map(|(&class, &count)| (0..count).map(move |i| ((i as f64 + 0.5) / count as f64, class)))
        .collect();
    placed.sort_by(|a, b| a.0.total_cmp(&b.0));
    placed.into_iter().map(|(_, class)| class).collect()
}
