//! Memory ports, gathers and scatters.

use super::chained::in_convoys;
use super::convoy::Memory;
use super::{Charge, Work};
use crate::model::machine::MachineModel;

/// As chained, with as many loads and stores in a convoy as the machine has ports for, at the rate of its memory.
///
/// A machine that states nothing about its memory is charged as by the chained clock. Not modelled: conflicts of memory
/// banks, and the loads and stores of vectors for which the machine has too few registers.
pub(super) fn charge(machine: &MachineModel, work: &Work) -> Charge {
    in_convoys(machine, work, Memory::Ports)
}
