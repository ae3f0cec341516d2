//! Operations on lanes of one precision, by their class.

use super::levels::strips;
use super::out_of_range::OutOfRange;
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
    /// Nanoseconds that a pass of the interpreter takes to begin.
    pub start: f64,
    /// Nanoseconds that an operation takes an element of a pass of the interpreter: `add` any of them, the others in addition.
    pub interpreted: BTreeMap<String, f64>,
    /// The same of an element of a compiled loop.
    pub chained: BTreeMap<String, f64>,
}

/// Of each class of operations something, in the order of [`OpClass::ALL`].
pub type OfClass = [f64; OpClass::ALL.len()];

impl LaneCosts {
    /// Nanoseconds of all operations of a run over `n` elements, and of the beginning of its passes.
    ///
    /// # Errors
    /// [`OutOfRange::NotMeasured`] where nothing was executed so on these lanes.
    pub fn operations(
        &self,
        outlines: &Outlines,
        (n, execution): (usize, Execution),
    ) -> Result<f64, OutOfRange> {
        let (classes, way) = match execution {
            Execution::Chained => (&self.chained, "chained execution"),
            _ => (&self.interpreted, "interpretation"),
        };
        if classes.is_empty() {
            return Err(OutOfRange::NotMeasured(format!("{way} of {} lanes", outlines.lane)));
        }
        let cost = |(class, count): (&OpClass, f64)| count * classes.get(class.name()).unwrap_or(&0.0);
        let element: f64 = OpClass::ALL.iter().zip(class_counts(outlines, execution)).map(cost).sum();
        Ok(n as f64 * element + self.start * starts(outlines, (n, execution), self.lanes))
    }
}

/// How often passes begin in a run over `n` elements; what is left beyond whole hardware registers goes element by element, in a
/// pass of its own.
pub fn starts(outlines: &Outlines, (n, execution): (usize, Execution), lanes: usize) -> f64 {
    if execution == Execution::Chained {
        return 0.0;
    }
    let whole = |length: usize| length < lanes || length.is_multiple_of(lanes.max(1));
    let of_strip = |(times, length)| times * if whole(length) { 1.0 } else { 2.0 };
    outlines.passes.len() as f64 * strips(n, execution).map(of_strip).sum::<f64>()
}

/// Operations of an element: all of them as sums, and once more those that take longer than a sum by their class.
pub fn class_counts(outlines: &Outlines, execution: Execution) -> OfClass {
    let mut counts = [0.0; OpClass::ALL.len()];
    let all = if execution == Execution::Chained { &outlines.instructions } else { &outlines.passes };
    for op in all.iter().flat_map(Outline::operations) {
        counts[OpClass::Add as usize] += 1.0;
        let class = op.class();
        // Divisions and roots are too few in every program to be told from the rest.
        if matches!(class, OpClass::Convert | OpClass::Gather | OpClass::Scatter) {
            counts[class as usize] += 1.0;
        }
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_kernels::isa::Op;

    #[test]
    fn a_program_is_charged_by_its_classes_and_by_how_often_its_passes_begin() {
        let of = |op| Outline { op, converts: false, reads: vec![], writes: None };
        let (passes, instructions) =
            (vec![of(Op::Add), of(Op::Truncate)], vec![of(Op::Load), of(Op::Multiply)]);
        let program = Outlines { lane: "f64", instructions, passes, registers: [0; 3] };
        let costs = |all: &[(&str, f64)]| all.iter().map(|&(class, ns)| (class.to_owned(), ns)).collect();
        let lane = LaneCosts {
            lanes: 4,
            start: 10.0,
            interpreted: costs(&[("add", 0.5), ("convert", 2.0)]),
            chained: costs(&[("add", 0.125)]),
            ..LaneCosts::default()
        };
        let ns = |n, execution| lane.operations(&program, (n, execution));
        assert_eq!(ns(8, Execution::Eager), Ok(20.0 + 8.0 * 3.0));
        // Passes begin twice where elements are left over, and once a strip.
        assert_eq!(ns(9, Execution::Eager), Ok(40.0 + 9.0 * 3.0));
        assert_eq!(ns(9, Execution::Strip(4)), Ok(3.0 * 20.0 + 9.0 * 3.0));
        assert_eq!(ns(9, Execution::Chained), Ok(9.0 * 0.25));
        assert!(LaneCosts::default().operations(&program, (8, Execution::Eager)).is_err());
    }
}
