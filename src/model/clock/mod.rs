//! Clocks: conversion of the operations of a program to clock periods.
//!
//! Every clock has the form of Hennessy and Patterson's strip-mining formula, `T(n) = ceil(n / MVL) (T_loop + T_start) + n T_chime`, and differs in
//! the values of its three numbers (its charge). The list is a ladder: each rung after the first two adds one property of vector machines to the rung
//! before it, so a table shows the effect of that property.

mod convoy;
#[cfg(test)]
mod tests;
mod work;

pub(crate) use convoy::{MemoryModel, convoys};
pub use work::ProgramWork;

use super::machine::MachineModel;

macro_rules! define_clocks {
    ($(($variant:ident, $name:literal, $charge:path, $doc:literal)),* $(,)?) => {
        /// Clock that charges the operations of a program, in clock periods of the machine.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Clock {
            $(#[doc = $doc] $variant,)*
        }

        impl Clock {
            /// Every clock, in the order of the ladder.
            pub const ALL: &'static [Clock] = &[$(Clock::$variant),*];

            /// The name in tables and options.
            pub const fn name(self) -> &'static str {
                match self { $(Clock::$variant => $name),* }
            }

            /// Description of the clock in one line.
            pub const fn meaning(self) -> &'static str {
                match self { $(Clock::$variant => $doc),* }
            }

            /// Charge of `work` on `machine`, for vectors of any length.
            ///
            /// Operations the machine lacks are expanded first.
            fn charge(self, machine: &MachineModel, work: &ProgramWork) -> Charge {
                match self { $(Clock::$variant => $charge(machine, work)),* }
            }
        }
    };
}

define_clocks! {
    (Operations, "operations", operations,
        "The trivial baseline: a clock period for every element of every operation."),
    (Scalar, "scalar", scalar,
        "The same operations on a scalar machine, one element after the other: BP93 section 3."),
    (Paper, "paper", paper,
        "Unchained vector operations on registers of any length: BP93 section 3."),
    (Registers, "registers", registers,
        "Strip-mined: a start-up for every register's worth of elements."),
    (Chained, "chained", chained,
        "Instructions on different units run at once, a result feeding the next one where the machine chains."),
    (Ports, "ports", ports,
        "As chained, with the machine's memory ports and its rate of gathers and scatters."),
    (WholeRegisters, "whole registers", whole_registers,
        "Measured times of instructions on whole registers, however few elements are in use."),
}

impl Clock {
    /// Clock periods that `work` takes on `machine` over vectors of `n` elements.
    ///
    /// Empty vectors (`n` = 0) cost nothing: no instruction is issued for them.
    /// On a machine that fuses a product and a sum, such pairs count once if this saves time; elements of 32 bits take the place of one of 64 where the machine
    /// has lanes for them. The first three clocks, up to the paper's, know neither.
    pub fn clocks(self, machine: &MachineModel, work: &ProgramWork, n: u64) -> f64 {
        if matches!(self, Clock::Operations | Clock::Scalar | Clock::Paper) {
            return self.charge(machine, work).clocks(n);
        }
        let n = (n as f64 / machine.lanes(work.lane())).ceil() as u64;
        let plain = self.charge(machine, work).clocks(n);
        // Convoys of fewer instructions may be longer in sum; a program fuses only what saves time.
        if machine.fuses() { plain.min(self.charge(machine, &work.fused()).clocks(n)) } else { plain }
    }
}

/// Three numbers of a clock: cost of a program on a machine, for vectors of any length.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Charge {
    /// Elements of a strip, MVL; none where vectors of any length are processed in one go.
    strip: Option<f64>,
    /// Clock periods per strip, `T_loop + T_start`.
    each_strip: f64,
    /// Clock periods per element, `T_chime`.
    each_element: f64,
}

impl Charge {
    /// Clock periods for vectors of `n` elements; none for empty vectors.
    fn clocks(&self, n: u64) -> f64 {
        let n = n as f64;
        let strips = self.strip.map_or(n.min(1.0), |length| (n / length).ceil());
        strips * self.each_strip + n * self.each_element
    }
}

/// `NOP · n`: time proportional to the number of operations.
fn operations(machine: &MachineModel, work: &ProgramWork) -> Charge {
    Charge { each_element: work.sum(machine, |_| 1.0), ..Charge::default() }
}

/// `NOP · n · D`: without a pipeline every element passes through the whole depth of its unit.
fn scalar(machine: &MachineModel, work: &ProgramWork) -> Charge {
    if !machine.has_start_ups() {
        return operations(machine, work);
    }
    Charge { each_element: work.sum(machine, |class| machine.start_up(class)), ..Charge::default() }
}

/// `NOP · (n + D)`: the pipeline fills once, then delivers one element per clock period.
fn paper(machine: &MachineModel, work: &ProgramWork) -> Charge {
    Charge { each_strip: work.sum(machine, |class| machine.start_up(class)), ..operations(machine, work) }
}

/// Charges as the paper's clock, with a start-up for every strip of one register, and the loop around the strips.
///
/// A machine without vector registers is charged by the paper's clock.
fn registers(machine: &MachineModel, work: &ProgramWork) -> Charge {
    strip_mined(machine, paper(machine, work))
}

/// `T_start` and `T_chime` from the convoys of the program; memory is never busy.
fn chained(machine: &MachineModel, work: &ProgramWork) -> Charge {
    in_convoys(machine, work, MemoryModel::NeverBusy)
}

/// Charges as the chained clock, with as many loads and stores in a convoy as the machine has ports, at the rate of its memory.
///
/// A machine without stated memory is charged by the chained clock. Conflicts of memory banks, and the loads and stores of vectors for
/// which the machine has too few registers, are not modelled.
fn ports(machine: &MachineModel, work: &ProgramWork) -> Charge {
    in_convoys(machine, work, MemoryModel::Ports)
}

/// `c · ⌈n / VLMAX⌉`: a staircase and not `n + D`. An instruction without a stated time takes a clock period an element.
///
/// A machine without such times is charged by the clock with memory ports.
fn whole_registers(machine: &MachineModel, work: &ProgramWork) -> Charge {
    let Some(registers) = &machine.whole_registers else { return ports(machine, work) };
    Charge {
        strip: Some(registers.elements()),
        each_strip: work.sum(machine, |class| registers.periods(class).unwrap_or(0.0)),
        each_element: work.sum(machine, |class| f64::from(u8::from(registers.periods(class).is_none()))),
    }
}

/// Charge of a program's convoys.
///
/// A machine without stated functional units, and work in no known order, are charged by the strip-mined clock.
fn in_convoys(machine: &MachineModel, work: &ProgramWork, memory: MemoryModel) -> Charge {
    let (Some(order), true) = (work.order(), machine.has_units()) else {
        return registers(machine, work);
    };
    let convoys = convoys(machine, order, memory);
    let charge = Charge {
        strip: None,
        each_strip: convoys.iter().map(|convoy| convoy.start_up).sum(),
        each_element: convoys.iter().map(|convoy| convoy.chime).sum(),
    };
    strip_mined(machine, charge)
}

/// Charges every strip instead of the whole vector, with the overhead of the loop if it has a pass.
fn strip_mined(machine: &MachineModel, charge: Charge) -> Charge {
    let loop_overhead = machine.loop_overhead.as_ref().filter(|_| charge.each_element > 0.0);
    Charge {
        strip: machine.vector_registers.as_ref().map(|registers| registers.length.value),
        each_strip: charge.each_strip + loop_overhead.map_or(0.0, |overhead| overhead.value),
        ..charge
    }
}
