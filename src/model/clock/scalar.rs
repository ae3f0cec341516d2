//! The scalar machine of BP93 section 3.

use super::{Charge, Work};
use crate::model::machine::MachineModel;

/// `NOP · n · D`: without a pipeline every element waits for the whole depth of its unit.
pub(super) fn charge(machine: &MachineModel, work: &Work) -> Charge {
    Charge { each_element: work.sum(machine, |start_up| start_up), ..Charge::default() }
}
