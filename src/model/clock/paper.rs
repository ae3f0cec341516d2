//! The vector machine of BP93 section 3.

use super::{Charge, Work};
use crate::model::machine::MachineModel;

/// `NOP · (n + D)`: the pipeline fills once, then delivers one element a clock period.
pub(super) fn charge(machine: &MachineModel, work: &Work) -> Charge {
    Charge {
        strip: None,
        each_strip: work.sum(machine, |start_up| start_up),
        each_element: work.sum(machine, |_| 1.0),
    }
}
