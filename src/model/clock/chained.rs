//! Convoys: instructions that run at once.

use super::convoy::{self, Memory};
use super::registers::{self, strip_mined};
use super::{Charge, Work};
use crate::model::machine::MachineModel;

/// `T_start` and `T_chime` from the convoys of the program, memory taken as never busy.
///
/// A machine that states no functional units, and work in no known order, is charged as by the strip-mined clock.
pub(super) fn charge(machine: &MachineModel, work: &Work) -> Charge {
    in_convoys(machine, work, Memory::NeverBusy)
}

/// The charge of a program's convoys.
pub(super) fn in_convoys(machine: &MachineModel, work: &Work, memory: Memory) -> Charge {
    let (Some(order), true) = (work.order(), machine.has_units()) else {
        return registers::charge(machine, work);
    };
    let convoys = convoy::convoys(machine, order, memory);
    let charge = Charge {
        strip: None,
        each_strip: convoys.iter().map(|convoy| convoy.start_up).sum(),
        each_element: convoys.iter().map(|convoy| convoy.chime).sum(),
    };
    strip_mined(machine, charge)
}
