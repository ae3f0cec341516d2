//! Clocks: clock periods from the operations of a program, in one list.
//!
//! Every clock has the form of Hennessy and Patterson's strip-mining formula,
//! `T(n) = ceil(n / MVL) (T_loop + T_start) + n T_chime`, and differs in what it takes for its three numbers
//! (its charge). The list is a ladder: each rung after the first two adds one property of vector machines to the rung
//! before it, so that a table shows what that property is worth.

mod convoy;
#[cfg(test)]
mod tests;
mod work;

pub(crate) use convoy::{Memory, convoys};
pub use work::Work;

use super::machine::MachineModel;

macro_rules! define_clocks {
    ($(($variant:ident, $name:literal, $charge:path, $doc:literal)),* $(,)?) => {
        /// One way of charging the operations of a program, in clock periods of the machine.
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

            /// What the clock takes into account, in one line.
            pub const fn meaning(self) -> &'static str {
                match self { $(Clock::$variant => $doc),* }
            }

            /// What `machine` is charged for `work`, for vectors of any length.
            ///
            /// Operations the machine lacks are expanded first.
            fn charge(self, machine: &MachineModel, work: &Work) -> Charge {
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
}

impl Clock {
    /// Clock periods that `work` takes on `machine` over vectors of `n` elements.
    ///
    /// Empty vectors (`n` = 0) cost nothing: no instruction is issued for them.
    pub fn clocks(self, machine: &MachineModel, work: &Work, n: u64) -> f64 {
        self.charge(machine, work).clocks(n)
    }
}

/// The three numbers of a clock: what a program costs on a machine, for vectors of any length.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Charge {
    /// Elements of a strip, MVL; none where vectors of any length are worked on in one go.
    strip: Option<f64>,
    /// Clock periods that every strip costs, `T_loop + T_start`.
    each_strip: f64,
    /// Clock periods that every element costs, `T_chime`.
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

/// `NOP · n`: time in proportion to the number of operations.
fn operations(machine: &MachineModel, work: &Work) -> Charge {
    Charge { each_element: work.sum(machine, |_| 1.0), ..Charge::default() }
}

/// `NOP · n · D`: without a pipeline every element waits for the whole depth of its unit.
fn scalar(machine: &MachineModel, work: &Work) -> Charge {
    Charge { each_element: work.sum(machine, |start_up| start_up), ..Charge::default() }
}

/// `NOP · (n + D)`: the pipeline fills once, then delivers one element a clock period.
fn paper(machine: &MachineModel, work: &Work) -> Charge {
    Charge { each_strip: work.sum(machine, |start_up| start_up), ..operations(machine, work) }
}

/// As the paper's, with a start-up for every strip of one register, and the loop around the strips.
///
/// A machine without vector registers is charged as by the paper's clock.
fn registers(machine: &MachineModel, work: &Work) -> Charge {
    strip_mined(machine, paper(machine, work))
}

/// `T_start` and `T_chime` from the convoys of the program, memory taken as never busy.
fn chained(machine: &MachineModel, work: &Work) -> Charge {
    in_convoys(machine, work, Memory::NeverBusy)
}

/// As chained, with as many loads and stores in a convoy as the machine has ports for, at the rate of its memory.
///
/// A machine that states nothing about its memory is charged as by the chained clock. Not modelled: conflicts of memory
/// banks, and the loads and stores of vectors for which the machine has too few registers.
fn ports(machine: &MachineModel, work: &Work) -> Charge {
    in_convoys(machine, work, Memory::Ports)
}

/// The charge of a program's convoys.
///
/// A machine that states no functional units, and work in no known order, is charged as by the strip-mined clock.
fn in_convoys(machine: &MachineModel, work: &Work, memory: Memory) -> Charge {
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

/// A charge for every strip instead of once, with the overhead of the loop if it has a pass.
fn strip_mined(machine: &MachineModel, charge: Charge) -> Charge {
    let loop_overhead = machine.loop_overhead.as_ref().filter(|_| charge.each_element > 0.0);
    Charge {
        strip: machine.vector_registers.as_ref().map(|registers| registers.length.value),
        each_strip: charge.each_strip + loop_overhead.map_or(0.0, |overhead| overhead.value),
        ..charge
    }
}
