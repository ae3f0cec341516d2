//! Processors whose instructions take the time of whole registers, however few elements are in use.

use super::sourced::{NumberProvenance, SourcedNumber, SourcedValue};
use serde::Deserialize;
use std::collections::BTreeMap;
use stripmine_kernels::isa::OpClass;

/// Registers that may form one.
const GROUPS: [f64; 4] = [1.0, 2.0, 4.0, 8.0];
/// Length of an element (bits).
const ELEMENT: f64 = 64.0;

/// Measured times of instructions on whole registers.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct WholeRegisters {
    /// Length of a register (bits).
    vlen: SourcedNumber,
    /// Registers that form one: 1, 2, 4 or 8.
    group: SourcedNumber,
    /// Clock periods of an instruction of a class on 1, 2, 4 and 8 registers.
    periods: BTreeMap<String, SourcedValue<[f64; 4]>>,
}

impl WholeRegisters {
    /// Doubles in a group of registers, VLMAX.
    pub(crate) fn elements(&self) -> f64 {
        self.vlen.value / ELEMENT * self.group.value
    }

    /// Clock periods of an instruction of a class on a group; a shifted load takes those of a load. None if the file does not state them.
    pub(crate) fn periods(&self, class: OpClass) -> Option<f64> {
        let shifted = (class == OpClass::Shift).then(|| OpClass::Load.name());
        let of = |name: &str| self.periods.get(name);
        let periods = of(class.name()).or_else(|| of(shifted?))?;
        let at = GROUPS.iter().position(|group| *group == self.group.value)?;
        Some(periods.value[at])
    }

    /// Sets the registers that form one.
    #[must_use]
    pub(crate) fn with_group(mut self, registers: usize) -> WholeRegisters {
        self.group.value = registers as f64;
        self
    }

    /// Error of the entries as a whole, if any: path and message.
    pub(super) fn error(&self) -> Option<(String, String)> {
        let (vlen, group) = (self.vlen.value, self.group.value);
        if !GROUPS.contains(&group) {
            let what = format!("`whole_registers.group` is {group}, but must be 1, 2, 4 or 8");
            return Some(("whole_registers.group".to_owned(), what));
        }
        if vlen % ELEMENT != 0.0 {
            let what = format!("`whole_registers.vlen` is {vlen}, but must be a multiple of {ELEMENT} bits");
            return Some(("whole_registers.vlen".to_owned(), what));
        }
        None
    }

    /// Entries with their numbers: name and provenance.
    pub(super) fn entries(&self) -> impl Iterator<Item = (String, NumberProvenance)> {
        let alone = [("vlen", &self.vlen), ("group", &self.group)];
        let alone = alone.map(|(name, it)| (format!("whole_registers.{name}"), it.provenance));
        let periods = self.periods.iter();
        let periods = periods.map(|(name, it)| (format!("whole_registers.periods.{name}"), it.provenance));
        alone.into_iter().chain(periods)
    }
}
