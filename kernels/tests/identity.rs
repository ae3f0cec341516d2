//! Every execution of every program gives the same bits, on every instruction set this processor has.

mod support;

use proptest::prelude::*;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::integrator::gear::Inertia;
use stripmine_kernels::isa::ProgramError;
use stripmine_kernels::law::Law;
use stripmine_kernels::law::granular::ContactArm;
use stripmine_kernels::sweep::lattice::Coordinates;
use stripmine_kernels::{Execution, GROUP, InstructionSet};
use support::{CONTACT, Case, System, all_ways, equal, varying};

const ORACLE: (Execution, InstructionSet) = (Execution::Chained, InstructionSet::Scalar);

/// Two whole steps of each way against the scalar oracle.
fn whole_steps_agree<S: Precision, P: Precision, L: Law<2>, const VALUES: usize, const FREEDOMS: usize>(
    case: &Case,
    law: &L,
    inertia: Inertia,
) {
    let start = System::<S, P>::random(case);
    let after = |how| {
        let mut system = start.clone();
        system.step::<L, VALUES, FREEDOMS>(case, law, inertia, how);
        system.step::<L, VALUES, FREEDOMS>(case, law, inertia, how);
        system.bits()
    };
    let oracle = after(ORACLE);
    for how in all_ways() {
        assert!(after(how) == oracle, "{how:?} differs from the oracle for {case:?}");
    }
}

fn every_program_agrees(case: &Case) {
    let all_alike = Inertia::Equal { inverse_mass: 1.0, inverse_inertia: 2.0 };
    whole_steps_agree::<f64, f64, _, 6, 3>(case, &varying::<true>(case.contact), Inertia::Varying);
    whole_steps_agree::<f32, f32, _, 5, 3>(case, &varying::<true>(case.contact), Inertia::Varying);
    whole_steps_agree::<f64, f32, _, 4, 3>(case, &equal::<true>(case.contact), all_alike);
    whole_steps_agree::<f64, f64, _, 4, 2>(case, &varying::<false>(case.contact), Inertia::Varying);
    whole_steps_agree::<f32, f32, _, 6, 2>(case, &equal::<false>(case.contact), all_alike);
}

#[test]
fn executions_agree_on_lattices_of_every_kind() {
    for periodic in [[true, true], [false, false], [true, false], [false, true]] {
        for coordinates in [Coordinates::CellRelative, Coordinates::Absolute] {
            every_program_agrees(&Case { periodic, coordinates, ..Case::new(13, 9) });
        }
    }
}

#[test]
fn executions_agree_on_an_empty_lattice() {
    every_program_agrees(&Case { fill: 0.0, ..Case::new(11, 5) });
}

#[test]
fn executions_agree_on_a_full_lattice() {
    every_program_agrees(&Case { fill: 1.0, ..Case::new(17, 6) });
}

#[test]
fn executions_agree_on_one_cell() {
    for fill in [0.0, 1.0] {
        every_program_agrees(&Case { fill, periodic: [false, false], ..Case::new(1, 1) });
    }
}

#[test]
fn executions_agree_with_the_wider_mask_and_the_other_options_of_the_law() {
    let contact = stripmine_kernels::law::granular::Contact {
        cohesionless: false,
        arm: ContactArm::Overlap,
        ..CONTACT
    };
    every_program_agrees(&Case { half_width: 3, contact, ..Case::new(9, 12) });
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn executions_agree_on_random_lattices(
        columns in 5usize..40, rows in 5usize..20, fill in 0.0..1.0f64, seed: u64, x: bool, y: bool, relative: bool,
    ) {
        let coordinates = if relative { Coordinates::CellRelative } else { Coordinates::Absolute };
        let case = Case { fill, seed, periodic: [x, y], coordinates, ..Case::new(columns, rows) };
        whole_steps_agree::<f64, f64, _, 5, 3>(&case, &varying::<true>(case.contact), Inertia::Varying);
        whole_steps_agree::<f32, f32, _, 5, 3>(&case, &varying::<true>(case.contact), Inertia::Varying);
    }
}

/// The half sweep's order of summation is that of groups of 16 cells, whatever a register holds.
fn half_sweeps_agree<P: Precision>(case: &Case) {
    let law = varying::<true>(case.contact);
    let mut start = System::<f64, P>::random(case);
    start.index(case, &law, ORACLE);
    let after = |how| {
        let mut system = start.clone();
        system.forces::<_, true>(case, &law, how).unwrap();
        system.bits()
    };
    let oracle = after(ORACLE);
    for set in InstructionSet::available() {
        for execution in [Execution::Chained, Execution::Strip(GROUP)] {
            assert!(after((execution, set)) == oracle, "{execution:?} on {set:?} differs for {case:?}");
        }
    }
}

#[test]
fn half_sweeps_agree_between_instruction_sets_and_with_the_tape() {
    for periodic in [[true, true], [false, false], [true, false]] {
        let case = Case { periodic, ..Case::new(23, 11) };
        half_sweeps_agree::<f64>(&case);
        half_sweeps_agree::<f32>(&case);
    }
}

/// Meeting each pair once or twice gives the same sums but for their rounding.
#[test]
fn half_and_full_sweeps_agree_to_rounding() {
    for periodic in [[true, true], [false, true]] {
        let case = Case { periodic, fill: 0.5, ..Case::new(23, 11) };
        let law = varying::<true>(case.contact);
        let mut full = System::<f64, f64>::random(&case);
        full.index(&case, &law, ORACLE);
        let mut half = full.clone();
        full.forces::<_, false>(&case, &law, ORACLE).unwrap();
        half.forces::<_, true>(&case, &law, ORACLE).unwrap();
        let mut largest: f64 = 0.0;
        for &sum in law.sums() {
            let (full, half) = (full.on_discs(sum), half.on_discs(sum));
            let scale = full.iter().fold(0.0, |scale: f64, f| scale.max(f.abs()));
            assert!(scale > 1.0, "the case must have contacts");
            for (a, b) in full.iter().zip(&half) {
                largest = largest.max((a - b).abs() / scale);
            }
        }
        assert!(largest < 1e-14, "{largest}");
    }
}

#[test]
fn executions_that_would_change_the_order_of_summation_are_refused() {
    let case = Case::new(9, 9);
    let law = varying::<true>(case.contact);
    let mut system = System::<f64, f64>::random(&case);
    system.index(&case, &law, ORACLE);
    for (execution, asked) in [(Execution::Eager, system.shape.swept().len()), (Execution::Strip(8), 8)] {
        let refused = system.forces::<_, true>(&case, &law, (execution, InstructionSet::Scalar));
        assert_eq!(refused, Err(ProgramError::FixedGroup { group: GROUP, asked }));
    }
}
