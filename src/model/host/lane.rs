//! Operations on lanes of one precision.

use super::levels::strips;
use super::model::OutOfRange;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use stripmine_kernels::Execution;
use stripmine_kernels::backend::tape::{Outline, Outlines};
use stripmine_kernels::isa::OpClass;

/// The costs on lanes of one precision.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LaneCosts {
    /// Bytes of an element in a register of each file: numbers, predicates, indices.
    pub register_bytes: [f64; 3],
    /// Lanes of a hardware register.
    pub lanes: usize,
    /// Nanoseconds an element of a pass, in addition to its own, for each operand that is an array: its registers lie across lines.
    pub array_operand: f64,
    /// A pass of the interpreter, by the name of its kind: nanoseconds an element, and of a pass in addition.
    pub passes: BTreeMap<String, [f64; 2]>,
    /// Compiled loops: nanoseconds that an operation of a class adds to an element.
    pub loops: BTreeMap<String, f64>,
}

/// Kinds of passes that are charged as another one, which works in the same way: between an array and registers.
fn measured_as(kind: &str) -> &str {
    match kind {
        "ld" | "lds" | "sts" => "st",
        "lds.convert" => "ld.convert",
        "sts.convert" => "st.convert",
        kind => kind,
    }
}

impl LaneCosts {
    /// Nanoseconds an element of a pass, and of the pass in addition, in the first-level cache.
    ///
    /// # Errors
    /// [`OutOfRange::NotMeasured`] where its kind was not measured.
    pub fn pass(&self, pass: &Outline) -> Result<[f64; 2], OutOfRange> {
        let kind = pass.kind();
        let found = self.passes.get(measured_as(&kind));
        let [element, start] = *found.ok_or_else(|| OutOfRange::NotMeasured(format!("operation {kind}")))?;
        let operands = if pass.computes() { pass.array_operands() as f64 } else { 0.0 };
        Ok([element + self.array_operand * operands, start])
    }

    /// Nanoseconds that all passes of a program take to begin, and to compute `n` elements.
    ///
    /// # Errors
    /// [`OutOfRange::NotMeasured`] where a kind of pass was not measured.
    pub fn interpreted(
        &self,
        outlines: &Outlines,
        (n, execution): (usize, Execution),
    ) -> Result<[f64; 2], OutOfRange> {
        let mut sum = [0.0; 2];
        for pass in &outlines.passes {
            let [element, start] = self.pass(pass)?;
            sum[1] += n as f64 * element;
            for (times, length) in strips(n, execution) {
                // What is left beyond whole hardware registers goes element by element, in a pass of its own.
                let whole = length < self.lanes || length.is_multiple_of(self.lanes.max(1));
                sum[0] += times * start * if whole { 1.0 } else { 2.0 };
            }
        }
        Ok(sum)
    }

    /// Nanoseconds of the operations of an element in a compiled loop.
    ///
    /// # Errors
    /// [`OutOfRange::NotMeasured`] where loops of these lanes were not.
    pub fn chained(&self, outlines: &Outlines) -> Result<f64, OutOfRange> {
        if self.loops.is_empty() {
            return Err(OutOfRange::NotMeasured(format!("chained execution of {} lanes", outlines.lane)));
        }
        let cost = |(class, count): (&OpClass, f64)| count * self.loops.get(class.name()).unwrap_or(&0.0);
        Ok(OpClass::ALL.iter().zip(class_counts(outlines)).map(cost).sum())
    }
}

/// Operations of each class of an element of a compiled loop, in the order of [`OpClass::ALL`].
pub fn class_counts(outlines: &Outlines) -> [f64; OpClass::ALL.len()] {
    let mut counts = [0.0; OpClass::ALL.len()];
    for op in outlines.instructions.iter().flat_map(Outline::operations) {
        // Cheap classes share the same units: one number for all of them.
        let class = match op.class() {
            OpClass::Multiply | OpClass::Compare | OpClass::Logical | OpClass::Shift | OpClass::Load => {
                OpClass::Add
            }
            class => class,
        };
        counts[class as usize] += 1.0;
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_kernels::isa::Op;

    fn program(ops: &[Op]) -> Outlines {
        let of = |&op: &Op| Outline { op, converts: false, reads: vec![], writes: None };
        let all: Vec<Outline> = ops.iter().map(of).collect();
        Outlines { lane: "f64", instructions: all.clone(), passes: all, registers: [0; 3] }
    }

    #[test]
    fn a_program_is_charged_pass_by_pass_and_a_loop_by_its_classes() {
        let lane = LaneCosts {
            lanes: 4,
            passes: [("add", [0.5, 10.0]), ("div", [2.0, 20.0])].map(|(op, cost)| (op.into(), cost)).into(),
            loops: [("add", 0.25), ("divide", 4.0)].map(|(class, ns)| (class.into(), ns)).into(),
            ..LaneCosts::default()
        };
        let sums = program(&[Op::Add, Op::Divide]);
        let of = |n, execution| lane.interpreted(&sums, (n, execution));
        assert_eq!(of(8, Execution::Eager), Ok([30.0, 20.0]));
        // Passes begin twice where elements are left over, and once a strip.
        assert_eq!(of(9, Execution::Eager), Ok([60.0, 22.5]));
        assert_eq!(of(9, Execution::Strip(4)), Ok([3.0 * 30.0, 22.5]));
        assert_eq!(lane.chained(&program(&[Op::Add, Op::Multiply, Op::Divide])), Ok(4.5));
        assert!(lane.interpreted(&program(&[Op::SquareRoot]), (8, Execution::Eager)).is_err());
        assert!(LaneCosts::default().chained(&sums).is_err());
    }
}
