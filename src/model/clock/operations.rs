//! The trivial baseline that every other clock must beat.

use super::{Charge, Work};
use crate::model::machine::MachineModel;

/// `NOP · n`: time in proportion to the number of operations.
pub(super) fn charge(machine: &MachineModel, work: &Work) -> Charge {
    Charge { each_element: work.sum(machine, |_| 1.0), ..Charge::default() }
}
