//! Passes of the interpreter on lanes of one precision.

use super::cost::{OutOfRange, PassCost, interpolated};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use stripmine_kernels::backend::tape::{Outline, Outlines};
use stripmine_kernels::isa::Op;

/// The costs on lanes of one precision.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LaneCosts {
    /// Bytes of an element in a register of each file: numbers, predicates, indices.
    pub register_bytes: [f64; 3],
    /// Lanes of a hardware register.
    pub lanes: usize,
    /// Nanoseconds an element of a pass, in addition to its tau, for each operand that is an array: its registers lie across
    /// lines.
    pub array_operand: f64,
    /// Additional nanoseconds of a pass where the next one is of another kind, by the passes of the program.
    pub change: Vec<Change>,
    /// A pass, by the name of its kind.
    pub passes: BTreeMap<String, PassCost>,
}

/// What it takes that the next pass is of another kind.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Change {
    /// Passes of the program: of a long one neither the instructions nor the branches stay at hand.
    pub passes: usize,
    /// Nanoseconds a pass.
    pub ns: f64,
}

/// Kinds of passes that are charged as another one, which works in the same way.
fn measured_as(kind: &str) -> &str {
    match kind {
        "lds" => Op::Load.mnemonic(),
        "sts" => Op::Store.mnemonic(),
        "lds.convert" => "ld.convert",
        "sts.convert" => "st.convert",
        kind => kind,
    }
}

impl LaneCosts {
    /// How often a pass over `n` elements begins: what is left of it beyond whole hardware registers goes element by element,
    /// in a pass of its own.
    pub fn starts(&self, n: usize) -> f64 {
        if n < self.lanes || n.is_multiple_of(self.lanes.max(1)) { 1.0 } else { 2.0 }
    }

    /// Nanoseconds of all passes of a program over a strip of `n` elements in the first-level cache, where a pass
    /// that was not measured among others takes `begin` times as long to begin as in a drill.
    ///
    /// # Errors
    /// [`OutOfRange::NotMeasured`] where a kind of pass was not measured.
    pub fn near(&self, outlines: &Outlines, n: usize, begin: f64) -> Result<f64, OutOfRange> {
        let at = |start: f64, element: f64| self.starts(n) * start + n as f64 * element;
        let change = begin * self.change(outlines.passes.len());
        let each = |pass| {
            let PassCost { element, start } = self.cost(pass)?;
            Ok(change + at(begin * start.value, element.value))
        };
        outlines.passes.iter().map(each).sum()
    }

    /// Bytes of all registers of a program over vectors or strips of `n` elements.
    pub fn register_extent(&self, outlines: &Outlines, n: usize) -> f64 {
        let files = outlines.registers.iter().zip(self.register_bytes);
        files.map(|(&count, bytes)| count as f64 * bytes * n as f64).sum()
    }

    /// What a pass takes in the first-level cache.
    ///
    /// # Errors
    /// [`OutOfRange::NotMeasured`] where its kind was not measured.
    pub fn cost(&self, pass: &Outline) -> Result<PassCost, OutOfRange> {
        let kind = pass.kind();
        let found = self.passes.get(&kind).or_else(|| self.passes.get(measured_as(&kind)));
        let mut cost = *found.ok_or_else(|| OutOfRange::NotMeasured(format!("operation {kind}")))?;
        if pass.computes() {
            cost.element.value += self.array_operand * pass.array_operands() as f64;
        }
        Ok(cost)
    }

    /// Additional nanoseconds of a pass, in a program of `passes`, because the next one is of another kind.
    pub fn change(&self, passes: usize) -> f64 {
        let points: Vec<(f64, f64)> =
            self.change.iter().map(|change| (change.passes as f64, change.ns)).collect();
        interpolated(&points, passes as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::host::Estimate;
    use stripmine_kernels::backend::tape::Place;

    #[test]
    fn a_program_is_charged_pass_by_pass() {
        let sum = Outline { op: Op::Add, converts: false, reads: Vec::<Place>::new(), writes: None };
        let outlines =
            Outlines { lane: "f64", instructions: vec![], passes: vec![sum.clone(), sum], registers: [0; 3] };
        let of = |value: f64| Estimate { value, interval: 0.0 };
        let pass = PassCost { element: of(0.5), start: of(10.0) };
        let mut lane = LaneCosts { lanes: 4, ..LaneCosts::default() };
        lane.passes.insert(outlines.passes[0].kind(), pass);
        lane.change.push(Change { passes: 1, ns: 2.0 });
        // Passes begin twice where elements are left over.
        assert_eq!(lane.near(&outlines, 8, 0.5).unwrap(), 2.0 * (0.5 * (2.0 + 10.0) + 8.0 * 0.5));
        assert_eq!(lane.near(&outlines, 9, 0.5).unwrap(), 2.0 * (0.5 * (2.0 + 20.0) + 9.0 * 0.5));
    }
}
