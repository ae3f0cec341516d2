//! Operations that a clock charges.

use crate::model::machine::MachineModel;
use stripmine_kernels::Runnable;
use stripmine_kernels::backend::tape::Outline;
use stripmine_kernels::isa::{Op, OpClass, OpCounts};

/// Operations of a program: the number of each and, if known, their order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProgramWork {
    counts: OpCounts,
    order: Vec<Outline>,
    /// Type of the elements; f64 where only counts are known.
    lane: Option<&'static str>,
}

impl ProgramWork {
    /// Instructions of a program.
    pub fn of(program: &dyn Runnable) -> ProgramWork {
        let outlines = program.outlines();
        ProgramWork { lane: Some(outlines.lane), ..ProgramWork::in_order(outlines.instructions) }
    }

    /// Instructions in a given order.
    pub fn in_order(order: Vec<Outline>) -> ProgramWork {
        let mut counts = OpCounts::default();
        order.iter().flat_map(Outline::operations).for_each(|op| counts.record(op));
        ProgramWork { counts, order, lane: None }
    }

    /// Type of the elements.
    pub(super) fn lane(&self) -> &'static str {
        self.lane.unwrap_or("f64")
    }

    /// Work of a machine that takes a product and a sum in one instruction: a product that only one sum or difference reads is left out, and the
    /// sum reads its factors. Without an order nothing is left out.
    pub(crate) fn fused(&self) -> ProgramWork {
        let mut order: Vec<Option<Outline>> = self.order.iter().cloned().map(Some).collect();
        for at in 0..order.len() {
            if let Some((reader, sum)) = fused_sum(&self.order, at) {
                // A sum takes one product.
                if order[reader].as_ref().is_some_and(|it| it.reads == self.order[reader].reads) {
                    order[reader] = Some(sum);
                    order[at] = None;
                }
            }
        }
        if self.order.is_empty() {
            return self.clone();
        }
        ProgramWork { lane: self.lane, ..ProgramWork::in_order(order.into_iter().flatten().collect()) }
    }

    /// Instructions in their order; none where only counts are known, which no clock can chain.
    pub fn order(&self) -> Option<&[Outline]> {
        (!self.order.is_empty()).then_some(&self.order)
    }

    /// Sums `each(class)` over all operations that `machine` executes.
    pub(super) fn sum(&self, machine: &MachineModel, each: impl Fn(OpClass) -> f64) -> f64 {
        machine.expand(&self.counts).into_iter().map(|(class, count)| count as f64 * each(class)).sum()
    }
}

/// The only reader of a product, if it is a sum or difference, with the factors instead of the product.
fn fused_sum(order: &[Outline], product: usize) -> Option<(usize, Outline)> {
    let Outline { op: Op::Multiply, converts: false, reads: factors, writes: Some(result) } = &order[product]
    else {
        return None;
    };
    let mut found = None;
    for (at, it) in order.iter().enumerate().skip(product + 1) {
        let reads = it.reads.iter().filter(|read| *read == result).count();
        if reads > 0 {
            if found.is_some() || reads > 1 || !matches!(it.op, Op::Add | Op::Subtract) {
                return None;
            }
            found = Some(at);
        }
        let Some(written) = &it.writes else { continue };
        if written == result {
            break;
        }
        // A factor whose register has another value by then.
        if found.is_none() && factors.contains(written) {
            return None;
        }
    }
    let reader = found?;
    let mut sum = order[reader].clone();
    sum.reads.retain(|read| read != result);
    sum.reads.extend(factors);
    Some((reader, sum))
}

impl From<OpCounts> for ProgramWork {
    /// Operations in no known order.
    fn from(counts: OpCounts) -> ProgramWork {
        ProgramWork { counts, order: vec![], lane: None }
    }
}
