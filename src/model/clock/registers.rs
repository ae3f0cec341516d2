//! Strip-mining: long vectors pass through registers of a fixed length.

use super::{Charge, Work, paper};
use crate::model::machine::MachineModel;

/// As the paper's, with a start-up for every strip of one register, and the loop around the strips.
///
/// A machine without vector registers is charged as by the paper's clock.
pub(super) fn charge(machine: &MachineModel, work: &Work) -> Charge {
    strip_mined(machine, paper::charge(machine, work))
}

/// The same charge for every strip instead of once, with the loop's overhead where there is anything to loop over.
pub(super) fn strip_mined(machine: &MachineModel, charge: Charge) -> Charge {
    let loop_overhead = machine.loop_overhead().filter(|_| charge.each_element > 0.0);
    Charge {
        strip: machine.vector_registers().map(|registers| registers.length.value),
        each_strip: charge.each_strip + loop_overhead.map_or(0.0, |overhead| overhead.value),
        ..charge
    }
}
