//! Operations that a clock charges.

use crate::model::machine::MachineModel;
use stripmine_kernels::Runnable;
use stripmine_kernels::backend::tape::Outline;
use stripmine_kernels::isa::{OpClass, OpCounts};

/// Operations of a program: the number of each and, if known, their order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProgramWork {
    counts: OpCounts,
    order: Vec<Outline>,
}

impl ProgramWork {
    /// Instructions of a program.
    pub fn of(program: &dyn Runnable) -> ProgramWork {
        ProgramWork::in_order(program.outlines().instructions)
    }

    /// Instructions in a given order.
    pub fn in_order(order: Vec<Outline>) -> ProgramWork {
        let mut counts = OpCounts::default();
        order.iter().flat_map(Outline::operations).for_each(|op| counts.record(op));
        ProgramWork { counts, order }
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

impl From<OpCounts> for ProgramWork {
    /// Operations in no known order.
    fn from(counts: OpCounts) -> ProgramWork {
        ProgramWork { counts, order: vec![] }
    }
}
