//! Compiled loops. What the compiler makes of a text (which values spill, how instructions are ordered) does not follow from the
//! operations it counts; a loop is charged by its classes of operations all the same, so that one that nothing was calibrated on can be
//! predicted, too.

use super::cost::{Estimate, OutOfRange};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use stripmine_kernels::backend::tape::Outlines;
use stripmine_kernels::isa::OpClass;

/// All that is known of loops.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoopCosts {
    /// Median deviation of the classes' sums from the loops they were fitted to.
    pub residual: f64,
    /// Of the shorter of computing and waiting for streams, the share that hides behind the longer.
    pub overlap: f64,
    /// Nanoseconds of a run in addition to its elements.
    pub start: Estimate,
    /// How many times as long an element takes that is left beyond whole hardware registers.
    pub left: Estimate,
    /// Nanoseconds that an operation of a class adds to an element, by lanes and class.
    pub classes: BTreeMap<String, BTreeMap<String, f64>>,
}

impl LoopCosts {
    /// Nanoseconds to begin, and to compute, over `n` elements in the first-level cache, with `lanes` of them in a hardware register.
    ///
    /// # Errors
    /// [`OutOfRange::NotMeasured`] where loops of these lanes were not.
    pub fn near(&self, outlines: &Outlines, n: usize, lanes: usize) -> Result<[f64; 2], OutOfRange> {
        let classes = self.classes.get(outlines.lane).ok_or_else(|| {
            OutOfRange::NotMeasured(format!("chained execution of {} lanes", outlines.lane))
        })?;
        let cost = |(class, count): (&&str, &f64)| classes.get(*class).copied().unwrap_or(0.0) * count;
        let element: f64 = class_counts(outlines).iter().map(cost).sum();
        let left = n % lanes.max(1);
        Ok([self.start.value, element * ((n - left) as f64 + self.left.value * left as f64)])
    }

    /// Nanoseconds of the cheapest class that computes: what the trivial baseline charges for everything.
    pub fn operation(&self, lane: &str) -> f64 {
        let classes = self.classes.get(lane);
        classes.and_then(|classes| classes.get(OpClass::Add.name())).copied().unwrap_or(0.0)
    }
}

/// Nanoseconds of computing, and of waiting for streams and for lines, where this share of the shorter of the first two hides
/// behind the longer.
pub fn overlapped(share: f64, [computing, streams, lines]: [f64; 3]) -> f64 {
    computing.max(streams) + (1.0 - share) * computing.min(streams) + lines
}

/// Operations of each class of an element.
pub fn class_counts(outlines: &Outlines) -> BTreeMap<&'static str, f64> {
    let mut counts = BTreeMap::new();
    for op in outlines.instructions.iter().flat_map(|outline| outline.operations()) {
        // Cheap classes share the same units: one number for all of them.
        let class = match op.class() {
            OpClass::Multiply | OpClass::Compare | OpClass::Logical | OpClass::Shift | OpClass::Load => {
                OpClass::Add
            }
            class => class,
        };
        *counts.entry(class.name()).or_insert(0.0) += 1.0;
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_kernels::backend::tape::{Outline, Place};
    use stripmine_kernels::isa::Op;

    #[test]
    fn of_the_shorter_a_share_hides_and_lines_of_an_index_do_not() {
        let of = |share| overlapped(share, [10.0, 4.0, 3.0]);
        assert_eq!([of(1.0), of(0.5), of(0.0)], [13.0, 15.0, 17.0]);
        assert_eq!(overlapped(0.5, [4.0, 10.0, 0.0]), 12.0);
    }

    /// By hand: two sums and a division of 16 elements in registers of 8, and of 3 more.
    #[test]
    fn a_loop_is_charged_by_its_classes() {
        let outline = |op| Outline { op, converts: false, reads: Vec::<Place>::new(), writes: None };
        let instructions = vec![outline(Op::Add), outline(Op::Multiply), outline(Op::Divide)];
        let outlines = Outlines { lane: "f64", instructions, passes: vec![], registers: [0; 3] };
        let of = |value: f64| Estimate { value, interval: 0.0 };
        let classes = [("add", 0.5), ("divide", 4.0)].map(|(name, ns)| (name.to_owned(), ns));
        let costs = LoopCosts {
            start: of(10.0),
            left: of(2.0),
            classes: BTreeMap::from([("f64".to_owned(), BTreeMap::from(classes))]),
            ..LoopCosts::default()
        };
        assert_eq!(costs.near(&outlines, 16, 8), Ok([10.0, 80.0]));
        assert_eq!(costs.near(&outlines, 19, 8), Ok([10.0, 80.0 + 2.0 * 3.0 * 5.0]));
        assert!(costs.near(&Outlines { lane: "f32", ..outlines }, 16, 8).is_err());
    }
}
