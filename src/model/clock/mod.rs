//! Clocks: clock periods from the operations of a program, one model a file, in one list.
//!
//! Every clock has the form of Hennessy and Patterson's strip-mining formula,
//! `T(n) = ceil(n / MVL) (T_loop + T_start) + n T_chime`, and differs in what it takes for its three numbers
//! ([`Charge`]). The list is a ladder: each rung after the first two adds one property of vector machines to the rung
//! before it, so that a table shows what that property is worth.

mod chained;
mod charge;
mod convoy;
mod operations;
mod paper;
mod ports;
mod registers;
mod scalar;
#[cfg(test)]
mod tests;
mod work;

pub use charge::Charge;
pub use convoy::{Convoy, Memory, convoys};
pub use work::Work;

use super::machine::MachineModel;

macro_rules! define_clocks {
    ($(($variant:ident, $name:literal, $formula:literal, $charge:path, $doc:literal)),* $(,)?) => {
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

            /// The formula: `count` executions of a class with start-up `D`, on vectors of `n` elements.
            pub const fn formula(self) -> &'static str {
                match self { $(Clock::$variant => $formula),* }
            }

            /// What the clock takes into account, in one line.
            pub const fn meaning(self) -> &'static str {
                match self { $(Clock::$variant => $doc),* }
            }

            /// What `machine` is charged for `work`, for vectors of any length.
            ///
            /// Operations the machine lacks are expanded first.
            pub fn charge(self, machine: &MachineModel, work: &Work) -> Charge {
                match self { $(Clock::$variant => $charge(machine, work)),* }
            }
        }
    };
}

define_clocks! {
    (Operations, "operations", "sum of count * n", operations::charge,
        "The trivial baseline: a clock period for every element of every operation."),
    (Scalar, "scalar", "sum of count * n * D", scalar::charge,
        "The same operations on a scalar machine, one element after the other: BP93 section 3."),
    (Paper, "paper", "sum of count * (n + D)", paper::charge,
        "Unchained vector operations on registers of any length: BP93 section 3."),
    (Registers, "registers", "ceil(n / MVL) * (T_loop + sum of count * D) + sum of count * n", registers::charge,
        "Strip-mined: a start-up for every register's worth of elements."),
    (Chained, "chained", "ceil(n / MVL) * (T_loop + T_start) + n * T_chime", chained::charge,
        "Instructions on different units run at once, a result feeding the next one where the machine chains."),
    (Ports, "ports", "as chained, convoys limited by memory ports", ports::charge,
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
