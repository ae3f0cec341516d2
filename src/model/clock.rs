//! Clocks: clock periods from operation counts, one function each, in one list.

use super::machine::MachineModel;
use stripmine_kernels::isa::op::OpCounts;

macro_rules! define_clocks {
    ($(($variant:ident, $name:literal, $formula:literal, $clocks:path, $doc:literal)),* $(,)?) => {
        /// One way of charging counted operations, in clock periods of the machine.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Clock {
            $(#[doc = $doc] $variant,)*
        }

        impl Clock {
            /// Every clock, from the crudest to the finest.
            pub const ALL: &'static [Clock] = &[$(Clock::$variant),*];

            /// The name in tables and options.
            pub const fn name(self) -> &'static str {
                match self { $(Clock::$variant => $name),* }
            }

            /// The formula: `count` executions of a class with start-up `D`, on vectors of `n` elements.
            pub const fn formula(self) -> &'static str {
                match self { $(Clock::$variant => $formula),* }
            }

            /// Clock periods that `counts` vector operations of `n` elements each take on `machine`.
            ///
            /// Operations the machine lacks are expanded first. Empty vectors (`n` = 0) cost nothing: no
            /// instruction is issued for them.
            pub fn clocks(self, machine: &MachineModel, counts: &OpCounts, n: u64) -> f64 {
                if n == 0 {
                    return 0.0;
                }
                match self { $(Clock::$variant => $clocks(machine, counts, n as f64)),* }
            }
        }
    };
}

define_clocks! {
    (Scalar, "scalar", "sum over classes of count * n * D", scalar,
        "The same operations on a scalar machine, one element after the other: BP93 section 3."),
    (Paper, "paper", "sum over classes of count * (n + D)", paper,
        "Unchained vector operations on registers of any length: BP93 section 3."),
}

/// `NOP · n · D`: without a pipeline every element waits for the whole depth of its unit.
fn scalar(machine: &MachineModel, counts: &OpCounts, n: f64) -> f64 {
    sum_over_operations(machine, counts, |start_up| n * start_up)
}

/// `NOP · (n + D)`: the pipeline fills once, then delivers one element a clock period.
fn paper(machine: &MachineModel, counts: &OpCounts, n: f64) -> f64 {
    sum_over_operations(machine, counts, |start_up| n + start_up)
}

/// Adds up `clocks_of(D)`, in clock periods, over all operations that `machine` executes for `counts`.
fn sum_over_operations(machine: &MachineModel, counts: &OpCounts, clocks_of: impl Fn(f64) -> f64) -> f64 {
    machine
        .expand(counts)
        .into_iter()
        .map(|(class, count)| count as f64 * clocks_of(machine.start_up(class)))
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::machine::preset;
    use stripmine_kernels::isa::op::Op;

    fn counts_of(op: Op, times: u64) -> OpCounts {
        let mut counts = OpCounts::default();
        (0..times).for_each(|_| counts.record(op));
        counts
    }

    /// One time step as in the table of BP93 section 3: 59 + 12 + 54 operations on particles, 1656 on cells.
    fn paper_step(particles: u64, cells: u64) -> f64 {
        let machine = preset("paper").unwrap();
        [(59, particles), (12, particles), (1656, cells), (54, particles)]
            .into_iter()
            .map(|(operations, n)| Clock::Paper.clocks(&machine, &counts_of(Op::Multiply, operations), n))
            .sum()
    }

    #[test]
    fn a_time_step_costs_what_the_paper_prints() {
        for (particles, cells) in [(1, 1), (100, 1_000), (5_000, 20_000)] {
            let printed = 125 * (particles + 20) + 1656 * (cells + 20);
            assert_eq!(paper_step(particles, cells), printed as f64);
        }
    }

    #[test]
    fn a_particle_costs_125_plus_1656_over_the_occupancy_in_a_large_system() {
        let particles = 1_000_000_000;
        for (cells_per_particle, per_particle) in [(10, 16_685.0), (4, 6_749.0)] {
            let clocks = paper_step(particles, particles * cells_per_particle) / particles as f64;
            assert!((clocks - per_particle).abs() < 1e-3, "{clocks} instead of {per_particle}");
        }
    }

    #[test]
    fn the_paper_machine_charges_every_operation_alike() {
        let machine = preset("paper").unwrap();
        for &op in Op::ALL {
            assert_eq!(Clock::Paper.clocks(&machine, &counts_of(op, 3), 100), 3.0 * 120.0, "{op:?}");
        }
    }

    #[test]
    fn the_speed_up_over_scalar_is_n_d_over_n_plus_d_and_tends_to_d() {
        let machine = preset("paper").unwrap();
        let counts = counts_of(Op::Add, 7);
        let speed_up =
            |n| Clock::Scalar.clocks(&machine, &counts, n) / Clock::Paper.clocks(&machine, &counts, n);
        for n in [1_u64, 20, 64, 1_000] {
            let expected = 20.0 * n as f64 / (n as f64 + 20.0);
            assert!((speed_up(n) - expected).abs() < 1e-12, "n = {n}");
        }
        assert!((speed_up(1_000_000_000) - 20.0).abs() < 1e-6);
    }

    #[test]
    fn a_missing_operation_is_charged_by_its_expansion() {
        let machine = preset("cray-1").unwrap();
        let divide = counts_of(Op::Divide, 1);
        // One reciprocal approximation of depth 14 and three products of depth 7.
        assert_eq!(Clock::Paper.clocks(&machine, &divide, 64), (64.0 + 14.0) + 3.0 * (64.0 + 7.0));
        assert_eq!(Clock::Scalar.clocks(&machine, &divide, 64), 64.0 * (14.0 + 3.0 * 7.0));
    }

    #[test]
    fn empty_vectors_and_empty_counts_cost_nothing() {
        let machine = preset("cray-x-mp").unwrap();
        for &clock in Clock::ALL {
            assert_eq!(clock.clocks(&machine, &counts_of(Op::SquareRoot, 5), 0), 0.0);
            assert_eq!(clock.clocks(&machine, &OpCounts::default(), 1_000), 0.0);
        }
    }
}
